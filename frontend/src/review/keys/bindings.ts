/** The keys in force: the defaults, and what this user chose instead, kept in this browser. */

import { create } from "zustand";
import { showChord } from "./chord";
import { type Action, type Bindings, conflictOf, DEFAULT_BINDINGS } from "./keyMap";

const STORED_AS = "hindsight.keys";

export type OwnKeys = Partial<Record<Action, readonly string[]>>;

/** What a stored text says of keys; whatever it cannot make sense of is as if it were not there. */
export function readOwnKeys(stored: string | null): OwnKeys {
  let said: unknown;
  try {
    said = JSON.parse(stored ?? "{}");
  } catch {
    return {};
  }
  if (typeof said !== "object" || said === null) return {};
  return Object.fromEntries(
    Object.entries(said).filter(
      ([action, keys]) =>
        action in DEFAULT_BINDINGS && Array.isArray(keys) && keys.every((key) => typeof key === "string"),
    ),
  );
}

/**
 * The action gets this one chord. Whoever had it loses it: the dialog asks before.
 */
export function rebind(bindings: Bindings, action: Action, chord: string): Bindings {
  const other = conflictOf(bindings, action, chord);
  return {
    ...bindings,
    ...(other && { [other]: bindings[other].filter((one) => one !== chord) }),
    [action]: [chord],
  };
}

/** What of the bindings is not the default. */
export function ownKeysOf(bindings: Bindings): OwnKeys {
  return Object.fromEntries(
    Object.entries(bindings).filter(
      ([action, keys]) => keys.join("\n") !== DEFAULT_BINDINGS[action as Action].join("\n"),
    ),
  );
}

interface KeyStore {
  bindings: Bindings;
  set: (action: Action, chord: string) => void;
  reset: () => void;
}

function keep(bindings: Bindings): void {
  try {
    localStorage.setItem(STORED_AS, JSON.stringify(ownKeysOf(bindings)));
  } catch {
    // A browser that keeps nothing still has the keys until the page is left.
  }
}

function stored(): OwnKeys {
  try {
    return readOwnKeys(localStorage.getItem(STORED_AS));
  } catch {
    return {};
  }
}

export const useBindings = create<KeyStore>()((set, get) => ({
  bindings: { ...DEFAULT_BINDINGS, ...stored() },
  set: (action, chord) => {
    const bindings = rebind(get().bindings, action, chord);
    keep(bindings);
    set({ bindings });
  },
  reset: () => {
    keep(DEFAULT_BINDINGS);
    set({ bindings: DEFAULT_BINDINGS });
  },
}));

/** The key of an action, as buttons show it: the first of those that do the same; empty where it has none. */
export function keyOf(action: Action, bindings = useBindings.getState().bindings): string {
  const first = bindings[action][0];
  return first === undefined ? "" : showChord(first);
}
