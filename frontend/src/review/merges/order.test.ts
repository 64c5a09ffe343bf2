import { describe, expect, it } from "vitest";
import type { Merge } from "../../api/types";
import { afterDecision, bestFrame, mergesOf, stepMerge } from "./order";

const merge = (id: number, priority: number, state: Merge["state"] = "proposed") => ({ id, priority, state }) as Merge;

const queue = [merge(1, 0.9), merge(2, 0.8), merge(3, 0.7)];

describe("the queue of merges", () => {
  it("puts what matters most first, then the older", () => {
    const all = [merge(4, 0.5), merge(5, 9), merge(3, 0.5), merge(8, 99, "accepted")];
    expect(mergesOf(all, "proposed").map((one) => one.id)).toEqual([5, 3, 4]);
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

  it.each([
    ["the frame that speaks most for it", { best_frames: [{ frame_index: 7 }, { frame_index: 3 }] }, 7],
    [
      "the end of the first, where they follow one another",
      { best_frames: [], evidence: { gap_frames: [12, 19] } },
      12,
    ],
    ["no frame where nothing was measured", { best_frames: [], evidence: null }, null],
    ["no frame where both are seen but nothing agrees", { best_frames: [], evidence: { gap_frames: null } }, null],
  ])("goes to %s", (_, one, frame) => {
    expect(bestFrame(one as unknown as Merge)).toBe(frame);
  });

  it("ends with nothing after the last decision", () => {
    expect(afterDecision([merge(1, 0.9)], 1)).toBeNull();
    expect(stepMerge([], null, 1)).toBeNull();
  });
});
