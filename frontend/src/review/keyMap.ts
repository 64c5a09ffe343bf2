/** Every key of the review page: what it does, and how it is listed. */

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
  | "undo"
  | "goToDonor"
  | "clear"
  | "toggleScene"
  | "enlarge"
  | "help";

export interface KeyBinding {
  action: Action;
  /** `KeyboardEvent.key`, letters in lower case. */
  keys: readonly string[];
  /** As printed on the keyboard. */
  shown: readonly string[];
  group: "move" | "decide" | "view";
}

export const KEY_MAP: readonly KeyBinding[] = [
  { action: "previousFrame", keys: ["d", "ArrowLeft"], shown: ["D", "←"], group: "move" },
  { action: "nextFrame", keys: ["f", "ArrowRight"], shown: ["F", "→"], group: "move" },
  { action: "back10", keys: ["c"], shown: ["C"], group: "move" },
  { action: "forward10", keys: ["v"], shown: ["V"], group: "move" },
  { action: "firstFrame", keys: ["Home"], shown: ["Home"], group: "move" },
  { action: "lastFrame", keys: ["End"], shown: ["End"], group: "move" },
  { action: "playPause", keys: [" "], shown: ["Space"], group: "move" },
  { action: "nextMerge", keys: ["j", "ArrowDown"], shown: ["J", "↓"], group: "decide" },
  { action: "previousMerge", keys: ["k", "ArrowUp"], shown: ["K", "↑"], group: "decide" },
  { action: "accept", keys: ["a"], shown: ["A"], group: "decide" },
  { action: "reject", keys: ["r"], shown: ["R"], group: "decide" },
  { action: "undo", keys: ["u"], shown: ["U"], group: "decide" },
  { action: "goToDonor", keys: ["g"], shown: ["G"], group: "view" },
  { action: "enlarge", keys: ["e"], shown: ["E"], group: "view" },
  { action: "toggleScene", keys: ["t"], shown: ["T"], group: "view" },
  { action: "clear", keys: ["Escape"], shown: ["Esc"], group: "view" },
  { action: "help", keys: ["?"], shown: ["?"], group: "view" },
];

const BY_KEY = new Map(KEY_MAP.flatMap((binding) => binding.keys.map((key) => [key, binding.action] as const)));

/** The key of an action, as buttons show it: the first of those that do the same. */
export function keyOf(action: Action): string {
  return KEY_MAP.find((binding) => binding.action === action)?.shown[0] ?? "";
}

/** The parts of a `KeyboardEvent` that decide. */
export interface KeyPress {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  altKey: boolean;
  /** What has the focus: keys that it uses itself are its own. */
  focus: { role: string | null; tag: string; editable: boolean };
}

/** Keys that controls with the focus use themselves. */
const OWN_KEYS: Record<string, RegExp> = {
  button: /^( |Enter)$/,
  link: /^Enter$/,
  checkbox: /^ $/,
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
export function actionOf(press: KeyPress): Action | null {
  if (press.ctrlKey || press.metaKey || press.altKey) return null;
  if (press.focus.editable) return null;
  const role = press.focus.role ?? TAG_ROLES[press.focus.tag] ?? "";
  if (OWN_KEYS[role]?.test(press.key)) return null;
  return BY_KEY.get(press.key.length === 1 ? press.key.toLowerCase() : press.key) ?? null;
}
