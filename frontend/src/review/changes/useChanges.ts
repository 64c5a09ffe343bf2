/** Takes what a decision changed into what the page shows and knows. */

import { type QueryClient, useQueryClient } from "@tanstack/react-query";
import { useMemo } from "react";
import { identitiesQuery, mergesQuery, tracksQuery } from "../../api/queries";
import type { LabelChange } from "../../api/types";
import type { FrameObservations } from "../cameras/observationStore";
import { useShared } from "../ReviewContext";
import { patchIdentities, patchMerges, patchTracks } from "./patchLists";

/** Whether an answer holds all that is new since a revision: not where somebody else changed something meanwhile. */
function isWhole(change: LabelChange, seenRevision: number): boolean {
  return change.revision <= seenRevision + 1 && change.observations !== null;
}

export function useChanges() {
  const { driveId, frames, observations } = useShared();
  const client = useQueryClient();
  return useMemo(
    () => ({
      /** The labels in the pictures. */
      show: (change: LabelChange, seenRevision: number) => {
        if (change.revision <= seenRevision) return;
        const whole = isWhole(change, seenRevision) && {
          trackIds: change.changed_track_ids,
          frames: change.observations as FrameObservations[],
        };
        observations.changedHere(change.revision, whole || undefined);
        frames.refreshObservations();
      },
      /** The lists; `waiting` as in `patchMerges`. */
      list: (change: LabelChange, seenRevision: number, waiting?: ReadonlySet<number>) => {
        if (isWhole(change, seenRevision)) patch(client, driveId, change, waiting);
        else void client.invalidateQueries({ queryKey: ["drive", driveId] });
      },
      /** What does not come with an answer: counts, the log and comments; everything after a refusal. */
      settle: async (refused: boolean) => {
        const queryKey = ["drive", driveId];
        void client.invalidateQueries({ queryKey: [...queryKey, "looks"], refetchType: "none" });
        if (refused) await client.invalidateQueries({ queryKey });
        else {
          await Promise.all([
            client.invalidateQueries({ queryKey, exact: true }),
            ...["edits", "comments"].map((part) => client.invalidateQueries({ queryKey: [...queryKey, part] })),
          ]);
        }
      },
    }),
    [client, driveId, frames, observations],
  );
}

/** A list that is on its way is asked for anew: it may be of before. */
function patch(client: QueryClient, driveId: number, change: LabelChange, waiting?: ReadonlySet<number>): void {
  const [identities, tracks, merges] = [identitiesQuery(driveId), tracksQuery(driveId), mergesQuery(driveId)];
  client.setQueryData(identities.queryKey, (all) => all && patchIdentities(all, change));
  client.setQueryData(tracks.queryKey, (all) => all && patchTracks(all, change));
  client.setQueryData(merges.queryKey, (all) => all && patchMerges(all, change, waiting));
  for (const { queryKey } of [identities, tracks, merges]) {
    if (client.isFetching({ queryKey }) > 0) void client.invalidateQueries({ queryKey });
  }
}
