/** What a decision changed, put into the lists that the page has read: nothing of them need be loaded again. */

import type { Identity, LabelChange, Merge, Track } from "../../api/types";

/** Identities in order of id, as they are after a change. */
export function patchIdentities(
  all: readonly Identity[],
  { identities, gone_identity_ids }: Pick<LabelChange, "identities" | "gone_identity_ids">,
): Identity[] {
  const replaced = new Set([...gone_identity_ids, ...identities.map((one) => one.id)]);
  return [...all.filter((one) => !replaced.has(one.id)), ...identities].sort((a, b) => a.id - b.id);
}

/** Tracks in order of id, as they are after a change; those that it only reached stay the same objects. */
export function patchTracks(
  all: readonly Track[],
  { tracks, changed_track_ids }: Pick<LabelChange, "tracks" | "changed_track_ids">,
): Track[] {
  const changed = new Set(changed_track_ids);
  const now = tracks.filter((one) => changed.has(one.id));
  return [...all.filter((one) => !changed.has(one.id)), ...now].sort((a, b) => a.id - b.id);
}

/**
 * Merges by descending score, as they are after a change: it tells all of the tracks that it reached. `waiting` are
 * merges that other decisions are on their way about, which show already what these will make of them.
 */
export function patchMerges(
  all: readonly Merge[],
  { tracks, changed_track_ids, merges }: Pick<LabelChange, "tracks" | "changed_track_ids" | "merges">,
  waiting: ReadonlySet<number> = new Set(),
): Merge[] {
  const reached = new Set([...tracks.map((one) => one.id), ...changed_track_ids]);
  const now = new Map(merges.map((one) => [one.id, one]));
  const known = new Set<number>();
  const kept: Merge[] = [];
  for (const one of all) {
    known.add(one.id);
    if (waiting.has(one.id)) kept.push(one);
    else if (now.has(one.id)) kept.push(now.get(one.id) as Merge);
    else if (!reached.has(one.track_a) && !reached.has(one.track_b)) kept.push(one);
  }
  const added = merges.filter((one) => !known.has(one.id));
  return added.length === 0 ? kept : [...kept, ...added].sort((a, b) => b.score - a.score || a.id - b.id);
}
