/** What a person does on the review page: where the playhead stands, what is selected, what is open. */

import { createStore, type StoreApi } from "zustand";
import type { IdentityFilter } from "./identities/filter";
import type { IdentitySort } from "./identities/sort";
import { TABS, type Tab, type UrlState, type View } from "./urlState";

export interface Hover {
  identityId: number;
  observationId: number | null;
}

export interface ReviewState extends UrlState {
  readonly frameCount: number;
  playing: boolean;
  speed: number;
  hover: Hover | null;
  enlarged: string | null;
  /** Merges decided on this visit, the latest last: what "undo" goes back through. */
  decided: number[];

  seek: (frame: number) => void;
  setPlaying: (playing: boolean) => void;
  setSpeed: (speed: number) => void;
  /** Selects identities. `tab` opens a tab with it. */
  select: (identityIds: number[], tab?: Tab) => void;
  /** Adds an identity to the selection, or takes it out. */
  toggle: (identityId: number) => void;
  selectMerge: (mergeId: number, identityIds: number[], frame: number | null) => void;
  setHover: (hover: Hover | null) => void;
  setTab: (tab: Tab) => void;
  setFilter: (filter: IdentityFilter) => void;
  setSort: (sort: IdentitySort) => void;
  setView: (view: View) => void;
  setEnlarged: (camera: string | null) => void;
  setDecided: (decided: number[]) => void;
  clear: () => void;
}

export type ReviewStore = StoreApi<ReviewState>;

export function createReviewStore(initial: UrlState, frameCount: number): ReviewStore {
  const inDrive = (frame: number) => Math.max(0, Math.min(frameCount - 1, Math.round(frame)));
  return createStore<ReviewState>()((set, get) => ({
    ...initial,
    frame: inDrive(initial.frame),
    frameCount,
    playing: false,
    speed: 1,
    hover: null,
    enlarged: null,
    decided: [],

    seek: (frame) => set({ frame: inDrive(frame) }),
    setPlaying: (playing) => set({ playing }),
    setSpeed: (speed) => set({ speed }),
    select: (identityIds, tab) => set({ identityIds, mergeId: null, tab: tab ?? get().tab }),
    toggle: (identityId) => {
      const before = get().identityIds;
      const without = before.filter((one) => one !== identityId);
      set({ identityIds: without.length < before.length ? without : [...before, identityId], mergeId: null });
    },
    selectMerge: (mergeId, identityIds, frame) =>
      set({
        mergeId,
        identityIds: [...new Set(identityIds)],
        tab: TABS[0] as Tab,
        playing: false,
        frame: frame === null ? get().frame : inDrive(frame),
      }),
    setHover: (hover) => set({ hover }),
    setTab: (tab) => set({ tab }),
    setFilter: (filter) => set({ filter }),
    setSort: (sort) => set({ sort }),
    setView: (view) => set({ view, playing: false }),
    setEnlarged: (enlarged) => set({ enlarged }),
    setDecided: (decided) => set({ decided }),
    clear: () => set({ identityIds: [], mergeId: null, hover: null }),
  }));
}
