/** The identities of the list in their order: keys step through them. */

import { create } from "zustand";

interface IdentityList {
  order: number[];
  setOrder: (order: number[]) => void;
}

export const useIdentityList = create<IdentityList>()((set) => ({
  order: [],
  setOrder: (order) => set({ order }),
}));
