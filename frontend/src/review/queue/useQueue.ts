/** The queue's list, what is shown of it, and how a decision moves on. */

import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo } from "react";
import { create } from "zustand";
import { mergeLooksQuery, mergesQuery } from "../../api/queries";
import type { DriveDetail, Merge, MergeLooks } from "../../api/types";
import { stepMerge } from "../merges/order";
import { type Decision, useDecisions } from "../merges/useDecisions";
import { useReview, useShared } from "../ReviewContext";
import { cutOut, preload } from "./look";
import { listOf, members, nextOpen, type QueueList, upNext } from "./queueLists";

interface QueueState {
  list: QueueList;
  ids: readonly number[];
  show: (list: QueueList) => void;
  setIds: (ids: readonly number[]) => void;
}

export const useQueueState = create<QueueState>()((set) => ({
  list: "open",
  ids: [],
  show: (list) => set({ list, ids: [] }),
  setIds: (ids) => set({ ids }),
}));

const NONE: Merge[] = [];

/** The merges of the list in their order. */
function ordered(ids: readonly number[], merges: readonly Merge[]): Merge[] {
  const byId = new Map(merges.map((merge) => [merge.id, merge]));
  return ids.map((id) => byId.get(id)).filter((merge) => merge !== undefined);
}

/** What keys and buttons do in the queue. */
export function useQueueActions() {
  const { driveId, store } = useShared();
  const client = useQueryClient();
  const { decide, open, undoLast } = useDecisions();
  const now = () => {
    const { list, ids } = useQueueState.getState();
    const order = ordered(ids, client.getQueryData(mergesQuery(driveId).queryKey) ?? NONE);
    const shown = order.find((merge) => merge.id === store.getState().mergeId) ?? null;
    return { list, order, shown };
  };
  return {
    step: (by: 1 | -1) => {
      const { order, shown } = now();
      const next = stepMerge(order, shown?.id ?? null, by);
      if (next) open(next);
    },
    decide: (decision: Decision) => {
      const { list, order, shown } = now();
      if (!shown) return;
      if (decision === "undo") decide(shown, "undo");
      else decide(shown, decision, nextOpen(list, order, shown.id) ?? shown);
    },
    undo: undoLast,
    open,
  };
}

/** The queue as it is shown; keeps its list up to date, opens the first merge, and fetches the next ones ahead. */
export function useQueue() {
  const { driveId, drive, store, frames } = useShared();
  const client = useQueryClient();
  const { data, error, isPending, refetch } = useQuery(mergesQuery(driveId));
  const { list, ids, setIds, show } = useQueueState();
  const mergeId = useReview((state) => state.mergeId);
  const { open } = useDecisions();
  const merges = data ?? NONE;

  // An address that names a merge opens the list that the merge is in.
  // biome-ignore lint/correctness/useExhaustiveDependencies: only when the merges come, not when one is decided.
  useEffect(() => {
    const named = merges.find((merge) => merge.id === store.getState().mergeId);
    if (named && !useQueueState.getState().ids.includes(named.id)) show(listOf(named));
  }, [isPending]);

  useEffect(() => {
    const current = members(ids, merges, list);
    if (current !== ids) setIds(current);
  }, [ids, merges, list, setIds]);

  const order = useMemo(() => ordered(ids, merges), [ids, merges]);
  const shown = order.find((merge) => merge.id === mergeId) ?? null;
  const first = order[0];
  useEffect(() => {
    if (!shown && first) open(first);
  }, [shown, first, open]);

  const shownId = shown?.id;
  useEffect(() => {
    if (shownId === undefined) return;
    for (const next of upNext(list, order, shownId, 3)) {
      void client.ensureQueryData(mergeLooksQuery(driveId, next.id, frames.whenFree)).then(
        (looks) => preloadLooks(drive, looks),
        () => undefined, // shown, and said, when its turn comes
      );
    }
  }, [shownId, order, list, client, driveId, drive, frames]);

  return { list, show, merges, order, shown, error, isPending, refetch };
}

export const PICTURE_ASPECT = 4 / 3;

function preloadLooks(drive: DriveDetail, looks: MergeLooks): void {
  const large = [...(looks.moments[0]?.looks ?? []), ...looks.sides.map((side) => side.best)];
  const urls = [
    ...large.map((look) => cutOut(drive, look, PICTURE_ASPECT, 720)?.url),
    ...looks.strip.map((look) => cutOut(drive, look, PICTURE_ASPECT, 160)?.url),
  ];
  for (const url of urls) if (url) preload(url);
}
