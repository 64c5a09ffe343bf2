/** Which part of each camera's picture is shown, and which camera keys act on: the one that was pointed at last. */

import { createStore, type StoreApi } from "zustand";
import { FIT, type Viewport } from "./viewport";

export interface ViewState {
  views: Readonly<Record<string, Viewport>>;
  active: string | null;
  change: (camera: string, how: (view: Viewport) => Viewport) => void;
  setActive: (camera: string) => void;
  fit: () => void;
}

export type ViewStore = StoreApi<ViewState>;

export function createViewStore(): ViewStore {
  return createStore<ViewState>()((set, get) => ({
    views: {},
    active: null,
    change: (camera, how) => set({ views: { ...get().views, [camera]: how(get().views[camera] ?? FIT) } }),
    setActive: (active) => {
      if (get().active !== active) set({ active });
    },
    fit: () => set({ views: {} }),
  }));
}
