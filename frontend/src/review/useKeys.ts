/** Carries out what a key asks for. The map from keys to actions is in keyMap.ts. */

import { useQueryClient } from "@tanstack/react-query";
import { useEffect, useRef } from "react";
import { identitiesQuery, mergesQuery } from "../api/queries";
import type { Merge } from "../api/types";
import { inCarOrder } from "./cameras/layout";
import { useIdentityList } from "./identities/identityList";
import { type Action, actionOf } from "./keyMap";
import { mergesOf, stepMerge } from "./merges/order";
import { useDecisions } from "./merges/useDecisions";
import { useShared } from "./ReviewContext";

interface Page {
  mergesShown: Merge["state"];
  toggleScene: () => void;
  openHelp: () => void;
}

export function useKeys(page: Page): void {
  const { driveId, store, drive } = useShared();
  const client = useQueryClient();
  const { decide, undoLast, open } = useDecisions();

  const stepIdentity = (by: 1 | -1) => {
    const { order } = useIdentityList.getState();
    const at = order.indexOf(store.getState().identityIds[0] ?? -1);
    const next = order[at < 0 ? 0 : Math.min(order.length - 1, Math.max(0, at + by))];
    if (next !== undefined) store.getState().select([next]);
  };

  const perform = (action: Action) => {
    const state = store.getState();
    const merges = client.getQueryData(mergesQuery(driveId).queryKey) ?? [];
    const openMerge = merges.find((merge) => merge.id === state.mergeId);
    const move = (frame: number) => {
      state.setPlaying(false);
      state.seek(frame);
    };
    const step = (by: 1 | -1) => {
      if (state.tab === "identities") stepIdentity(by);
      else {
        const next = stepMerge(mergesOf(merges, page.mergesShown), state.mergeId, by);
        if (next) open(next);
      }
    };
    const actions: Record<Action, () => void> = {
      previousFrame: () => move(state.frame - 1),
      nextFrame: () => move(state.frame + 1),
      back10: () => move(state.frame - 10),
      forward10: () => move(state.frame + 10),
      firstFrame: () => move(0),
      lastFrame: () => move(drive.frame_count - 1),
      playPause: () => state.setPlaying(!state.playing),
      nextMerge: () => step(1),
      previousMerge: () => step(-1),
      accept: () => openMerge && decide(openMerge, "accept"),
      reject: () => openMerge && decide(openMerge, "reject"),
      undo: undoLast,
      goToDonor: () => {
        const identities = client.getQueryData(identitiesQuery(driveId).queryKey) ?? [];
        const donor = identities.find((one) => one.id === state.identityIds[0])?.donor;
        if (donor) move(donor.frame_index);
      },
      enlarge: () => {
        const round = [null, ...inCarOrder(drive.camera_names)];
        state.setEnlarged(round[(round.indexOf(state.enlarged) + 1) % round.length] ?? null);
      },
      toggleScene: page.toggleScene,
      clear: () => (state.enlarged && state.identityIds.length === 0 ? state.setEnlarged(null) : state.clear()),
      help: page.openHelp,
    };
    actions[action]();
  };

  const latest = useRef(perform);
  latest.current = perform;
  useEffect(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      const focus = event.target instanceof HTMLElement ? event.target : document.body;
      // A dialog, or an open list, has the keys for itself.
      if (event.defaultPrevented || focus.closest('[role="dialog"], [role="listbox"], [role="menu"]')) return;
      const action = actionOf({
        key: event.key,
        ctrlKey: event.ctrlKey,
        metaKey: event.metaKey,
        altKey: event.altKey,
        focus: {
          role:
            focus.getAttribute("role") ??
            (focus instanceof HTMLInputElement && focus.type === "radio" ? "radio" : null),
          tag: focus.tagName,
          editable:
            focus.isContentEditable ||
            focus instanceof HTMLTextAreaElement ||
            (focus instanceof HTMLInputElement && focus.type !== "radio"),
        },
      });
      if (!action) return;
      event.preventDefault();
      latest.current(action);
    };
    window.addEventListener("keydown", onKeyDown);
    return () => window.removeEventListener("keydown", onKeyDown);
  }, []);
}
