/** What the evaluation page shows, taken out of the server's figures. */

import type { Evaluation } from "../api/types";

type Row = Evaluation["rows"][number];
type BinRecall = Evaluation["by_distance"][number];
export type Method = Row["method"];
export type CameraGroup = Row["cameras"];
export type TruthKind = Row["truth"];

/** From the plainest to the best: the order of rows, lines and colours. */
export const METHODS: readonly Method[] = ["without-tracking", "single-camera", "multi-camera"];

export interface Choice {
  cameras: CameraGroup;
  truth: TruthKind;
}

/** What the table shows, as the address says it. What it does not say, or says wrongly, is all cameras, whole boxes. */
export function readChoice(query: URLSearchParams): Choice {
  return {
    cameras: query.get("cameras") === "front" ? "front" : "all",
    truth: query.get("truth") === "visible" ? "visible" : "whole",
  };
}

/** The address' part for a choice; only what differs from a fresh page. */
export function writeChoice(choice: Choice): Record<string, string> {
  return {
    ...(choice.cameras !== "all" && { cameras: choice.cameras }),
    ...(choice.truth !== "whole" && { truth: choice.truth }),
  };
}

/** The IoUs that the table compares at, from loose to strict. */
export function iousOf(rows: readonly { iou: number }[]): number[] {
  return [...new Set(rows.map((row) => row.iou))].sort((a, b) => a - b);
}

export function rowOf(rows: readonly Row[], choice: Choice, method: Method, iou: number): Row | undefined {
  return rows.find(
    (row) => row.method === method && row.iou === iou && row.cameras === choice.cameras && row.truth === choice.truth,
  );
}

/** How many times as many objects the identities over all cameras find as the detector alone; null if none to compare. */
export function gain(rows: readonly Row[], choice: Choice, iou: number): number | null {
  const alone = rowOf(rows, choice, "without-tracking", iou)?.tp ?? 0;
  const best = rowOf(rows, choice, "multi-camera", iou)?.tp ?? 0;
  return alone > 0 ? best / alone : null;
}

export interface Bin {
  start: number;
  stop: number;
  /** True objects in it. */
  count: number;
  /** Recall by method; null where the bin holds no object. */
  recall: Record<Method, number | null>;
}

/** The bins of one IoU, near to far. */
export function binsOf(rows: readonly BinRecall[], iou: number): Bin[] {
  const bins = new Map<number, Bin>();
  for (const row of rows) {
    if (row.iou !== iou) continue;
    const bin = bins.get(row.start) ?? {
      start: row.start,
      stop: row.stop,
      count: row.tp + row.fn,
      recall: { "without-tracking": null, "single-camera": null, "multi-camera": null },
    };
    bin.recall[row.method] = row.recall;
    bins.set(row.start, bin);
  }
  return [...bins.values()].sort((a, b) => a.start - b.start);
}

/** Points of a line in runs without a gap: a bin that holds nothing breaks the line. */
export function runsOf<P>(points: readonly (P | null)[]): P[][] {
  const runs: P[][] = [];
  let open: P[] | null = null;
  for (const point of points) {
    if (point === null) open = null;
    else if (open) open.push(point);
    else {
      open = [point];
      runs.push(open);
    }
  }
  return runs;
}
