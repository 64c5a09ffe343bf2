import { describe, expect, it } from "vitest";
import type { Merge } from "../../api/types";
import { text } from "../../strings";
import { chance, facts } from "./evidenceWords";

const merge = (more: Partial<Merge>) =>
  ({ shared_frames: 12, agreeing_frames: 11, mean_distance_m: 0.4, mean_bev_iou: 0.5, ...more }) as Merge;

describe("evidence in words", () => {
  it.each([
    [0.99, "99%", text.queue.chances.almostSure],
    [0.935, "93.5%", text.queue.chances.likely],
    [0.5, "50%", text.queue.chances.open],
    [0.2, "20%", text.queue.chances.unlikely],
    [0.01, "1%", text.queue.chances.hardly],
  ])("%d reads %s", (probability, value, meaning) => {
    expect(chance(probability)).toEqual({ value, meaning });
  });

  it("says what speaks for one object", () => {
    expect(facts(merge({})).map((fact) => [fact.value, fact.speaks])).toEqual([
      ["11 of 12", 1],
      ["0.40 m", 1],
      ["50.0%", 1],
    ]);
  });

  it("and what speaks against it", () => {
    const against = facts(merge({ agreeing_frames: 1, mean_distance_m: 3.1, mean_bev_iou: 0 }));
    expect(against.map((fact) => fact.speaks)).toEqual([-1, -1, -1]);
  });

  it("says nothing of what was not measured", () => {
    const none = { shared_frames: 0, agreeing_frames: 0, mean_distance_m: null, mean_bev_iou: null };
    const found = facts(merge(none as unknown as Partial<Merge>));
    expect(found.map((fact) => fact.value)).toEqual([text.queue.evidence.never]);
  });
});
