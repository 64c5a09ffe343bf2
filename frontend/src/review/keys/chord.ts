/**
 * Keys as they are written down: `d`, `ArrowLeft`, `Mod+z`, `Mod+Shift+z`, `Alt+m`.
 *
 * `Mod` is Ctrl, or Command on a Mac. Shift counts with a named key, or beside another modifier: a plain letter is the
 * same in capitals, and of a sign like `?` the keyboard's layout decides whether it takes Shift.
 */

/** The parts of a `KeyboardEvent` that make a chord. */
export interface Pressed {
  key: string;
  /** `KeyboardEvent.code`: Alt with a letter makes another letter on a Mac. */
  code?: string;
  ctrlKey: boolean;
  metaKey: boolean;
  altKey: boolean;
  shiftKey?: boolean;
}

const MODIFIERS = new Set(["Control", "Shift", "Alt", "Meta", "AltGraph", "CapsLock"]);

/** The chord of a key press, or null while only modifiers are down. */
export function chordOf(press: Pressed): string | null {
  if (MODIFIERS.has(press.key) || press.key === "Dead" || press.key === "") return null;
  const mod = press.ctrlKey || press.metaKey;
  const single = [...press.key].length === 1;
  const fromCode = press.altKey ? /^(?:Key|Digit)(.)$/.exec(press.code ?? "")?.[1] : undefined;
  const key = single ? (fromCode ?? press.key).toLowerCase() : press.key;
  const isSign = single && !/[a-z0-9]/i.test(key);
  const shift = press.shiftKey === true && !isSign && (!single || mod || press.altKey);
  return [mod && "Mod", press.altKey && "Alt", shift && "Shift", key].filter(Boolean).join("+");
}

const NAMES: Record<string, string> = {
  " ": "Space",
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
  Escape: "Esc",
  Delete: "Del",
  PageUp: "PgUp",
  PageDown: "PgDn",
};

export const isMac = typeof navigator !== "undefined" && /^Mac|^iP/.test(navigator.platform);

/** A chord as printed on the keyboard: `Mod+z` -> "Ctrl+Z". */
export function showChord(chord: string, mac = isMac): string {
  // The key itself may be a plus.
  const parts =
    chord === "+" ? ["+"] : chord.endsWith("++") ? [...chord.slice(0, -2).split("+"), "+"] : chord.split("+");
  return parts
    .map((part, index) => {
      if (index < parts.length - 1) return part === "Mod" ? (mac ? "⌘" : "Ctrl") : part;
      return NAMES[part] ?? (part.length === 1 ? part.toUpperCase() : part);
    })
    .join("+");
}
