import { create } from "zustand";

/** Whether a comment is being written. */
export const useCommenting = create<{ open: boolean; set: (open: boolean) => void }>()((set) => ({
  open: false,
  set: (open) => set({ open }),
}));
