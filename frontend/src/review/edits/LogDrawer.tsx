import { Button, Drawer, Loader, Text, TextInput } from "@mantine/core";
import { useInfiniteQuery } from "@tanstack/react-query";
import { messageOf } from "../../api/client";
import { editsQuery } from "../../api/queries";
import { useReviewer } from "../../api/reviewer";
import type { Edit } from "../../api/types";
import { when } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import { useShared } from "../ReviewContext";
import { describeEdit } from "./describe";
import classes from "./LogDrawer.module.css";
import { useEdits } from "./useEdits";

/** Every decision about the drive: who, when, what; each can be undone from here, or made again. */
export function LogDrawer({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  return (
    <Drawer
      opened={opened}
      onClose={onClose}
      position="right"
      size={460}
      title={text.edits.log}
      closeButtonProps={{ "aria-label": text.app.close }}
    >
      <ReviewerName />
      <Log onShow={onClose} />
    </Drawer>
  );
}

function ReviewerName() {
  const { name, set } = useReviewer();
  return (
    <TextInput
      size="xs"
      mb="sm"
      label={text.edits.reviewer}
      description={text.edits.reviewerHint}
      maxLength={60}
      value={name}
      onChange={(event) => set(event.currentTarget.value)}
    />
  );
}

function Log({ onShow }: { onShow: () => void }) {
  const { driveId, store } = useShared();
  const { data, error, refetch, hasNextPage, fetchNextPage, isFetchingNextPage } = useInfiniteQuery(
    editsQuery(driveId),
  );
  const { undo, redo } = useEdits();
  if (error && !data) {
    return (
      <Notice title={text.edits.logFailed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  }
  if (!data) return <Loader size="sm" role="img" aria-label={text.edits.log} />;
  const edits = data.pages.flatMap((page) => page.edits);
  if (edits.length === 0) return <Notice title={text.edits.logEmpty}>{text.edits.logEmptyHint}</Notice>;
  const [first] = data.pages;
  const show = (edit: Edit) => {
    store.getState().select(edit.identity_ids, "selected");
    if (edit.frame_index != null) store.getState().seek(edit.frame_index);
    onShow();
  };
  return (
    <>
      <div className={classes.turns}>
        <Button
          size="compact-xs"
          variant="default"
          disabled={!first?.undo}
          rightSection={<Key action="undoEdit" />}
          onClick={() => void undo()}
        >
          {text.edits.undo}
        </Button>
        <Button
          size="compact-xs"
          variant="default"
          disabled={!first?.redo}
          rightSection={<Key action="redoEdit" />}
          onClick={() => void redo()}
        >
          {text.edits.redo}
        </Button>
      </div>
      <ol className={classes.log} aria-label={text.edits.log}>
        {edits.map((edit) => (
          <li key={edit.id} className={classes.edit} data-undone={edit.undone || undefined}>
            <button type="button" className={classes.what} onClick={() => show(edit)}>
              <span className={classes.words}>{describeEdit(edit)}</span>
              <span className={classes.who}>
                {text.edits.number(edit.id)} · {edit.reviewer} · {when(edit.created_at)}
                {edit.undone && ` · ${text.edits.isUndone}`}
              </span>
            </button>
            {edit.target_id === null && (
              <Button
                size="compact-xs"
                variant="subtle"
                aria-label={(edit.undone ? text.edits.redoOf : text.edits.undoOf)(edit.id)}
                onClick={() => void (edit.undone ? redo(edit.id) : undo(edit.id))}
              >
                {edit.undone ? text.edits.redo : text.edits.undo}
              </Button>
            )}
          </li>
        ))}
      </ol>
      {hasNextPage && (
        <Button size="xs" variant="default" fullWidth loading={isFetchingNextPage} onClick={() => void fetchNextPage()}>
          {text.edits.older}
        </Button>
      )}
      <Text size="xs" c="var(--muted)" mt="sm">
        {text.edits.logHint}
      </Text>
    </>
  );
}
