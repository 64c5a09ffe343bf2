/** Every key of the review page: what it does, and how it is listed. Whoever acts on one says so with `useActions`. */

import { chordOf, type Pressed } from "./chord";

export type Action =
  | "previousFrame"
  | "nextFrame"
  | "back10"
  | "forward10"
  | "firstFrame"
  | "lastFrame"
  | "playPause"
  | "nextMerge"
  | "previousMerge"
  | "accept"
  | "reject"
  | "unsure"
  | "undo"
  | "queue"
  | "goToDonor"
  | "rejectDonor"
  | "clear"
  | "toggleScene"
  | "enlarge"
  | "zoomIn"
  | "zoomOut"
  | "zoomFit"
  | "panLeft"
  | "panRight"
  | "panUp"
  | "panDown"
  | "class1"
  | "class2"
  | "class3"
  | "class4"
  | "class5"
  | "class6"
  | "class7"
  | "class8"
  | "class9"
  | "split"
  | "join"
  | "swap"
  | "draw"
  | "interpolate"
  | "markReviewed"
  | "markIgnored"
  | "markOpen"
  | "comment"
  | "deleteBox"
  | "deleteObject"
  | "undoEdit"
  | "redoEdit"
  | "log"
  | "help";

export type KeyGroup = "move" | "decide" | "edit" | "view";
export const KEY_GROUPS: readonly KeyGroup[] = ["move", "decide", "edit", "view"];

export interface KeyBinding {
  action: Action;
  /** Chords that do it unless the user chose others; the first is the one that buttons show. See chord.ts. */
  keys: readonly string[];
  group: KeyGroup;
}

export const KEY_MAP: readonly KeyBinding[] = [
  { action: "previousFrame", keys: ["d", "ArrowLeft"], group: "move" },
  { action: "nextFrame", keys: ["f", "ArrowRight"], group: "move" },
  { action: "back10", keys: ["c"], group: "move" },
  { action: "forward10", keys: ["v"], group: "move" },
  { action: "firstFrame", keys: ["Home"], group: "move" },
  { action: "lastFrame", keys: ["End"], group: "move" },
  { action: "playPause", keys: [" "], group: "move" },
  { action: "nextMerge", keys: ["j", "ArrowDown"], group: "decide" },
  { action: "previousMerge", keys: ["k", "ArrowUp"], group: "decide" },
  { action: "accept", keys: ["a", "Mod+Enter"], group: "decide" },
  { action: "reject", keys: ["r"], group: "decide" },
  { action: "unsure", keys: ["s", "Mod+ "], group: "decide" },
  { action: "queue", keys: ["q"], group: "view" },
  { action: "undo", keys: ["u"], group: "decide" },
  { action: "undoEdit", keys: ["Mod+z"], group: "edit" },
  { action: "redoEdit", keys: ["Mod+Shift+z", "Mod+y"], group: "edit" },
  { action: "class1", keys: ["1"], group: "edit" },
  { action: "class2", keys: ["2"], group: "edit" },
  { action: "class3", keys: ["3"], group: "edit" },
  { action: "class4", keys: ["4"], group: "edit" },
  { action: "class5", keys: ["5"], group: "edit" },
  { action: "class6", keys: ["6"], group: "edit" },
  { action: "class7", keys: ["7"], group: "edit" },
  { action: "class8", keys: ["8"], group: "edit" },
  { action: "class9", keys: ["9"], group: "edit" },
  { action: "join", keys: ["m"], group: "edit" },
  { action: "split", keys: ["Alt+m"], group: "edit" },
  { action: "swap", keys: ["Alt+s"], group: "edit" },
  { action: "draw", keys: ["b"], group: "edit" },
  { action: "interpolate", keys: ["i"], group: "edit" },
  { action: "markReviewed", keys: ["w"], group: "edit" },
  { action: "markIgnored", keys: ["x"], group: "edit" },
  { action: "markOpen", keys: ["o"], group: "edit" },
  { action: "comment", keys: ["n"], group: "edit" },
  { action: "deleteBox", keys: ["Delete"], group: "edit" },
  { action: "deleteObject", keys: ["Shift+Delete"], group: "edit" },
  { action: "log", keys: ["h"], group: "edit" },
  { action: "rejectDonor", keys: ["Alt+g"], group: "edit" },
  { action: "goToDonor", keys: ["g"], group: "view" },
  { action: "enlarge", keys: ["e"], group: "view" },
  { action: "zoomIn", keys: ["+", "="], group: "view" },
  { action: "zoomOut", keys: ["-"], group: "view" },
  { action: "zoomFit", keys: ["0"], group: "view" },
  { action: "panLeft", keys: ["Shift+ArrowLeft"], group: "view" },
  { action: "panRight", keys: ["Shift+ArrowRight"], group: "view" },
  { action: "panUp", keys: ["Shift+ArrowUp"], group: "view" },
  { action: "panDown", keys: ["Shift+ArrowDown"], group: "view" },
  { action: "toggleScene", keys: ["t"], group: "view" },
  { action: "clear", keys: ["Escape"], group: "view" },
  { action: "help", keys: ["?"], group: "view" },
];

export type Bindings = Readonly<Record<Action, readonly string[]>>;

export const DEFAULT_BINDINGS = Object.fromEntries(
  KEY_MAP.map((binding) => [binding.action, binding.keys]),
) as unknown as Bindings;

/** A key press, and what has the focus: keys that it uses itself are its own. */
export interface KeyPress extends Pressed {
  focus: { role: string | null; tag: string; editable: boolean };
}

/** Keys that controls with the focus use themselves. */
const OWN_KEYS: Record<string, RegExp> = {
  button: /^( |Enter)$/,
  link: /^Enter$/,
  checkbox: /^ $/,
  switch: /^ $/,
  tab: /^(Arrow.*|Home|End| |Enter)$/,
  radio: /^(Arrow.*| )$/,
  slider: /^(Arrow.*|Home|End|Page.*)$/,
  separator: /^(Arrow.*|Home|End)$/,
  menuitem: /./,
  option: /./,
  combobox: /./,
  textbox: /./,
};

const TAG_ROLES: Record<string, string> = { BUTTON: "button", A: "link", SELECT: "combobox" };

/** The action that a key press asks for, or null. */
export function actionOf(press: KeyPress, bindings: Bindings = DEFAULT_BINDINGS): Action | null {
  if (press.focus.editable) return null;
  const chord = chordOf(press);
  if (chord === null) return null;
  const role = press.focus.role ?? TAG_ROLES[press.focus.tag] ?? "";
  if (OWN_KEYS[role]?.test(chord)) return null;
  return KEY_MAP.find(({ action }) => bindings[action].includes(chord))?.action ?? null;
}

/** Another action that has the chord already, or null. */
export function conflictOf(bindings: Bindings, action: Action, chord: string): Action | null {
  return KEY_MAP.find((other) => other.action !== action && bindings[other.action].includes(chord))?.action ?? null;
}
