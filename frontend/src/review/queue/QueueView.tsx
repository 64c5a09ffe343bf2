import { ActionIcon, Button, Progress, SegmentedControl, Skeleton, Tooltip } from "@mantine/core";
import { IconChecks, IconGitMerge, IconX } from "@tabler/icons-react";
import { messageOf } from "../../api/client";
import type { Merge } from "../../api/types";
import { count } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { useActions } from "../keys/actions";
import { withKey } from "../keys/Key";
import { MergeDetail } from "./MergeDetail";
import { QueueRows } from "./QueueRows";
import classes from "./QueueView.module.css";
import { belongsTo, QUEUE_LISTS, type QueueList } from "./queueLists";
import { useQueue, useQueueActions } from "./useQueue";

/** The merge queue: one question after the other, each with all that helps to answer it. */
export function QueueView({ onClose }: { onClose: () => void }) {
  const queue = useQueue();
  const { merges, list, order, shown } = queue;
  const { decide, step, undo } = useQueueActions();
  useActions({
    accept: () => decide("accept"),
    reject: () => decide("reject"),
    unsure: () => decide("unsure"),
    undo,
    nextMerge: () => step(1),
    previousMerge: () => step(-1),
  });
  return (
    <main className={classes.queue} aria-label={text.queue.name}>
      <div className={classes.bar}>
        <SegmentedControl
          size="xs"
          aria-label={text.queue.lists.label}
          value={list}
          onChange={(value) => queue.show(value as QueueList)}
          data={QUEUE_LISTS.map((one) => ({
            value: one,
            label: `${text.queue.lists[one]} ${count(merges.filter((merge) => belongsTo(one, merge)).length)}`,
          }))}
        />
        <Done merges={merges} />
        <Tooltip label={withKey(text.queue.close, "queue")}>
          <ActionIcon variant="subtle" color="gray" aria-label={text.queue.close} onClick={onClose}>
            <IconX size={18} />
          </ActionIcon>
        </Tooltip>
      </div>
      <Body queue={queue} onClose={onClose} />
      {shown && order.length > 0 && !order.some((merge) => belongsTo(list, merge)) && (
        <div className={classes.finished} role="status">
          <IconChecks size={18} />
          <span>{text.queue.finished[list]}</span>
          <Button size="compact-sm" variant="light" onClick={onClose}>
            {text.queue.toCameras}
          </Button>
        </div>
      )}
    </main>
  );
}

function Body({ queue, onClose }: { queue: ReturnType<typeof useQueue>; onClose: () => void }) {
  const { merges, list, order, shown, error, isPending, refetch } = queue;
  if (error && isPending) {
    return (
      <Notice title={text.merges.loadFailed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  }
  if (isPending) {
    return (
      <div className={classes.loading}>
        <Skeleton h="100%" />
        <Skeleton h="100%" />
      </div>
    );
  }
  if (merges.length === 0) {
    return (
      <Notice icon={<IconGitMerge size={28} stroke={1.4} />} title={text.merges.noneAtAll}>
        {text.merges.noneAtAllHint}
      </Notice>
    );
  }
  if (order.length === 0) {
    return (
      <Notice icon={<IconChecks size={28} stroke={1.4} />} title={text.queue.empty[list]}>
        {text.queue.emptyHint[list]}
      </Notice>
    );
  }
  return (
    <div className={classes.body}>
      <QueueRows order={order} shownId={shown?.id ?? null} />
      {shown && <MergeDetail key={shown.id} merge={shown} onCameras={onClose} />}
    </div>
  );
}

/** How far the review of merges is: all that waited for a person, and what is answered of it. */
function Done({ merges }: { merges: readonly Merge[] }) {
  const answered = merges.filter((merge) => merge.decided_by === "person").length;
  const waiting = merges.filter((merge) => belongsTo("open", merge)).length;
  const all = answered + waiting;
  return (
    <div className={classes.done}>
      <Progress
        value={all === 0 ? 100 : (100 * answered) / all}
        size="sm"
        w={160}
        aria-label={text.queue.progress(answered, all)}
      />
      <span>{text.queue.progress(answered, all)}</span>
    </div>
  );
}
