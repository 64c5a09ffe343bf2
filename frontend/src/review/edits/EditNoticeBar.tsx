import { Button, CloseButton } from "@mantine/core";
import { useEffect } from "react";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import classes from "./EditNoticeBar.module.css";
import { useEditNotice, useEdits } from "./useEdits";

const SHOWN_MS = 6_000;

/** What was just done, with its undo; why it was refused, or what somebody else did, which stay until they are read. */
export function EditNoticeBar() {
  const { notice, dismiss } = useEditNotice();
  const { undo } = useEdits();
  useEffect(() => {
    if (notice?.kind !== "done") return;
    const timer = setTimeout(dismiss, SHOWN_MS);
    return () => clearTimeout(timer);
  }, [notice, dismiss]);
  if (!notice) return null;
  return (
    <div className={classes.notice} data-kind={notice.kind} role={notice.kind === "refused" ? "alert" : "status"}>
      <span className={classes.words}>{notice.message}</span>
      {notice.kind === "done" && (
        <Button size="compact-xs" variant="subtle" rightSection={<Key action="undoEdit" />} onClick={() => void undo()}>
          {text.edits.undo}
        </Button>
      )}
      <CloseButton size="sm" aria-label={text.app.close} onClick={dismiss} />
    </div>
  );
}
