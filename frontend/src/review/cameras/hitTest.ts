import type { Observation } from "../../api/types";

/** The observation under a point (px of the original picture): the smallest box around it, so that small ones can be reached. */
export function observationAt(
  observations: readonly Observation[],
  x: number,
  y: number,
  slackPx = 0,
): Observation | null {
  let best: Observation | null = null;
  let bestArea = Number.POSITIVE_INFINITY;
  for (const one of observations) {
    const [x1, y1, x2, y2] = one.box as [number, number, number, number];
    if (x < x1 - slackPx || x > x2 + slackPx || y < y1 - slackPx || y > y2 + slackPx) continue;
    const area = (x2 - x1) * (y2 - y1);
    if (area < bestArea) {
      best = one;
      bestArea = area;
    }
  }
  return best;
}
