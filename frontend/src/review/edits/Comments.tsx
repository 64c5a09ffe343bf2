import { useQuery } from "@tanstack/react-query";
import { commentsQuery } from "../../api/queries";
import { when } from "../../app/format";
import { useShared } from "../ReviewContext";
import classes from "./Comments.module.css";

/** What people said of an object. */
export function Comments({ identityId }: { identityId: number }) {
  const { driveId } = useShared();
  const said = (useQuery(commentsQuery(driveId)).data ?? []).filter((one) => one.identity_id === identityId);
  if (said.length === 0) return null;
  return (
    <ul className={classes.comments}>
      {said.map((one) => (
        <li key={one.edit_id}>
          <p className={classes.words}>{one.text}</p>
          <span className={classes.who}>
            {one.reviewer}, {when(one.created_at)}
          </span>
        </li>
      ))}
    </ul>
  );
}
