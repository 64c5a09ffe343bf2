import { describe, expect, it } from "vitest";
import type { Merge } from "../../api/types";
import { afterDecision, mergesOf, stepMerge } from "./order";

const merge = (id: number, score: number, label_count = 1, state: Merge["state"] = "proposed") =>
  ({ id, score, label_count, state }) as Merge;

const queue = [merge(1, 0.9), merge(2, 0.8), merge(3, 0.7)];

describe("the queue of merges", () => {
  it("puts the surest first, then the one that changes more, then the older", () => {
    const all = [merge(4, 0.5, 1), merge(5, 0.5, 9), merge(6, 0.5, 1), merge(7, 0.9), merge(8, 0.99, 1, "accepted")];
    expect(mergesOf(all, "proposed").map((one) => one.id)).toEqual([7, 5, 4, 6]);
    expect(mergesOf(all, "accepted").map((one) => one.id)).toEqual([8]);
  });

  it.each([
    ["the first when none is open", null, 1, 1],
    ["the next", 1, 1, 2],
    ["the previous", 2, -1, 1],
    ["the last again at the end", 3, 1, 3],
    ["the first when the open one is gone", 99, 1, 1],
  ] as const)("steps to %s", (_, current, step, id) => {
    expect(stepMerge(queue, current, step)?.id).toBe(id);
  });

  it.each([
    ["the one that moves up", 1, 2],
    ["the one before, at the end", 3, 2],
  ])("opens %s after a decision", (_, decided, id) => {
    expect(afterDecision(queue, decided)?.id).toBe(id);
  });

  it("ends with nothing after the last decision", () => {
    expect(afterDecision([merge(1, 0.9)], 1)).toBeNull();
    expect(stepMerge([], null, 1)).toBeNull();
  });
});
