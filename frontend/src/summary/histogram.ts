/** Counts of labels for any threshold, from one answer of the server: a slider asks for nothing while it moves. */

import type { LabelHistogram, PrecisionRecallCurve } from "../api/types";

/** Scores are in hundredths, 0 to 100. */
const SCORE_BINS = 101;

export interface Bin {
  /** Where it begins and ends; `to` is null for the last one. null as a whole: the distance is not known. */
  range: { from: number; to: number | null } | null;
  /** Labels by source, as the answer orders them. */
  bySource: number[];
}

export interface Exported {
  total: number;
  /** Of the detector's own boxes, before any label was propagated. */
  before: number;
  byDistance: Bin[];
}

/** For each hundredth: how many labels have at least that score, by distance and source. */
export class ThresholdCounts {
  readonly sources: readonly string[];
  private readonly edges: readonly number[];
  private readonly labels: Float64Array;
  private readonly own: Float64Array;

  constructor(histogram: LabelHistogram, className: string | null = null) {
    this.sources = histogram.sources;
    this.edges = histogram.distance_edges_m;
    const wanted = className === null ? null : histogram.class_names.indexOf(className);
    this.labels = new Float64Array(SCORE_BINS * this.width);
    this.own = new Float64Array(SCORE_BINS);
    for (let row = 0; row < histogram.count.length; row += 1) {
      if (wanted !== null && histogram.class_id[row] !== wanted) continue;
      // A label without a score counts as one of 0, as the export counts it.
      const score = histogram.score_bin[row] ?? 0;
      const distance = histogram.distance_bin[row] ?? this.edges.length;
      const at = score * this.width + distance * this.sources.length + (histogram.source[row] as number);
      this.labels[at] = (this.labels[at] as number) + (histogram.count[row] as number);
    }
    for (let row = 0; row < histogram.own_count.length; row += 1) {
      const score = histogram.own_score_bin[row];
      if (score == null) continue; // not detected: a filled-in box
      this.own[score] = (this.own[score] as number) + (histogram.own_count[row] as number);
    }
    sumFromTheTop(this.labels, this.width);
    sumFromTheTop(this.own, 1);
  }

  private get width(): number {
    return (this.edges.length + 1) * this.sources.length;
  }

  /** What is exported with a confidence of at least `threshold`, 0 to 1. */
  at(threshold: number): Exported {
    const score = Math.min(SCORE_BINS - 1, Math.max(0, Math.ceil(Number((threshold * 100).toFixed(6)))));
    const byDistance: Bin[] = [];
    let total = 0;
    for (let bin = 0; bin <= this.edges.length; bin += 1) {
      const start = score * this.width + bin * this.sources.length;
      const bySource = [...this.labels.subarray(start, start + this.sources.length)];
      total += bySource.reduce((sum, one) => sum + one, 0);
      const from = this.edges[bin];
      byDistance.push({ range: from === undefined ? null : { from, to: this.edges[bin + 1] ?? null }, bySource });
    }
    return { total, before: this.own[score] as number, byDistance };
  }
}

/** Makes rows of `width` numbers into sums of themselves and all rows after them. */
function sumFromTheTop(rows: Float64Array, width: number): void {
  for (let at = rows.length - width - 1; at >= 0; at -= 1)
    rows[at] = (rows[at] as number) + (rows[at + width] as number);
}

/** Precision and recall of a curve at a threshold; null outside of it. */
export function qualityAt(
  curve: PrecisionRecallCurve | undefined,
  threshold: number,
): { precision: number; recall: number } | null {
  if (!curve) return null;
  let best: number | null = null;
  curve.threshold.forEach((one, row) => {
    // The lowest threshold of the curve that is not below the wanted one.
    if (one >= threshold - 1e-9 && (best === null || one < (curve.threshold[best] as number))) best = row;
  });
  return best === null ? null : { precision: curve.precision[best] as number, recall: curve.recall[best] as number };
}

export interface ClassCount {
  className: string;
  bySource: number[];
  total: number;
}

/** Labels by class, the most first. */
export function byClass(histogram: LabelHistogram): ClassCount[] {
  const counts = histogram.class_names.map((className) => ({
    className,
    bySource: histogram.sources.map(() => 0),
    total: 0,
  }));
  for (let row = 0; row < histogram.count.length; row += 1) {
    const one = counts[histogram.class_id[row] as number];
    const source = histogram.source[row] as number;
    if (!one) continue;
    one.bySource[source] = (one.bySource[source] as number) + (histogram.count[row] as number);
    one.total += histogram.count[row] as number;
  }
  return counts.filter((one) => one.total > 0).sort((a, b) => b.total - a.total);
}

/** How many boxes have a score in each tenth: as the detector said, and as the labels say now. */
export function scores(histogram: LabelHistogram): { before: number[]; after: number[]; undetected: number } {
  const tenths = () => Array.from({ length: 10 }, () => 0);
  const before = tenths();
  const after = tenths();
  let undetected = 0;
  const add = (to: number[], hundredth: number, n: number) => {
    const tenth = Math.min(9, Math.floor(hundredth / 10));
    to[tenth] = (to[tenth] as number) + n;
  };
  histogram.own_count.forEach((n, row) => {
    const bin = histogram.own_score_bin[row];
    if (bin == null) undetected += n;
    else add(before, bin, n);
  });
  histogram.count.forEach((n, row) => {
    add(after, histogram.score_bin[row] ?? 0, n);
  });
  return { before, after, undetected };
}
