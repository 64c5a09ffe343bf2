import { SegmentedControl, Skeleton, Stack } from "@mantine/core";
import { IconChecks, IconGitMerge } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useVirtualizer } from "@tanstack/react-virtual";
import { useCallback, useEffect, useMemo, useRef } from "react";
import { messageOf } from "../../api/client";
import { mergesQuery } from "../../api/queries";
import type { Merge, MergeState } from "../../api/types";
import { count } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import { useReview, useShared } from "../ReviewContext";
import rowClasses from "../rows.module.css";
import { MergeCard } from "./MergeCard";
import classes from "./MergesPanel.module.css";
import { mergesOf } from "./order";
import { type Decision, useDecisions } from "./useDecisions";

const STATES: MergeState[] = ["proposed", "accepted", "rejected", "unsure"];
const NONE: Record<MergeState, string> = {
  proposed: text.merges.noneProposed,
  accepted: text.merges.noneAccepted,
  rejected: text.merges.noneRejected,
  unsure: text.merges.noneUnsure,
};

interface MergesPanelProps {
  shown: MergeState;
  onShow: (state: MergeState) => void;
  width: number;
}

/** The queue of merges: decide what is proposed, look again at what is decided. */
export function MergesPanel({ shown, onShow, width }: MergesPanelProps) {
  const { driveId } = useShared();
  const { data, error, refetch, isPending } = useQuery(mergesQuery(driveId));
  const mergeId = useReview((state) => state.mergeId);
  const { decide, open } = useDecisions();
  // Cards whose merge stays as it is are not made anew.
  const latest = useRef({ decide, open });
  latest.current = { decide, open };
  const onOpen = useCallback((merge: Merge) => latest.current.open(merge), []);
  const onDecide = useCallback((merge: Merge, decision: Decision) => latest.current.decide(merge, decision), []);
  const scroller = useRef<HTMLDivElement>(null);
  const list = useMemo(() => mergesOf(data ?? [], shown), [data, shown]);

  const rows = useVirtualizer({
    count: list.length,
    getScrollElement: () => scroller.current,
    estimateSize: (index) => (list[index]?.id === mergeId ? 300 : 92),
    getItemKey: (index) => list[index]?.id ?? index,
    overscan: 4,
  });

  const openAt = list.findIndex((merge) => merge.id === mergeId);
  useEffect(() => {
    if (openAt >= 0) rows.scrollToIndex(openAt, { align: "auto" });
  }, [openAt, rows]);

  // A merge opened by an address or by undo shows its own list.
  const openState = data?.find((merge) => merge.id === mergeId)?.state;
  useEffect(() => {
    if (openState) onShow(openState);
  }, [openState, onShow]);

  if (error && !data)
    return (
      <Notice title={text.merges.loadFailed} onRetry={() => void refetch()} role="alert">
        {messageOf(error)}
      </Notice>
    );
  if (isPending) {
    return (
      <Stack p="sm" gap="sm">
        {[0, 1, 2, 3].map((row) => (
          <Skeleton key={row} h={84} />
        ))}
      </Stack>
    );
  }
  if (data.length === 0)
    return (
      <Notice icon={<IconGitMerge size={28} stroke={1.4} />} title={text.merges.noneAtAll}>
        {text.merges.noneAtAllHint}
      </Notice>
    );

  return (
    <div className={rowClasses.panel}>
      <SegmentedControl
        className={classes.states}
        size="xs"
        fullWidth
        aria-label={text.merges.show}
        value={shown}
        onChange={(value) => onShow(value as MergeState)}
        data={STATES.map((state) => ({
          value: state,
          label: `${text.merges.states[state]} ${count(data.filter((merge) => merge.state === state).length)}`,
        }))}
      />
      {list.length === 0 ? (
        <Notice icon={<IconChecks size={28} stroke={1.4} />} title={NONE[shown]}>
          {shown === "proposed" ? text.merges.noneProposedHint : null}
        </Notice>
      ) : (
        <>
          {shown === "proposed" && (
            <p className={classes.question}>
              {text.merges.question}
              <span className={classes.next}>
                <Key action="nextMerge" /> {text.merges.next}
              </span>
            </p>
          )}
          <div ref={scroller} className={rowClasses.scroller}>
            <ol className={rowClasses.list} style={{ height: rows.getTotalSize() }}>
              {rows.getVirtualItems().map((row) => {
                const merge = list[row.index];
                return (
                  merge && (
                    <li
                      key={row.key}
                      ref={rows.measureElement}
                      data-index={row.index}
                      className={`${rowClasses.row} ${classes.row}`}
                      style={{ transform: `translateY(${row.start}px)` }}
                    >
                      <MergeCard
                        merge={merge}
                        open={merge.id === mergeId}
                        onOpen={onOpen}
                        onDecide={onDecide}
                        width={width}
                      />
                    </li>
                  )
                );
              })}
            </ol>
          </div>
        </>
      )}
    </div>
  );
}
