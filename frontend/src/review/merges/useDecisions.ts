/** Accept, reject, undo: shown at once, saved behind it, taken back with the server's sentence if it refuses. */

import { type QueryClient, useQuery, useQueryClient } from "@tanstack/react-query";
import { useCallback, useMemo } from "react";
import { create } from "zustand";
import { ApiError, api, messageOf, unwrap } from "../../api/client";
import { mergesKey, mergesQuery } from "../../api/queries";
import type { Merge, MergeState } from "../../api/types";
import { useQuietMutation } from "../../api/useQuietMutation";
import { afterPaint } from "../../app/afterPaint";
import { text } from "../../strings";
import { useChanges } from "../changes/useChanges";
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

interface Asked {
  merge: Merge;
  decision: Decision;
  /** The revision that the page showed, where it was sent at once. */
  sent?: { revision: number; answer: ReturnType<typeof post> };
}

export function useMerges(): readonly Merge[] {
  const { driveId } = useShared();
  return useQuery(mergesQuery(driveId)).data ?? [];
}

export function useDecisions() {
  const { driveId, store, frames, observations } = useShared();
  const client = useQueryClient();
  const changes = useChanges();
  const key = useMemo(() => mergesKey(driveId), [driveId]);
  const mutationKey = useMemo(() => ["decide", driveId], [driveId]);

  const open = useCallback(
    (merge: Merge) => {
      // The queue shows crops: the cameras go to the frame when they are shown again.
      const frame = store.getState().view === "queue" ? null : bestFrame(merge);
      store.getState().selectMerge(merge.id, [merge.identity_a, merge.identity_b], frame);
      if (frame === null) return;
      const following = afterDecision(mergesOf(client.getQueryData<Merge[]>(key) ?? [], merge.state), merge.id);
      const next = following && bestFrame(following);
      frames.expect(next === null ? [] : [next]);
    },
    [store, frames, client, key],
  );

  const replace = (merge: Merge) =>
    client.setQueryData<Merge[]>(key, (all) => all?.map((one) => (one.id === merge.id ? merge : one)));

  /** Sends a decision at once where no other is on its way: the server works on it while the page is painted. */
  const send = (merge: Merge, decision: Decision) => {
    frames.hold();
    const asked: Asked = { merge, decision };
    if (client.isMutating({ mutationKey }) === 0) {
      const revision = observations.knownRevision();
      asked.sent = { revision, answer: post(decision, merge.id, revision) };
    }
    mutate(asked).catch(() => undefined); // said on its card by onError
  };

  const forget = (id: number) => {
    const { decided, setDecided } = store.getState();
    setDecided(decided.filter((one) => one !== id));
  };

  const mutate = useQuietMutation({
    mutationKey,
    scope: { id: `decide-${driveId}` },
    mutationFn: async ({ merge, decision, sent }: Asked) => {
      const seen = sent?.revision ?? observations.knownRevision();
      return { seen, change: await (sent?.answer ?? post(decision, merge.id, seen)) };
    },
    onSuccess: ({ seen, change }, { decision }) => {
      changes.show(change, seen);
      // The labels in the pictures come first; lists and lanes follow.
      afterPaint(() => {
        // What others are on their way with is not undone by what the server knew before it.
        const waiting = new Set(pendingMerges(client, mutationKey));
        waiting.delete(change.merge.id);
        changes.list(change, seen, waiting);
        const { mergeId, select } = store.getState();
        if (decision === "undo") {
          forget(change.merge.id);
          open(change.merge);
        } else if (mergeId === null) select(change.identity_ids);
      });
    },
    onError: (cause, { merge }) => {
      replace(merge);
      forget(merge.id);
      const code = cause instanceof ApiError ? cause.code : "";
      useRefusals.getState().set(merge.id, { title: TITLES[code] ?? text.merges.failed, message: messageOf(cause) });
      open(merge);
    },
    onSettled: async (_, error) => {
      afterPaint(() => frames.release());
      // Others may be on their way: the last one asks for the whole truth, or it would undo what they show.
      if (client.isMutating({ mutationKey }) !== 1) return;
      await changes.settle(error !== null);
    },
  });

  /** Decides, and shows what comes next: `next`, or the neighbour in the panel's list. */
  const decide = (merge: Merge, decision: Decision, next?: Merge) => {
    useRefusals.getState().set(merge.id, null);
    if (decision === "undo") {
      if (merge.decided_by === "person") send(merge, decision);
      return;
    }
    if (merge.state === STATE_AFTER[decision] && merge.decided_by === "person") {
      if (next) open(next); // said before
      return;
    }
    send(merge, decision);
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
