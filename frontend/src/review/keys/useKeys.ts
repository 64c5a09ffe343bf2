/** Hears the keys, and carries out what belongs to no single part of the page. */

import { useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { identitiesQuery, mergesQuery } from "../../api/queries";
import type { Merge } from "../../api/types";
import { inCarOrder } from "../cameras/layout";
import { useIdentityList } from "../identities/identityList";
import { mergesOf, stepMerge } from "../merges/order";
import { type Decision, useDecisions } from "../merges/useDecisions";
import { useShared } from "../ReviewContext";
import { perform, useActions } from "./actions";
import { useBindings } from "./bindings";
import { actionOf, type KeyPress } from "./keyMap";

interface Page {
  mergesShown: Merge["state"];
  toggleScene: () => void;
  openHelp: () => void;
}

export function useKeys(page: Page): void {
  useKeyPresses();
  const { driveId, store, drive } = useShared();
  const client = useQueryClient();
  const { decide, undoLast, open } = useDecisions();

  const stepIdentity = (by: 1 | -1) => {
    const { order } = useIdentityList.getState();
    const at = order.indexOf(store.getState().identityIds[0] ?? -1);
    const next = order[at < 0 ? 0 : Math.min(order.length - 1, Math.max(0, at + by))];
    if (next !== undefined) store.getState().select([next]);
  };
  const move = (frame: number) => {
    store.getState().setPlaying(false);
    store.getState().seek(frame);
  };
  const moveBy = (frames: number) => move(store.getState().frame + frames);
  const merges = () => client.getQueryData(mergesQuery(driveId).queryKey) ?? [];
  const openMerge = () => merges().find((merge) => merge.id === store.getState().mergeId);
  const step = (by: 1 | -1) => {
    const { tab, mergeId } = store.getState();
    if (tab === "identities") stepIdentity(by);
    else {
      const next = stepMerge(mergesOf(merges(), page.mergesShown), mergeId, by);
      if (next) open(next);
    }
  };
  const decideOpen = (decision: Decision) => {
    const merge = openMerge();
    if (merge) decide(merge, decision);
  };

  useActions({
    previousFrame: () => moveBy(-1),
    nextFrame: () => moveBy(1),
    back10: () => moveBy(-10),
    forward10: () => moveBy(10),
    firstFrame: () => move(0),
    lastFrame: () => move(drive.frame_count - 1),
    playPause: () => store.getState().setPlaying(!store.getState().playing),
    nextMerge: () => step(1),
    previousMerge: () => step(-1),
    accept: () => decideOpen("accept"),
    reject: () => decideOpen("reject"),
    unsure: () => decideOpen("unsure"),
    queue: () => store.getState().setView(store.getState().view === "queue" ? "cameras" : "queue"),
    undo: undoLast,
    goToDonor: () => {
      const identities = client.getQueryData(identitiesQuery(driveId).queryKey) ?? [];
      const donor = identities.find((one) => one.id === store.getState().identityIds[0])?.donor;
      if (donor) move(donor.frame_index);
    },
    enlarge: () => {
      const round = [null, ...inCarOrder(drive.camera_names)];
      const { enlarged, setEnlarged } = store.getState();
      setEnlarged(round[(round.indexOf(enlarged) + 1) % round.length] ?? null);
    },
    toggleScene: page.toggleScene,
    clear: () => {
      const state = store.getState();
      if (state.enlarged && state.identityIds.length === 0) state.setEnlarged(null);
      else state.clear();
    },
    help: page.openHelp,
  });
}

/** Turns key presses into actions, wherever on the page the focus is. */
function useKeyPresses(): void {
  useEffect(() => {
    const onKeyDown = (event: KeyboardEvent) => {
      const focus = event.target instanceof HTMLElement ? event.target : document.body;
      // A dialog, or an open list, has the keys for itself.
      if (event.defaultPrevented || focus.closest('[role="dialog"], [role="listbox"], [role="menu"]')) return;
      const action = actionOf(pressOf(event, focus), useBindings.getState().bindings);
      if (action && perform(action)) event.preventDefault();
    };
    window.addEventListener("keydown", onKeyDown);
    return () => window.removeEventListener("keydown", onKeyDown);
  }, []);
}

/** Input elements that take no text: letters typed there are free to mean something else. */
const TEXTLESS = new Set(["radio", "checkbox", "range", "button"]);
const INPUT_ROLES: Record<string, string> = { radio: "radio", checkbox: "checkbox", range: "slider", button: "button" };

function pressOf(event: KeyboardEvent, focus: HTMLElement): KeyPress {
  const input = focus instanceof HTMLInputElement ? focus.type : null;
  return {
    key: event.key,
    code: event.code,
    ctrlKey: event.ctrlKey,
    metaKey: event.metaKey,
    altKey: event.altKey,
    shiftKey: event.shiftKey,
    focus: {
      role: focus.getAttribute("role") ?? (input && INPUT_ROLES[input]) ?? null,
      tag: focus.tagName,
      editable:
        focus.isContentEditable || focus instanceof HTMLTextAreaElement || (input !== null && !TEXTLESS.has(input)),
    },
  };
}
