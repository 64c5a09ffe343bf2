/** Corrections: one after the other, with the revision that the page shows; what came of it is told in a notice. */

import { useQueryClient } from "@tanstack/react-query";
import { create } from "zustand";
import { api, messageOf, unwrap } from "../../api/client";
import { identitiesQuery } from "../../api/queries";
import type { Correction, EditChange } from "../../api/types";
import { useQuietMutation } from "../../api/useQuietMutation";
import { text } from "../../strings";
import { useChanges } from "../changes/useChanges";
import { useShared } from "../ReviewContext";
import { describeEdit } from "./describe";

export interface EditNotice {
  kind: "done" | "refused" | "other";
  message: string;
  /** Grows with each notice, so that one that says the same is another one. */
  number: number;
}

export const useEditNotice = create<{
  notice: EditNotice | null;
  show: (kind: EditNotice["kind"], message: string) => void;
  dismiss: () => void;
}>()((set, get) => ({
  notice: null,
  show: (kind, message) => set({ notice: { kind, message, number: (get().notice?.number ?? 0) + 1 } }),
  dismiss: () => set({ notice: null }),
}));

export type Ask =
  | { verb: "edit"; edit: Correction }
  | { verb: "undo"; editId?: number | undefined }
  | { verb: "redo"; editId?: number | undefined };

function send(driveId: number, ask: Ask, revision: number | null) {
  const params = { path: { drive_id: driveId } };
  switch (ask.verb) {
    case "edit":
      return unwrap(api.POST("/api/drives/{drive_id}/edits", { params, body: { edit: ask.edit, revision } }));
    case "undo":
      return unwrap(
        api.POST("/api/drives/{drive_id}/undo", { params, body: { edit_id: ask.editId ?? null, revision } }),
      );
    case "redo":
      return unwrap(
        api.POST("/api/drives/{drive_id}/redo", { params, body: { edit_id: ask.editId ?? null, revision } }),
      );
  }
}

/** Which identities to select after a change: those that were, as far as they are there, and new ones. */
export function selectionAfter(
  selected: readonly number[],
  known: ReadonlySet<number>,
  change: Pick<EditChange, "identity_ids">,
  kind: string,
): number[] {
  const after = new Set(change.identity_ids);
  const fresh = change.identity_ids.filter((id) => !known.has(id));
  if (kind === "join") return change.identity_ids.filter((id) => selected.includes(id)).slice(0, 1);
  if (kind === "delete") return selected.filter((id) => after.has(id));
  if (kind === "box") return fresh.length > 0 ? fresh : [...selected];
  return [...new Set([...selected.filter((id) => after.has(id) || known.has(id)), ...fresh])];
}

export function useEdits() {
  const { driveId, store, observations } = useShared();
  const client = useQueryClient();
  const changes = useChanges();
  const mutationKey = ["decide", driveId];
  const { show } = useEditNotice.getState();

  const mutate = useQuietMutation({
    mutationKey,
    scope: { id: `decide-${driveId}` },
    mutationFn: async (ask: Ask) => {
      const seen = observations.knownRevision();
      return { seen, change: await send(driveId, ask, seen) };
    },
    onSuccess: ({ seen, change }, ask) => {
      const known = new Set((client.getQueryData(identitiesQuery(driveId).queryKey) ?? []).map((one) => one.id));
      const selected = store.getState().identityIds;
      changes.show(change, seen);
      changes.list(change, seen);
      if (ask.verb === "edit") {
        store.setState({ identityIds: selectionAfter(selected, known, change, ask.edit.kind) });
        show("done", describeEdit(change.edit));
      } else {
        const back = change.identity_ids.filter((id) => change.edit.identity_ids.includes(id));
        if (back.length > 0) store.setState({ identityIds: back });
        show("done", text.edits[ask.verb === "undo" ? "undone" : "redone"](describeEdit(change.edit)));
      }
    },
    onError: (cause) => show("refused", messageOf(cause)),
    onSettled: async (_, error) => {
      if (client.isMutating({ mutationKey }) === 1) await changes.settle(error !== null);
    },
  });

  // What was refused is told by the notice; nobody else waits for it.
  const ask = (what: Ask): Promise<boolean> =>
    mutate(what).then(
      () => true,
      () => false,
    );
  return {
    edit: (edit: Correction) => ask({ verb: "edit", edit }),
    undo: (editId?: number) => ask({ verb: "undo", editId }),
    redo: (editId?: number) => ask({ verb: "redo", editId }),
  };
}
