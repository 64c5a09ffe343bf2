/** Which merge comes next, and what the list shows. */

import type { Merge, MergeState } from "../../api/types";
import { byPriority } from "../queue/queueLists";

const ordered = new WeakMap<readonly Merge[], Map<MergeState, readonly Merge[]>>();

/** Merges of a state, by impact times uncertainty. Worked out once for a list, which is not to be changed. */
export function mergesOf(merges: readonly Merge[], state: MergeState): readonly Merge[] {
  let known = ordered.get(merges);
  if (!known) {
    known = new Map();
    ordered.set(merges, known);
  }
  const found = known.get(state) ?? merges.filter((merge) => merge.state === state).sort(byPriority);
  known.set(state, found);
  return found;
}

/** The merge `step` places after the given one; at an end, that end. Without a current one, the first. */
export function stepMerge(list: readonly Merge[], currentId: number | null, step: 1 | -1): Merge | null {
  const at = list.findIndex((merge) => merge.id === currentId);
  if (at < 0) return list[0] ?? null;
  return list[Math.min(list.length - 1, Math.max(0, at + step))] ?? null;
}

/** After a decision: the merge that takes the place of the decided one in its list, or the one before at the end. */
export function afterDecision(list: readonly Merge[], decidedId: number): Merge | null {
  const at = list.findIndex((merge) => merge.id === decidedId);
  const rest = list.filter((merge) => merge.id !== decidedId);
  return rest[Math.min(Math.max(at, 0), rest.length - 1)] ?? null;
}

/** The frame at which the evidence is best; null if no frame holds both. */
export function sharedFrame(merge: Merge): number | null {
  return merge.best_frames[0]?.frame_index ?? null;
}

/** The frame that shows most of a merge: the shared one, else the last of the track that ends before the other begins. */
export function bestFrame(merge: Merge): number | null {
  return sharedFrame(merge) ?? merge.evidence?.gap_frames?.[0] ?? null;
}
