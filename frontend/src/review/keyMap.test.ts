import { describe, expect, it } from "vitest";
import { text } from "../strings";
import { actionOf, KEY_MAP, type KeyPress, keyOf } from "./keyMap";

const press = (key: string, more: Partial<KeyPress> = {}): KeyPress => ({
  key,
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
    ["x", null],
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
