import { describe, expect, it } from "vitest";
import type { Merge } from "../../api/types";
import { text } from "../../strings";
import { chance, facts, measures, shortChance } from "./evidenceWords";

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
    expect(chance(merge({ score: probability, probability }))).toEqual({ value, meaning });
  });

  it("does not show a score that is no probability as one", () => {
    const bare = merge({ score: 0.8, probability: null });
    expect(chance(bare)).toEqual({ value: "score 0.80", meaning: text.queue.chances.noProbability });
    expect(shortChance(bare)).toBe("0.80");
    expect(shortChance(merge({ score: 0.8, probability: 0.8 }))).toBe("80%");
  });

  it("lists what a probability is made of, what says most first", () => {
    const features = [
      { name: "distance_m", value: 0.4, unit: "m", log_odds: 0.02 },
      { name: "agreeing_share", value: 0.25, unit: "share", log_odds: -1.5 },
      { name: "unheard_of", value: 2, unit: "looks", log_odds: 0.7 },
    ];
    const evidence = { calibrated: true, features } as unknown as Merge["evidence"];
    expect(measures(merge({ evidence })).map((one) => [one.name, one.value, one.speaks])).toEqual([
      ["Together", "25%", -1],
      ["unheard of", "2 looks", 1],
      ["Apart", "0.40 m", 0],
    ]);
    expect(measures(merge({ evidence }))[0]?.meaning).toContain("4.5 times less likely");
    expect(measures(merge({ evidence: { ...evidence, calibrated: false } as Merge["evidence"] }))).toEqual([]);
  });

  it("says what speaks for one object", () => {
    expect(facts(merge({})).map((fact) => [fact.value, fact.speaks])).toEqual([
      ["11 of 12", 1],
      ["0.40 m", 1],
      ["50%", 1],
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
