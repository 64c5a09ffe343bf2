/** How the list of identities is sorted and filtered, and the order that results: keys step through it. */

import { create } from "zustand";
import type { IdentitySort } from "./sort";

interface IdentityList {
  sort: IdentitySort;
  className: string | null;
  order: number[];
  setSort: (sort: IdentitySort) => void;
  setClassName: (className: string | null) => void;
  setOrder: (order: number[]) => void;
}

export const useIdentityList = create<IdentityList>()((set) => ({
  sort: "frames",
  className: null,
  order: [],
  setSort: (sort) => set({ sort }),
  setClassName: (className) => set({ className }),
  setOrder: (order) => set({ order }),
}));
