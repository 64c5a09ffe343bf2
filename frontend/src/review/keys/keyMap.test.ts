import { describe, expect, it } from "vitest";
import { text } from "../../strings";
import { keyOf, ownKeysOf, readOwnKeys, rebind } from "./bindings";
import { chordOf, showChord } from "./chord";
import { actionOf, conflictOf, DEFAULT_BINDINGS, KEY_MAP, type KeyPress } from "./keyMap";

const press = (key: string, more: Partial<KeyPress> = {}): KeyPress => ({
  key,
  code: "",
  ctrlKey: false,
  metaKey: false,
  altKey: false,
  focus: { role: null, tag: "BODY", editable: false },
  ...more,
});
const onRole = (role: string) => ({ focus: { role, tag: "DIV", editable: false } });

describe("actionOf", () => {
  it.each([
    ["d", "previousFrame"],
    ["F", "nextFrame"],
    ["v", "forward10"],
    [" ", "playPause"],
    ["ArrowDown", "nextMerge"],
    ["a", "accept"],
    ["r", "reject"],
    ["u", "undo"],
    ["?", "help"],
    ["Escape", "clear"],
    ["y", null],
  ])("%s is %s", (key, action) => {
    expect(actionOf(press(key))).toBe(action);
  });

  it("leaves the browser's own shortcuts alone", () => {
    expect(actionOf(press("r", { ctrlKey: true }))).toBeNull();
    expect(actionOf(press("a", { metaKey: true }))).toBeNull();
    expect(actionOf(press("ArrowLeft", { altKey: true }))).toBeNull();
  });

  it("leaves a text field its keys", () => {
    expect(actionOf(press("a", { focus: { role: null, tag: "INPUT", editable: true } }))).toBeNull();
  });

  it.each([
    // A focused button is pressed by Space, but A still accepts.
    ["a button and Space", " ", { focus: { role: null, tag: "BUTTON", editable: false } }, null],
    ["a button and A", "a", { focus: { role: null, tag: "BUTTON", editable: false } }, "accept"],
    ["a slider and an arrow", "ArrowLeft", onRole("slider"), null],
    ["a slider and D", "d", onRole("slider"), "previousFrame"],
    ["a tab and an arrow", "ArrowRight", onRole("tab"), null],
    ["a menu item and a letter", "a", onRole("menuitem"), null],
  ])("shares keys with what has the focus: %s", (_, key, more, action) => {
    expect(actionOf(press(key, more))).toBe(action);
  });

  it("gives every key one meaning, and every action its words", () => {
    const keys = KEY_MAP.flatMap((binding) => binding.keys);
    expect(new Set(keys).size).toBe(keys.length);
    expect(Object.keys(text.keys.actions).sort()).toEqual(KEY_MAP.map((binding) => binding.action).sort());
  });

  it("names one key on a button, which does what the button does", () => {
    expect(keyOf("previousFrame")).toBe("D");
    expect(keyOf("playPause")).toBe("Space");
    expect(KEY_MAP.map((binding) => keyOf(binding.action))).not.toContain("");
  });
});

describe("chords", () => {
  it.each([
    ["a letter in capitals is the letter", { key: "F", shiftKey: true }, "f", "F"],
    ["Ctrl and Command are one", { key: "z", metaKey: true }, "Mod+z", "Ctrl+Z"],
    ["Shift counts beside Ctrl", { key: "Z", ctrlKey: true, shiftKey: true }, "Mod+Shift+z", "Ctrl+Shift+Z"],
    ["Shift counts with a named key", { key: "ArrowLeft", shiftKey: true }, "Shift+ArrowLeft", "Shift+←"],
    ["Shift of a sign is the layout's", { key: "?", shiftKey: true }, "?", "?"],
    ["Alt makes another letter on a Mac", { key: "µ", code: "KeyM", altKey: true }, "Alt+m", "Alt+M"],
    ["a plus with Ctrl", { key: "+", ctrlKey: true }, "Mod++", "Ctrl++"],
  ])("%s", (_, more, chord, shown) => {
    expect(chordOf(press("", more))).toBe(chord);
    expect(showChord(chord, false)).toBe(shown);
  });

  it("waits while only a modifier is down", () => {
    expect(chordOf(press("Shift", { shiftKey: true }))).toBeNull();
  });
});

describe("own keys", () => {
  it("finds who has a key, and takes it away when asked", () => {
    expect(conflictOf(DEFAULT_BINDINGS, "reject", "a")).toBe("accept");
    expect(conflictOf(DEFAULT_BINDINGS, "reject", "r")).toBeNull();
    const changed = rebind(DEFAULT_BINDINGS, "reject", "a");
    expect(actionOf(press("a"), changed)).toBe("reject");
    expect(actionOf(press("r"), changed)).toBeNull();
    expect(actionOf(press("Enter", { ctrlKey: true }), changed)).toBe("accept");
    expect(ownKeysOf(changed)).toEqual({ accept: ["Mod+Enter"], reject: ["a"] });
  });

  it("reads what it stored, and nothing that makes no sense", () => {
    expect(readOwnKeys('{"accept":["x"],"fly":["y"],"reject":"r","undo":[1]}')).toEqual({ accept: ["x"] });
    expect(readOwnKeys("{")).toEqual({});
    expect(readOwnKeys(null)).toEqual({});
  });
});
