/** Who decides: a name that this browser keeps, and that goes along with every request. */

import { create } from "zustand";

const STORED_AS = "hindsight.reviewer";
export const REVIEWER_HEADER = "Hindsight-Reviewer";

function stored(): string {
  try {
    return localStorage.getItem(STORED_AS) ?? "";
  } catch {
    return "";
  }
}

export const useReviewer = create<{ name: string; set: (name: string) => void }>()((set) => ({
  name: stored(),
  set: (name) => {
    set({ name });
    try {
      localStorage.setItem(STORED_AS, name);
    } catch {
      // A browser that keeps nothing still has the name until the page is left.
    }
  },
}));

/** The name as a header can carry it; empty where the server's own setting is to hold. */
export function reviewerHeader(): string {
  return encodeURIComponent(useReviewer.getState().name.trim());
}
