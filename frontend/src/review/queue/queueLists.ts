/** What the merge queue lists, and what comes next in it. */

import type { Merge } from "../../api/types";

export type QueueList = "open" | "automatic" | "unsure" | "decided";
export const QUEUE_LISTS: readonly QueueList[] = ["open", "automatic", "unsure", "decided"];

const BELONGS: Record<QueueList, (merge: Merge) => boolean> = {
  open: (merge) => merge.state === "proposed",
  automatic: (merge) => merge.state === "accepted" && merge.decided_by === "machine",
  unsure: (merge) => merge.state === "unsure",
  decided: (merge) => merge.decided_by === "person" && merge.state !== "unsure",
};

export function belongsTo(list: QueueList, merge: Merge): boolean {
  return BELONGS[list](merge);
}

/** The list in which a merge is found. */
export function listOf(merge: Merge): QueueList {
  return QUEUE_LISTS.find((list) => belongsTo(list, merge)) ?? "decided";
}

/** Impact times uncertainty, the greatest first; equal ones by id, so that the order never jumps. */
export function byPriority(a: Merge, b: Merge): number {
  return b.priority - a.priority || a.id - b.id;
}

/**
 * Who is in a list now: who was in it stays in its place, also when decided meanwhile (so that nothing moves, and one
 * can go back); who belongs to it now and was not in it follows at the end; who is gone is left out.
 */
export function members(before: readonly number[], merges: readonly Merge[], list: QueueList): number[] {
  const known = new Set(merges.map((merge) => merge.id));
  const kept = before.filter((id) => known.has(id));
  const there = new Set(kept);
  const added = merges.filter((merge) => belongsTo(list, merge) && !there.has(merge.id)).sort(byPriority);
  return added.length === 0 && kept.length === before.length
    ? (before as number[])
    : [...kept, ...added.map((merge) => merge.id)];
}

/** The merge to show after a decision about one: the next below that waits still, else the first above, else none. */
export function nextOpen(list: QueueList, order: readonly Merge[], decidedId: number): Merge | null {
  const at = order.findIndex((merge) => merge.id === decidedId);
  const round = [...order.slice(at + 1), ...order.slice(0, Math.max(at, 0))];
  return round.find((merge) => belongsTo(list, merge)) ?? null;
}

/** The merges that are likely to be shown next, nearest first. */
export function upNext(list: QueueList, order: readonly Merge[], shownId: number, n: number): Merge[] {
  const at = order.findIndex((merge) => merge.id === shownId);
  return order
    .slice(at + 1)
    .filter((merge) => belongsTo(list, merge))
    .slice(0, n);
}

/** Carries the priorities of first sight over to newer answers: what is decided changes others', and cards would jump. */
export function keepPriorities(before: readonly Merge[] | undefined, after: Merge[]): Merge[] {
  if (!before) return after;
  let first: Map<number, number> | undefined;
  return after.map((merge, at) => {
    const there = before[at];
    if (there === merge) return merge; // most are, after a decision
    if (there?.id !== merge.id) first ??= new Map(before.map((one) => [one.id, one.priority]));
    const priority = there?.id === merge.id ? there.priority : first?.get(merge.id);
    return priority === undefined || priority === merge.priority ? merge : { ...merge, priority };
  });
}
