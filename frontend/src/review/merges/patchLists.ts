/** What a decision changed, put into the lists that the page has read: nothing of them need be loaded again. */

import type { Identity, MergeChange, Track } from "../../api/types";

export type Changed = Pick<MergeChange, "identities" | "gone_identity_ids">;

/** Identities in order of id, as they are after a change. */
export function patchIdentities(all: readonly Identity[], { identities, gone_identity_ids }: Changed): Identity[] {
  const replaced = new Set([...gone_identity_ids, ...identities.map((one) => one.id)]);
  return [...all.filter((one) => !replaced.has(one.id)), ...identities].sort((a, b) => a.id - b.id);
}

/** Tracks in their order, each with the identity that it is of after a change. */
export function patchTracks(all: readonly Track[], { identities }: Changed): Track[] {
  const identityOf = new Map(identities.flatMap((one) => one.track_ids.map((track) => [track, one.id] as const)));
  return all.map((track) => {
    const identity = identityOf.get(track.id);
    return identity === undefined || identity === track.identity_id ? track : { ...track, identity_id: identity };
  });
}
