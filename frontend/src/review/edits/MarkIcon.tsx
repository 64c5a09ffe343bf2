import { IconCheck, IconEyeOff, IconMessage } from "@tabler/icons-react";
import type { Identity } from "../../api/types";
import { text } from "../../strings";

/** What people say of an object, in signs beside its name. */
export function MarkIcon({ identity }: { identity: Identity }) {
  const same = { size: 14, style: { marginLeft: 5, verticalAlign: -2 } };
  return (
    <>
      {identity.mark === "reviewed" && <IconCheck {...same} aria-label={text.edits.marks.reviewed} role="img" />}
      {identity.mark === "ignored" && <IconEyeOff {...same} aria-label={text.edits.marks.ignored} role="img" />}
      {identity.comment_count > 0 && (
        <IconMessage {...same} aria-label={text.edits.comments(identity.comment_count)} role="img" />
      )}
    </>
  );
}
