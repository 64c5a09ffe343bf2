import { IconArrowsSplit2, IconCheck, IconHelp, IconUser } from "@tabler/icons-react";
import { useVirtualizer } from "@tanstack/react-virtual";
import { useEffect, useRef } from "react";
import type { Merge } from "../../api/types";
import { text } from "../../strings";
import rowClasses from "../rows.module.css";
import { shortChance } from "./evidenceWords";
import classes from "./QueueRows.module.css";
import { useQueueActions } from "./useQueue";

const ROW_PX = 54;

/** All merges of the list, in the order in which they are worth a look. */
export function QueueRows({ order, shownId }: { order: readonly Merge[]; shownId: number | null }) {
  const scroller = useRef<HTMLDivElement>(null);
  const { open } = useQueueActions();
  const rows = useVirtualizer({
    count: order.length,
    getScrollElement: () => scroller.current,
    estimateSize: () => ROW_PX,
    overscan: 6,
  });
  const at = order.findIndex((merge) => merge.id === shownId);
  useEffect(() => {
    if (at >= 0) rows.scrollToIndex(at, { align: "auto" });
  }, [at, rows]);
  return (
    <nav className={classes.side} aria-label={text.queue.rows}>
      <p className={classes.order}>
        {order.some((merge) => merge.probability === null) ? text.queue.orderHintScore : text.queue.orderHint}
      </p>
      <div ref={scroller} className={rowClasses.scroller}>
        <ol className={rowClasses.list} style={{ height: rows.getTotalSize() }}>
          {rows.getVirtualItems().map((row) => {
            const merge = order[row.index];
            return (
              merge && (
                <li
                  key={merge.id}
                  className={`${rowClasses.row} ${classes.row}`}
                  style={{ height: ROW_PX, transform: `translateY(${row.start}px)` }}
                >
                  <button
                    type="button"
                    className={rowClasses.choice}
                    aria-current={merge.id === shownId || undefined}
                    onClick={() => open(merge)}
                  >
                    <Row merge={merge} />
                  </button>
                </li>
              )
            );
          })}
        </ol>
      </div>
    </nav>
  );
}

function Row({ merge }: { merge: Merge }) {
  return (
    <>
      <span className={classes.words}>
        <span className={classes.cameras}>
          {merge.camera_a === merge.camera_b ? merge.camera_a : text.queue.between(merge.camera_a, merge.camera_b)}
        </span>
        <span className={rowClasses.quiet}>{text.queue.changes(merge.label_count)}</span>
      </span>
      <span className={classes.chance}>
        <span>{shortChance(merge)}</span>
        {merge.probability === null ? (
          <span className={rowClasses.quiet}>{text.merges.score}</span>
        ) : (
          <span className={classes.meter} aria-hidden>
            <span style={{ width: `${100 * merge.probability}%` }} />
          </span>
        )}
      </span>
      <State merge={merge} />
    </>
  );
}

const ICONS = { accepted: IconCheck, rejected: IconArrowsSplit2, unsure: IconHelp, proposed: null };

function State({ merge }: { merge: Merge }) {
  const Icon = ICONS[merge.state];
  const byPerson = merge.decided_by === "person";
  const words = text.queue.stateOf[merge.state];
  return (
    <span className={classes.state} data-state={merge.state}>
      {Icon && <Icon size={15} role="img" aria-label={byPerson ? text.queue.saidByPerson(words) : words} />}
      {byPerson && <IconUser size={11} aria-hidden />}
    </span>
  );
}
