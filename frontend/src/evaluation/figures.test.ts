import { describe, expect, it } from "vitest";
import type { Evaluation } from "../api/types";
import { binsOf, type Choice, gain, iousOf, readChoice, rowOf, runsOf, writeChoice } from "./figures";

type Row = Evaluation["rows"][number];

const whole: Choice = { cameras: "all", truth: "whole" };

function row(method: Row["method"], tp: number, more: Partial<Row> = {}): Row {
  return {
    method,
    cameras: "all",
    truth: "whole",
    iou: 0.25,
    precision: null,
    recall: null,
    tp,
    fp: 0,
    fn: 0,
    ...more,
  };
}

describe("the choice in the address", () => {
  it.each<[string, Choice]>([
    ["", whole],
    ["cameras=front", { cameras: "front", truth: "whole" }],
    ["cameras=front&truth=visible", { cameras: "front", truth: "visible" }],
  ])("'%s' is read and written as it was", (search, choice) => {
    expect(readChoice(new URLSearchParams(search))).toEqual(choice);
    expect(new URLSearchParams(writeChoice(choice)).toString()).toBe(search);
  });

  it("takes what makes no sense as if it were not there", () => {
    expect(readChoice(new URLSearchParams("cameras=rear&truth=lies"))).toEqual(whole);
  });
});

describe("the table", () => {
  const rows = [
    row("multi-camera", 40, { iou: 0.5 }),
    row("without-tracking", 24),
    row("multi-camera", 42),
    row("multi-camera", 7, { cameras: "front" }),
    row("multi-camera", 9, { truth: "visible" }),
  ];

  it("finds the row of a method, an IoU and a choice", () => {
    expect(iousOf(rows)).toEqual([0.25, 0.5]);
    expect(rowOf(rows, whole, "multi-camera", 0.5)?.tp).toBe(40);
    expect(rowOf(rows, { cameras: "front", truth: "whole" }, "multi-camera", 0.25)?.tp).toBe(7);
    expect(rowOf(rows, { cameras: "all", truth: "visible" }, "multi-camera", 0.25)?.tp).toBe(9);
    expect(rowOf(rows, whole, "single-camera", 0.25)).toBeUndefined();
  });

  it("says how many times as many objects are found, where there is something to compare with", () => {
    expect(gain(rows, whole, 0.25)).toBe(42 / 24);
    // The detector alone has no row at this IoU, and found nothing in the next.
    expect(gain(rows, whole, 0.5)).toBeNull();
    expect(gain([row("without-tracking", 0), row("multi-camera", 3)], whole, 0.25)).toBeNull();
  });
});

describe("recall by distance", () => {
  const bin = (method: Row["method"], start: number, recall: number | null, tp: number, fn: number, iou = 0.25) => ({
    method,
    iou,
    start,
    stop: start + 10,
    recall,
    tp,
    fn,
  });

  it("puts the methods of a bin together, near to far, of one IoU", () => {
    const rows = [
      bin("without-tracking", 10, 0.25, 1, 3),
      bin("without-tracking", 0, 0.5, 1, 1),
      bin("multi-camera", 0, 1, 2, 0),
      bin("multi-camera", 0, 0, 0, 2, 0.5),
    ];
    expect(binsOf(rows, 0.25)).toEqual([
      {
        start: 0,
        stop: 10,
        count: 2,
        recall: { "without-tracking": 0.5, "single-camera": null, "multi-camera": 1 },
      },
      {
        start: 10,
        stop: 20,
        count: 4,
        recall: { "without-tracking": 0.25, "single-camera": null, "multi-camera": null },
      },
    ]);
  });

  it.each([
    ["nothing", [], []],
    ["one run", [1, 2], [[1, 2]]],
    ["gaps at the ends and in the middle", [null, 1, null, null, 2, 3, null], [[1], [2, 3]]],
  ])("draws lines only between neighbours: %s", (_, points, runs) => {
    expect(runsOf<number>(points)).toEqual(runs);
  });
});
