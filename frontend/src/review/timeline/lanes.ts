/**
 * The lanes of the timeline: one for each identity, in groups, with the tracks of each camera as segments.
 *
 * Tracks of one identity that overlap in time stand in rows below each other. Where each lane lies is known by sums of
 * heights, so that only those on the screen are drawn, however many there are.
 */

import type { Identity, Merge, Track } from "../../api/types";

export type Grouping = "class" | "camera" | "none";
export const GROUPINGS: readonly Grouping[] = ["class", "camera", "none"];

/** A stretch of one score: frames `start` to `stop`, the last left out; level 0 to 9 in tenths, or FILLED. */
export interface Run {
  start: number;
  stop: number;
  level: number;
}

export const FILLED = 10;

export interface Segment {
  trackId: number;
  camera: string;
  row: number;
  first: number;
  last: number;
  runs: readonly Run[];
  /** Its labels come from another track: they were propagated by a merge. */
  fromOtherTrack: boolean;
}

/** An identity, with what a person has said of it where the server tells. */
export type LaneIdentity = Identity & { mark?: "reviewed" | "ignored" | null };

export interface Lane {
  identity: LaneIdentity;
  first: number;
  segments: readonly Segment[];
  rows: number;
}

export type TimelineRow = { kind: "group"; name: string; count: number } | { kind: "lane"; lane: Lane };

export const GROUP_PX = 22;
export const ROW_PX = 8;
export const OPEN_ROW_PX = 13;
export const LANE_PAD_PX = 8;

/** Runs of a track from the server's numbers: frames skipped, frames, level. */
export function runsOf(numbers: readonly number[] | undefined, track: Track): Run[] {
  if (!numbers || numbers.length === 0) {
    return [{ start: track.first_frame, stop: track.last_frame + 1, level: levelOf(track.best_score) }];
  }
  const runs: Run[] = [];
  let at = 0;
  for (let index = 0; index + 2 < numbers.length; index += 3) {
    const start = at + (numbers[index] as number);
    at = start + (numbers[index + 1] as number);
    runs.push({ start, stop: at, level: numbers[index + 2] as number });
  }
  return runs;
}

export function levelOf(score: number | null): number {
  return score === null ? FILLED : Math.min(9, Math.floor(score * 10 + 1e-9));
}

/** Puts each segment into the first row in which nothing overlaps it; how many rows that takes. */
function placeInRows(segments: Segment[]): number {
  const ends: number[] = [];
  for (const segment of segments.sort((a, b) => a.first - b.first || a.trackId - b.trackId)) {
    const free = ends.findIndex((end) => end < segment.first);
    segment.row = free < 0 ? ends.length : free;
    ends[segment.row] = segment.last;
  }
  return ends.length;
}

export function lanesOf(
  identities: readonly Identity[],
  tracks: readonly Track[],
  runs: Readonly<Record<string, readonly number[]>>,
): Lane[] {
  const segments = new Map<number, Segment[]>();
  const donors = new Map(identities.map((one) => [one.id, one.donor.track_id]));
  for (const track of tracks) {
    const list = segments.get(track.identity_id) ?? [];
    segments.set(track.identity_id, list);
    list.push({
      trackId: track.id,
      camera: track.camera,
      row: 0,
      first: track.first_frame,
      last: track.last_frame,
      runs: runsOf(runs[track.id], track),
      fromOtherTrack: donors.get(track.identity_id) !== track.id,
    });
  }
  return identities
    .map((identity) => {
      const own = segments.get(identity.id) ?? [];
      return { identity, first: identity.first_frame, rows: Math.max(1, placeInRows(own)), segments: own };
    })
    .sort((a, b) => a.first - b.first || a.identity.id - b.identity.id);
}

export interface Arrangement {
  rows: readonly TimelineRow[];
  /** The upper edge of each row, and below them all the height of the whole. */
  tops: readonly number[];
}

/** Rows from top to bottom: groups by the number of their lanes, each with its lanes unless it is closed. */
export function arrange(
  lanes: readonly Lane[],
  grouping: Grouping,
  closed: ReadonlySet<string>,
  open: ReadonlySet<number>,
): Arrangement {
  const groups = new Map<string, Lane[]>();
  for (const lane of lanes) {
    const name =
      grouping === "class" ? lane.identity.class_name : grouping === "camera" ? lane.identity.donor.camera : "";
    const list = groups.get(name);
    if (list) list.push(lane);
    else groups.set(name, [lane]);
  }
  const rows: TimelineRow[] = [];
  for (const [name, list] of [...groups].sort((a, b) => b[1].length - a[1].length || (a[0] < b[0] ? -1 : 1))) {
    if (grouping !== "none") rows.push({ kind: "group", name, count: list.length });
    if (!closed.has(name)) for (const lane of list) rows.push({ kind: "lane", lane });
  }
  const tops = [0];
  for (const row of rows) tops.push((tops.at(-1) as number) + heightOf(row, open));
  return { rows, tops };
}

function heightOf(row: TimelineRow, open: ReadonlySet<number>): number {
  if (row.kind === "group") return GROUP_PX;
  return row.lane.rows * rowHeight(row.lane, open) + LANE_PAD_PX;
}

/** A selected lane is drawn larger. */
export function rowHeight(lane: Lane, open: ReadonlySet<number>): number {
  return open.has(lane.identity.id) ? OPEN_ROW_PX : ROW_PX;
}

/** The row at a height, or -1 below the last. */
export function rowAt({ tops }: Arrangement, y: number): number {
  if (y < 0 || y >= (tops.at(-1) ?? 0)) return -1;
  let low = 0;
  let high = tops.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((tops[middle] as number) <= y) low = middle;
    else high = middle;
  }
  return low;
}

export interface Link {
  merge: Merge;
  /** Where the two tracks stand. */
  from: { lane: number; segment: Segment };
  to: { lane: number; segment: Segment };
  frame: number;
}

/** Merges whose two tracks both have a lane. `lane` is the index among the rows. */
export function linksOf(merges: readonly Merge[], { rows }: Arrangement): Link[] {
  const where = new Map<number, { lane: number; segment: Segment }>();
  rows.forEach((row, lane) => {
    if (row.kind === "lane") for (const segment of row.lane.segments) where.set(segment.trackId, { lane, segment });
  });
  return merges.flatMap((merge) => {
    const from = where.get(merge.track_a);
    const to = where.get(merge.track_b);
    if (!from || !to || merge.state === "rejected") return [];
    // Tracks that share no frame are linked in the middle of the time between them.
    const apart = (Math.max(from.segment.first, to.segment.first) + Math.min(from.segment.last, to.segment.last)) / 2;
    return [{ merge, from, to, frame: merge.best_frames[0]?.frame_index ?? Math.round(apart) }];
  });
}
