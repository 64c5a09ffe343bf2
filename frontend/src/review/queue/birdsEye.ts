/** Geometry of the plot from above: places in metres to the picture, the car's heading up. */

import type { Way } from "../../api/types";

export interface Pose {
  x: number;
  y: number;
  yaw: number;
}

export interface Point {
  x: number;
  y: number;
}

/** Maps metres to picture points; `perMetre` is how many points a metre has. */
export interface Plane {
  toPicture: (x: number, y: number) => Point;
  perMetre: number;
  /** By how much an angle of the ground is turned in the picture, where y goes down. */
  turn: (yaw: number) => number;
}

/** The value of a way in a frame, or in the nearest one before it; null for an empty way. */
export function rowAt(way: Way, frame: number): number | null {
  let found: number | null = way.frame_index.length > 0 ? 0 : null;
  for (let row = 0; row < way.frame_index.length; row += 1) {
    if ((way.frame_index[row] as number) > frame) break;
    found = row;
  }
  return found;
}

export function poseAt(way: Way, frame: number): Pose | null {
  const row = rowAt(way, frame);
  return row === null
    ? null
    : { x: way.x_m[row] as number, y: way.y_m[row] as number, yaw: way.yaw_rad[row] as number };
}

/** The four corners of a box, from above. */
export function corners(pose: Pose, length: number, width: number): Point[] {
  const cos = Math.cos(pose.yaw);
  const sin = Math.sin(pose.yaw);
  return [
    [length / 2, width / 2],
    [length / 2, -width / 2],
    [-length / 2, -width / 2],
    [-length / 2, width / 2],
  ].map(([along = 0, across = 0]) => ({
    x: pose.x + along * cos - across * sin,
    y: pose.y + along * sin + across * cos,
  }));
}

const SMALLEST_SPAN_M = 14;
const MARGIN = 0.08;

/** The plane that shows all the points, turned so that the car of `reference` looks up. */
export function planeOf(points: readonly Point[], reference: Pose, size: { width: number; height: number }): Plane {
  const cos = Math.cos(reference.yaw);
  const sin = Math.sin(reference.yaw);
  // To the car's frame (forward, left), and from there right and up.
  const right = (x: number, y: number) => (x - reference.x) * sin - (y - reference.y) * cos;
  const up = (x: number, y: number) => (x - reference.x) * cos + (y - reference.y) * sin;
  const rights = points.map((point) => right(point.x, point.y));
  const ups = points.map((point) => up(point.x, point.y));
  const [left, width] = span(rights);
  const [bottom, height] = span(ups);
  const perMetre = Math.min(size.width / width, size.height / height) / (1 + 2 * MARGIN);
  const middle = { right: left + width / 2, up: bottom + height / 2 };
  return {
    toPicture: (x, y) => ({
      x: size.width / 2 + (right(x, y) - middle.right) * perMetre,
      y: size.height / 2 - (up(x, y) - middle.up) * perMetre,
    }),
    perMetre,
    turn: (yaw) => reference.yaw - yaw - Math.PI / 2,
  };
}

/** Where values begin and how far they go, at least the smallest span. */
function span(values: readonly number[]): [number, number] {
  if (values.length === 0) return [-SMALLEST_SPAN_M / 2, SMALLEST_SPAN_M];
  const low = Math.min(...values);
  const high = Math.max(...values);
  const width = Math.max(high - low, SMALLEST_SPAN_M);
  return [(low + high) / 2 - width / 2, width];
}

const BARS_M = [1, 2, 5, 10, 20, 50, 100, 200, 500];

/** A round length for the scale, the longest that takes at most so many picture points. */
export function barLength(perMetre: number, atMost: number): number {
  return [...BARS_M].reverse().find((metres) => metres * perMetre <= atMost) ?? 1;
}
