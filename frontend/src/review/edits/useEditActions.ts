/** What can be done with the selection, for buttons and keys alike. Says why where it can't. */

import { useQueryClient } from "@tanstack/react-query";
import { identitiesQuery, tracksQuery } from "../../api/queries";
import type { Correction, Observation, Track } from "../../api/types";
import { text } from "../../strings";
import { useShared } from "../ReviewContext";
import { keyedClasses } from "./classKeys";
import { useDrawing } from "./useBoxTool";
import { useEditNotice, useEdits } from "./useEdits";

export type Mark = Extract<Correction, { kind: "mark" }>["mark"];

/** The tracks of some identities that can be split at a frame: it must not be the first one. */
export function splittable(tracks: readonly Track[], identityIds: readonly number[], frame: number): Track[] {
  return tracks.filter(
    (one) => identityIds.includes(one.identity_id) && one.first_frame < frame && frame <= one.last_frame,
  );
}

const LOOK_BACK_FRAMES = 400;

export function useEditActions() {
  const { driveId, store, drive, frames, observations } = useShared();
  const client = useQueryClient();
  const { edit, undo, redo } = useEdits();
  const { show } = useEditNotice.getState();

  const selected = () => store.getState().identityIds;
  const refuse = (why: string) => show("refused", why);
  const withSelection = (least: number, why: string, act: (ids: number[]) => void) => {
    const ids = selected();
    if (ids.length < least) refuse(why);
    else act([...ids]);
  };
  const here = (): Observation[] =>
    (frames.committed()?.observations ?? []).filter((one) => selected().includes(one.identity_id));

  return {
    undo: () => void undo(),
    redo: () => void redo(),
    setClass: (className: string) =>
      withSelection(
        1,
        text.edits.selectFirst,
        (ids) => void edit({ kind: "class", identity_ids: ids, class_name: className }),
      ),
    setKeyedClass: (number: number) => {
      const className = keyedClasses(drive.class_names)[number - 1];
      if (!className) return refuse(text.edits.noSuchClass(number));
      withSelection(
        1,
        text.edits.selectFirst,
        (ids) => void edit({ kind: "class", identity_ids: ids, class_name: className }),
      );
    },
    split: () =>
      withSelection(1, text.edits.selectFirst, (ids) => {
        const { frame } = store.getState();
        const tracks = client.getQueryData(tracksQuery(driveId).queryKey) ?? [];
        const found = splittable(tracks, ids, frame);
        if (found.length === 0) return refuse(text.edits.nothingToSplit);
        void edit({ kind: "split", track_ids: found.map((one) => one.id), frame_index: frame });
      }),
    join: () => withSelection(2, text.edits.selectTwo, (ids) => void edit({ kind: "join", identity_ids: ids })),
    swap: () => {
      const ids = selected();
      if (ids.length !== 2) return refuse(text.edits.selectExactlyTwo);
      void edit({ kind: "swap", identity_ids: [...ids], frame_index: store.getState().frame });
    },
    deleteObjects: () =>
      withSelection(
        1,
        text.edits.selectFirst,
        (ids) => void edit({ kind: "delete", identity_ids: ids, track_ids: [], observations: [] }),
      ),
    deleteTracksHere: () => {
      const tracks = [...new Set(here().map((one) => one.track_id))];
      if (tracks.length === 0) return refuse(text.edits.notHere);
      void edit({ kind: "delete", identity_ids: [], track_ids: tracks, observations: [] });
    },
    deleteBoxesHere: () => {
      const frame = frames.committed()?.frame ?? 0;
      const boxes = here().map((one) => ({ track_id: one.track_id, frame_index: frame }));
      if (boxes.length === 0) return refuse(text.edits.notHere);
      void edit({ kind: "delete", identity_ids: [], track_ids: [], observations: boxes });
    },
    /** The label is taken from another look at the object: all but this one, or all but those of its track. */
    rejectDonor: (wholeTrack = false) =>
      withSelection(1, text.edits.selectFirst, ([id]) => {
        const identity = client.getQueryData(identitiesQuery(driveId).queryKey)?.find((one) => one.id === id);
        if (!identity || identity.class_by_person) return refuse(text.edits.noDonorToReject);
        const { track_id, frame_index } = identity.donor;
        void edit({ kind: "donor", identity_id: identity.id, track_id, frame_index, whole_track: wholeTrack });
      }),
    mark: (mark: Mark) =>
      withSelection(1, text.edits.selectFirst, (ids) => void edit({ kind: "mark", identity_ids: ids, mark })),
    comment: (words: string) => edit({ kind: "comment", identity_ids: [...selected()], text: words }),
    toggleDrawing: () => useDrawing.getState().set(!useDrawing.getState().on),
    /** Straight ways from the last box before that a person drew to the one in this frame. */
    interpolate: async () => {
      const frame = frames.committed()?.frame ?? 0;
      const [one] = here();
      if (!one) return refuse(text.edits.notHere);
      for (let at = frame - 1; at >= Math.max(0, frame - LOOK_BACK_FRAMES); at -= 1) {
        const before = (await observations.ensure(at)).find((other) => other.track_id === one.track_id);
        if (before && before.label.source === "human" && before.score === null && !before.filled) {
          void edit({ kind: "interpolate", track_id: one.track_id, first_frame: at, last_frame: frame });
          return;
        }
      }
      refuse(text.edits.noKeyframe);
    },
  };
}

export type EditActions = ReturnType<typeof useEditActions>;
