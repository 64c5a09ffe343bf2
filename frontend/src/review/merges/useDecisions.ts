/** Accept, reject, undo: shown at once, saved behind it, taken back with the server's sentence if it refuses. */

import { type QueryClient, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useCallback, useMemo } from "react";
import { create } from "zustand";
import { ApiError, api, messageOf, unwrap } from "../../api/client";
import { mergesKey, mergesQuery } from "../../api/queries";
import type { Merge, MergeState } from "../../api/types";
import { text } from "../../strings";
import { useShared } from "../ReviewContext";
import { afterDecision, bestFrame, mergesOf } from "./order";

export type Decision = "accept" | "reject" | "unsure" | "undo";

/** What a decision makes of a merge. What undoing makes of it only the server knows: what the machine had said. */
const STATE_AFTER: Record<Exclude<Decision, "undo">, MergeState> = {
  accept: "accepted",
  reject: "rejected",
  unsure: "unsure",
};

/** What stands above the server's reason, by its code. */
const TITLES: Record<string, string> = {
  cannot_link: text.merges.refused,
  classes_differ: text.merges.refused,
  stale: text.merges.stale,
};

export interface Refusal {
  title: string;
  message: string;
}

/** Why the server refused a decision, by merge; shown on its card until the next try. */
export const useRefusals = create<{
  byMerge: Record<number, Refusal>;
  set: (id: number, why: Refusal | null) => void;
}>()((set) => ({
  byMerge: {},
  set: (id, why) =>
    set(({ byMerge: { [id]: _, ...rest } }) => ({ byMerge: why === null ? rest : { ...rest, [id]: why } })),
}));

/** The merges about which decisions are on their way. */
function pendingMerges(client: QueryClient, mutationKey: readonly unknown[]): number[] {
  return client
    .getMutationCache()
    .findAll({ mutationKey: [...mutationKey], status: "pending" })
    .map((mutation) => (mutation.state.variables as { merge: Merge }).merge.id);
}

function post(decision: Decision, mergeId: number, revision: number | null) {
  const at = { params: { path: { merge_id: mergeId } }, body: { revision } };
  if (decision === "accept") return unwrap(api.POST("/api/merges/{merge_id}/accept", at));
  if (decision === "reject") return unwrap(api.POST("/api/merges/{merge_id}/reject", at));
  if (decision === "unsure") return unwrap(api.POST("/api/merges/{merge_id}/unsure", at));
  return unwrap(api.POST("/api/merges/{merge_id}/undo", at));
}

export function useMerges(): readonly Merge[] {
  const { driveId } = useShared();
  return useQuery(mergesQuery(driveId)).data ?? [];
}

export function useDecisions() {
  const { driveId, store, frames, observations } = useShared();
  const client = useQueryClient();
  const key = mergesKey(driveId);
  const mutationKey = useMemo(() => ["decide", driveId], [driveId]);

  const open = useCallback(
    (merge: Merge) => {
      // The queue shows crops: the cameras go to the frame when they are shown again.
      const frame = store.getState().view === "queue" ? null : bestFrame(merge);
      store.getState().selectMerge(merge.id, [merge.identity_a, merge.identity_b], frame);
    },
    [store],
  );

  const replace = (...merges: Merge[]) => {
    const now = new Map(merges.map((merge) => [merge.id, merge]));
    client.setQueryData<Merge[]>(key, (all) => all?.map((one) => now.get(one.id) ?? one));
  };

  const forget = (id: number) => {
    const { decided, setDecided } = store.getState();
    setDecided(decided.filter((one) => one !== id));
  };

  const { mutate } = useMutation({
    mutationKey,
    scope: { id: `decide-${driveId}` },
    mutationFn: ({ merge, decision }: { merge: Merge; decision: Decision }) =>
      post(decision, merge.id, observations.knownRevision()),
    onSuccess: (change, { decision }) => {
      // What others are on their way with is not undone by what the server knew before it.
      const waiting = new Set(pendingMerges(client, mutationKey));
      replace(...change.merges.filter((merge) => merge.id === change.merge.id || !waiting.has(merge.id)));
      observations.changedHere(change.revision);
      frames.refreshObservations();
      const { mergeId, select } = store.getState();
      if (decision === "undo") {
        forget(change.merge.id);
        open(change.merge);
      } else if (mergeId === null) select(change.identity_ids);
    },
    onError: (cause, { merge }) => {
      replace(merge);
      forget(merge.id);
      const code = cause instanceof ApiError ? cause.code : "";
      useRefusals.getState().set(merge.id, { title: TITLES[code] ?? text.merges.failed, message: messageOf(cause) });
      open(merge);
    },
    onSettled: async (_, error) => {
      // Others may be on their way: the last one asks for the whole truth, or it would undo what they show.
      if (client.isMutating({ mutationKey }) !== 1) return;
      void client.invalidateQueries({ queryKey: ["drive", driveId, "looks"], refetchType: "none" });
      // Merges came with the answer; lists that nobody looks at are loaded when somebody does.
      const parts = [["tracks"], ["identities"], ...(error ? [["merges"]] : [])];
      await Promise.all([
        client.invalidateQueries({ queryKey: ["drive", driveId], exact: true }),
        ...parts.map((part) => client.invalidateQueries({ queryKey: ["drive", driveId, ...part] })),
      ]);
    },
  });

  /** Decides, and shows what comes next: `next`, or the neighbour in the panel's list. */
  const decide = (merge: Merge, decision: Decision, next?: Merge) => {
    useRefusals.getState().set(merge.id, null);
    if (decision === "undo") {
      if (merge.decided_by === "person") mutate({ merge, decision });
      return;
    }
    if (merge.state === STATE_AFTER[decision] && merge.decided_by === "person") {
      if (next) open(next); // said before
      return;
    }
    void client.cancelQueries({ queryKey: key });
    forget(merge.id);
    store.getState().setDecided([...store.getState().decided, merge.id]);
    const shown = mergesOf(client.getQueryData<Merge[]>(key) ?? [], merge.state);
    replace({ ...merge, state: STATE_AFTER[decision], decided_by: "person" });
    if (store.getState().mergeId === merge.id) {
      const following = next ?? afterDecision(shown, merge.id);
      if (following) open(following);
      else store.setState({ mergeId: null });
    }
    mutate({ merge, decision });
  };

  /** Undoes the open merge if a person decided it, otherwise the latest decision of this visit. */
  const undoLast = () => {
    const all = client.getQueryData<Merge[]>(key) ?? [];
    const { mergeId, decided } = store.getState();
    const openMerge = all.find((merge) => merge.id === mergeId);
    const last = all.find((merge) => merge.id === decided.at(-1));
    const merge = openMerge?.decided_by === "person" ? openMerge : last;
    if (merge) decide(merge, "undo");
  };

  return { decide, undoLast, open };
}
