import { describe, expect, it } from "vitest";
import type { LabelHistogram, PrecisionRecallCurve } from "../api/types";
import { byClass, qualityAt, scores, ThresholdCounts } from "./histogram";

/** Two cars at 5 m (.95 own, .29 own but .95 propagated), a person at 15 m (.5), and a car of unknown distance and score. */
const histogram: LabelHistogram = {
  class_names: ["car", "truck", "person"],
  distance_edges_m: [0, 10],
  sources: ["auto", "propagated", "human"],
  class_id: [0, 0, 2, 0],
  source: [0, 1, 0, 0],
  score_bin: [95, 95, 50, null],
  distance_bin: [0, 0, 1, null],
  count: [10, 4, 3, 2],
  own_score_bin: [95, 29, 50, null],
  own_source: [0, 1, 0, 0],
  own_count: [10, 4, 3, 2],
  revision: 1,
};

describe("labels above a threshold", () => {
  const counts = new ThresholdCounts(histogram);

  it.each([
    [0, 19, 17], // all, also the one without a score; the detector did not see that one
    [0.29, 17, 17], // exactly at a bin: .29 * 100 is not 29 in floating point
    [0.3, 17, 13],
    [0.5, 17, 13],
    [0.51, 14, 10],
    [0.95, 14, 10],
    [0.96, 0, 0],
    [1, 0, 0],
  ])("at %d: %d labels, %d before propagation", (threshold, total, before) => {
    expect(counts.at(threshold)).toMatchObject({ total, before });
  });

  it("are counted by distance and source", () => {
    expect(counts.at(0).byDistance).toEqual([
      { range: { from: 0, to: 10 }, bySource: [10, 4, 0] },
      { range: { from: 10, to: null }, bySource: [3, 0, 0] },
      { range: null, bySource: [2, 0, 0] },
    ]);
  });

  it("are counted for one class", () => {
    expect(new ThresholdCounts(histogram, "person").at(0).total).toBe(3);
    expect(new ThresholdCounts(histogram, "truck").at(0).total).toBe(0);
  });

  it("are none where there are none", () => {
    const none = { ...histogram, class_id: [], source: [], score_bin: [], distance_bin: [], count: [] };
    expect(new ThresholdCounts({ ...none, own_count: [], own_score_bin: [], own_source: [] }).at(0).total).toBe(0);
  });
});

describe("precision and recall", () => {
  const curve = {
    threshold: [0.9, 0.8, 0.5],
    precision: [0.99, 0.95, 0.8],
    recall: [0.3, 0.5, 0.7],
  } as PrecisionRecallCurve;

  it.each([
    [0.8, 0.95], // at a point of the curve
    [0.81, 0.99], // between two: the one that is not below
    [0.1, 0.8], // below all
  ])("at %d: precision %d", (threshold, precision) => {
    expect(qualityAt(curve, threshold)?.precision).toBe(precision);
  });

  it("are not known above the curve, or without one", () => {
    expect(qualityAt(curve, 0.95)).toBeNull();
    expect(qualityAt(undefined, 0.5)).toBeNull();
  });
});

describe("the summary", () => {
  it("counts labels by class, the most first, without classes that are not there", () => {
    expect(byClass(histogram)).toEqual([
      { className: "car", bySource: [12, 4, 0], total: 16 },
      { className: "person", bySource: [3, 0, 0], total: 3 },
    ]);
  });

  it("compares scores before and after", () => {
    const found = scores(histogram);
    expect(found.before).toEqual([0, 0, 4, 0, 0, 3, 0, 0, 0, 10]);
    expect(found.after).toEqual([2, 0, 0, 0, 0, 3, 0, 0, 0, 14]);
    expect(found.undetected).toBe(2);
  });
});
