import { describe, expect, it } from "vitest";
import type { Track } from "../../api/types";
import { classChoices, keyedClasses } from "./classKeys";
import { type Box, cursorOf, drag, gripAt, insidePicture, MOVE } from "./handles";
import { splittable } from "./useEditActions";
import { selectionAfter } from "./useEdits";

const box: Box = [10, 10, 50, 30];

describe("handles", () => {
  it.each([
    ["the upper left corner", 11, 9, "nwse-resize"],
    ["the upper right corner", 50, 10, "nesw-resize"],
    ["the left side", 10, 20, "ew-resize"],
    ["the lower side", 30, 31, "ns-resize"],
    ["the inside", 30, 20, "move"],
  ])("%s", (_, x, y, cursor) => {
    const grip = gripAt(box, x, y, 4);
    expect(grip && cursorOf(grip)).toBe(cursor);
  });

  it("has nothing under a point outside", () => {
    expect(gripAt(box, 60, 20, 4)).toBeNull();
  });

  it("keeps the inside of a small box within reach", () => {
    expect(gripAt([10, 10, 16, 16], 13, 13, 7)).toEqual(MOVE);
  });

  it.each([
    ["a corner", { left: true, top: true, right: false, bottom: false }, [15, 13, 50, 30]],
    ["the whole box", MOVE, [15, 13, 55, 33]],
    ["a side", { left: false, top: false, right: true, bottom: false }, [10, 10, 55, 30]],
  ] as const)("drags %s", (_, grip, moved) => {
    expect(drag(box, grip, 5, 3)).toEqual(moved);
  });

  it("turns a box over rather than inside out", () => {
    expect(drag(box, { left: true, top: false, right: false, bottom: false }, 60, 0)).toEqual([50, 10, 70, 30]);
  });

  it("cuts a box at the border of the picture, and drops what is left of none", () => {
    expect(insidePicture([-5, 10, 20, 500], 100, 80)).toEqual([0, 10, 20, 80]);
    expect(insidePicture([99, 10, 120, 20], 100, 80)).toBeNull();
  });
});

describe("what is selected after a correction", () => {
  it.each([
    ["both parts of a split", [1], [1, 2], [1, 6], "split", [1, 6]],
    ["the one that others were joined to", [4, 3], [3, 4], [3], "join", [3]],
    ["nothing of what is deleted", [3], [3, 4], [], "delete", []],
    ["a new object that was drawn", [], [1, 2], [7], "box", [7]],
    ["what was selected before", [1, 2], [1, 2], [1, 2], "class", [1, 2]],
  ])("%s", (_, selected, known, changed, kind, after) => {
    expect(selectionAfter(selected, new Set(known), { identity_ids: changed }, kind)).toEqual(after);
  });
});

describe("tracks that can be split", () => {
  const tracks = [
    { id: 1, identity_id: 1, first_frame: 0, last_frame: 5 },
    { id: 2, identity_id: 2, first_frame: 0, last_frame: 5 },
  ] as Track[];
  it.each([
    [0, []],
    [1, [1]],
    [5, [1]],
    [6, []],
  ])("at frame %d", (frame, ids) => {
    expect(splittable(tracks, [1], frame).map((one) => one.id)).toEqual(ids);
  });
});

describe("classes on keys", () => {
  it("are all where there are few", () => {
    expect(keyedClasses(["car", "cone"])).toEqual(["car", "cone"]);
  });
  it("are those of roads where there are many", () => {
    const many = ["person", "car", ...Array.from({ length: 20 }, (_, n) => `thing ${n}`)];
    expect(keyedClasses(many).slice(0, 3)).toEqual(["car", "person", "thing 0"]);
    expect(keyedClasses(many)).toHaveLength(9);
    expect(new Set(classChoices(many))).toEqual(new Set(many));
  });
});
