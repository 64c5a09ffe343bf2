/** Filters that a person keeps under a name, in this browser. */

import { create } from "zustand";

const STORED_AS = "hindsight.filters";

export interface SavedFilter {
  name: string;
  /** As in the address. */
  filter: string;
}

/** What a stored text says of filters; whatever it cannot make sense of is as if it were not there. */
export function readSaved(stored: string | null): SavedFilter[] {
  try {
    const said: unknown = JSON.parse(stored ?? "[]");
    if (!Array.isArray(said)) return [];
    return said.filter((one): one is SavedFilter => typeof one?.name === "string" && typeof one?.filter === "string");
  } catch {
    return [];
  }
}

interface SavedFilters {
  saved: SavedFilter[];
  save: (one: SavedFilter) => void;
  forget: (name: string) => void;
}

function stored(): string | null {
  try {
    return localStorage.getItem(STORED_AS);
  } catch {
    return null;
  }
}

function keep(saved: SavedFilter[]): { saved: SavedFilter[] } {
  try {
    localStorage.setItem(STORED_AS, JSON.stringify(saved));
  } catch {
    // A browser that keeps nothing still has them until the page is left.
  }
  return { saved };
}

export const useSavedFilters = create<SavedFilters>()((set) => ({
  saved: readSaved(stored()),
  save: (one) => set(({ saved }) => keep([...saved.filter((other) => other.name !== one.name), one])),
  forget: (name) => set(({ saved }) => keep(saved.filter((one) => one.name !== name))),
}));
