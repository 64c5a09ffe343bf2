import { describe, expect, it } from "vitest";
import type { Identity } from "../../api/types";
import { nearestFrame } from "./nearestFrame";
import { sortIdentities } from "./sort";

const identity = (id: number, class_name: string, score: number, observation_count: number, propagated_count: number) =>
  ({ id, class_name, score, observation_count, propagated_count }) as Identity;

const all = [identity(1, "car", 0.5, 10, 3), identity(2, "bus", 0.9, 10, 0), identity(3, "car", 0.7, 40, 9)];

describe("sortIdentities", () => {
  it.each([
    ["frames", [3, 1, 2]],
    ["score", [2, 3, 1]],
    ["score_low", [1, 3, 2]],
    ["propagated", [3, 1, 2]],
    ["class", [2, 3, 1]],
  ] as const)("by %s", (by, ids) => {
    expect(sortIdentities(all, by, null).map((one) => one.id)).toEqual(ids);
  });

  it("keeps one class only where asked", () => {
    expect(sortIdentities(all, "frames", "car").map((one) => one.id)).toEqual([3, 1]);
  });
});

describe("nearestFrame", () => {
  const tracks = [
    { first_frame: 10, last_frame: 20 },
    { first_frame: 50, last_frame: 60 },
  ];
  it.each([
    ["before all", 3, 10],
    ["inside a track", 15, 15],
    ["nearer to the end of the first", 30, 20],
    ["nearer to the start of the second", 40, 50],
    ["after all", 99, 60],
  ])("%s", (_, frame, nearest) => {
    expect(nearestFrame(tracks, frame)).toBe(nearest);
  });

  it("is nothing without a track", () => {
    expect(nearestFrame([], 5)).toBeNull();
  });
});
