import { describe, expect, it } from "vitest";
import type { Identity } from "../../api/types";
import { nearestFrame } from "./nearestFrame";
import { sortIdentities } from "./sort";

const identity = (id: number, class_name: string, score: number, observation_count: number, propagated_count: number) =>
  ({ id, class_name, score, observation_count, propagated_count }) as Identity;

const all = [
  { ...identity(1, "car", 0.5, 10, 3), first_frame: 0, last_frame: 90 },
  { ...identity(2, "bus", 0.9, 10, 0), first_frame: 5, last_frame: 14 },
  { ...identity(3, "car", 0.7, 40, 9), first_frame: 0, last_frame: 50 },
];
const failed = { check: "speed", value: 90, unit: "m/s", frame_index: 1 } as const;
const facts = new Map([
  [1, { identity_id: 1, nearest_m: 9, farthest_m: 60, purity: 0.9, failed: [] }],
  [2, { identity_id: 2, nearest_m: null, farthest_m: null, purity: null, failed: [] }],
  [3, { identity_id: 3, nearest_m: 4, farthest_m: 30, purity: 0.4, failed: [failed] }],
]);

describe("sortIdentities", () => {
  it.each([
    ["frames", [3, 1, 2]],
    ["score", [2, 3, 1]],
    ["score_low", [1, 3, 2]],
    ["propagated", [3, 1, 2]],
    ["class", [2, 3, 1]],
    ["length", [1, 3, 2]],
    ["near", [3, 1, 2]], // the distance of 2 is not known: it comes last
    ["far", [1, 3, 2]],
    ["failed", [3, 1, 2]],
    ["purity_low", [3, 1, 2]],
  ] as const)("by %s", (by, ids) => {
    expect(sortIdentities(all, by, facts).map((one) => one.id)).toEqual(ids);
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
