/** What the evidence of a merge means, in plain words. */

import type { Merge } from "../../api/types";
import { metres, percent, score } from "../../app/format";
import { text } from "../../strings";

export interface Fact {
  name: string;
  value: string;
  meaning: string;
  /** Whether it speaks for one object (1), against it (-1), or is neither (0). */
  speaks: 1 | 0 | -1;
}

/** Centres of 3D boxes of one car seen from two sides are seldom farther apart than this, about a car's width. */
const NEAR_M = 1.8;
/** Two cars side by side are at least this far apart, centre to centre. */
const FAR_M = 2.6;

/** How sure the machine is: a probability where its score is one, else the bare score, which must not read like one. */
export function chance(merge: Pick<Merge, "score" | "probability">): { value: string; meaning: string } {
  const words = text.queue.chances;
  const { probability } = merge;
  if (probability === null) return { value: text.merges.scoreIs(score(merge.score)), meaning: words.noProbability };
  const meaning =
    probability >= 0.95
      ? words.almostSure
      : probability >= 0.7
        ? words.likely
        : probability > 0.3
          ? words.open
          : probability > 0.05
            ? words.unlikely
            : words.hardly;
  return { value: whole(percent(probability)), meaning };
}

/** The same, in a few characters. */
export function shortChance(merge: Pick<Merge, "score" | "probability">): string {
  return merge.probability === null ? score(merge.score) : percent(merge.probability).replace(/\.\d%$/, "%");
}

/** "50.0%" -> "50%" */
function whole(share: string): string {
  return share.replace(/\.0%$/, "%");
}

/** Below this, in log odds, a measure hardly says anything. */
const HARDLY = 0.05;

/** What the probability was made of, what says most first; empty where the score is no probability. */
export function measures(merge: Pick<Merge, "evidence">): Fact[] {
  if (!merge.evidence?.calibrated) return [];
  return [...merge.evidence.features]
    .sort((a, b) => Math.abs(b.log_odds) - Math.abs(a.log_odds))
    .map(({ name, value, unit, log_odds }) => {
      const words = text.queue.features[name];
      return {
        name: words?.name ?? name.replaceAll("_", " "),
        value: measured(value, unit),
        meaning: `${words?.meaning ?? ""}${words ? "; " : ""}${text.queue.speaks(odds(log_odds), log_odds)}`,
        speaks: log_odds > HARDLY ? 1 : log_odds < -HARDLY ? -1 : 0,
      };
    });
}

/** By how many times a measure changes the odds, "3.2". */
function odds(logOdds: number): string {
  const times = Math.exp(Math.min(Math.abs(logOdds), 6.9));
  return times >= 10 ? times.toFixed(0) : times.toFixed(1);
}

function measured(value: number, unit: string): string {
  if (unit === "share") return whole(percent(value));
  if (unit === "m") return metres(value);
  if (unit === "sigma") return `${value.toFixed(1)} σ`;
  if (unit === "score" || unit === "ratio" || unit === "nat") return value.toFixed(2);
  return `${value.toFixed(unit === "looks" ? 0 : 1)} ${unit}`;
}

/** What was seen of both tracks at the same time. */
export function facts(merge: Merge): Fact[] {
  const { shared_frames, agreeing_frames, mean_distance_m, mean_bev_iou } = merge;
  const words = text.queue.evidence;
  const found: Fact[] = [];
  if (shared_frames > 0) {
    const share = agreeing_frames / shared_frames;
    found.push({
      name: words.together,
      value: words.of(agreeing_frames, shared_frames),
      meaning: words.togetherMeans(agreeing_frames, shared_frames),
      speaks: share >= 0.5 ? 1 : share < 0.2 ? -1 : 0,
    });
  } else found.push({ name: words.together, value: words.never, meaning: words.neverMeans, speaks: 0 });
  if (mean_distance_m !== null && Number.isFinite(mean_distance_m)) {
    found.push({
      name: words.apart,
      value: metres(mean_distance_m),
      meaning:
        mean_distance_m <= NEAR_M ? words.apartNear : mean_distance_m < FAR_M ? words.apartBetween : words.apartFar,
      speaks: mean_distance_m <= NEAR_M ? 1 : mean_distance_m < FAR_M ? 0 : -1,
    });
  }
  if (mean_bev_iou !== null && Number.isFinite(mean_bev_iou)) {
    found.push({
      name: words.overlap,
      value: whole(percent(mean_bev_iou)),
      meaning: mean_bev_iou > 0 ? words.overlapMeans : words.overlapNone,
      speaks: mean_bev_iou >= 0.2 ? 1 : mean_bev_iou > 0 ? 0 : -1,
    });
  }
  return found;
}
