import { describe, expect, it } from "vitest";
import type { Identity, Merge, Track } from "../../api/types";
import {
  arrange,
  FILLED,
  GROUP_PX,
  LANE_PAD_PX,
  lanesOf,
  levelOf,
  linksOf,
  OPEN_ROW_PX,
  ROW_PX,
  rowAt,
  runsOf,
} from "./lanes";

const identity = (id: number, class_name: string, first_frame: number, camera = "front") =>
  ({ id, class_name, first_frame, donor: { track_id: id, camera, frame_index: 0 } }) as Identity;
const track = (id: number, identity_id: number, first_frame: number, last_frame: number) =>
  ({ id, identity_id, camera: "left", first_frame, last_frame, best_score: 0.5 }) as Track;

const none: ReadonlySet<never> = new Set();

describe("runsOf", () => {
  it("counts frames from the run before", () => {
    expect(runsOf([10, 4, 8, 0, 3, 2, 5, 1, 10], track(1, 1, 10, 22))).toEqual([
      { start: 10, stop: 14, level: 8 },
      { start: 14, stop: 17, level: 2 },
      { start: 22, stop: 23, level: 10 },
    ]);
  });

  it("is one stretch of the best score while nothing else is known", () => {
    expect(runsOf(undefined, track(1, 1, 3, 5))).toEqual([{ start: 3, stop: 6, level: 5 }]);
  });

  it.each([
    [0.3, 3],
    [0.29, 2],
    [1, 9],
    [null, FILLED],
  ])("a score of %s is level %d", (score, level) => {
    expect(levelOf(score)).toBe(level);
  });
});

describe("lanesOf", () => {
  it("puts overlapping tracks into rows, and reuses a row once it is free", () => {
    const tracks = [track(1, 1, 0, 10), track(2, 1, 8, 20), track(3, 1, 11, 15)];
    const [lane] = lanesOf([identity(1, "car", 0)], tracks, {});
    expect(lane?.rows).toBe(2);
    expect(lane?.segments.map(({ trackId, row }) => [trackId, row])).toEqual([
      [1, 0],
      [2, 1],
      [3, 0],
    ]);
    // The donor's own track has its own labels; the others' came through merges.
    expect(lane?.segments.map((one) => one.fromOtherTrack)).toEqual([false, true, true]);
  });

  it("keeps identities in the order in which they appear", () => {
    const lanes = lanesOf([identity(1, "car", 9), identity(2, "car", 3)], [], {});
    expect(lanes.map((lane) => lane.identity.id)).toEqual([2, 1]);
  });
});

describe("arrange", () => {
  const lanes = lanesOf([identity(1, "bus", 0, "rear"), identity(2, "car", 1), identity(3, "car", 2)], [], {});
  const names = (rows: ReturnType<typeof arrange>["rows"]) =>
    rows.map((row) => (row.kind === "group" ? row.name : row.lane.identity.id));

  it("shows the largest group first; closed groups keep their head", () => {
    expect(names(arrange(lanes, "class", none, none).rows)).toEqual(["car", 2, 3, "bus", 1]);
    expect(names(arrange(lanes, "class", new Set(["car"]), none).rows)).toEqual(["car", "bus", 1]);
    expect(names(arrange(lanes, "camera", none, none).rows)).toEqual(["front", 2, 3, "rear", 1]);
    expect(names(arrange(lanes, "none", none, none).rows)).toEqual([1, 2, 3]);
  });

  it("knows what is at a height; an open lane is larger", () => {
    const arranged = arrange(lanes, "class", none, new Set([2]));
    const open = OPEN_ROW_PX + LANE_PAD_PX;
    const closed = ROW_PX + LANE_PAD_PX;
    expect(arranged.tops).toEqual([
      0,
      GROUP_PX,
      GROUP_PX + open,
      GROUP_PX + open + closed,
      2 * GROUP_PX + open + closed,
      2 * GROUP_PX + open + 2 * closed,
    ]);
    expect(rowAt(arranged, 0)).toBe(0);
    expect(rowAt(arranged, GROUP_PX)).toBe(1);
    expect(rowAt(arranged, GROUP_PX + open - 1)).toBe(1);
    expect(rowAt(arranged, arranged.tops.at(-1) as number)).toBe(-1);
    expect(rowAt(arranged, -1)).toBe(-1);
  });

  it("finds a row among thousands", () => {
    const many = lanesOf(
      Array.from({ length: 2000 }, (_, id) => identity(id, "car", id)),
      [],
      {},
    );
    const arranged = arrange(many, "none", none, none);
    expect(rowAt(arranged, 1234 * (ROW_PX + LANE_PAD_PX) + 3)).toBe(1234);
  });
});

describe("linksOf", () => {
  it("links tracks at the frame that speaks most, or between them where they share none", () => {
    const lanes = lanesOf(
      [identity(1, "car", 0), identity(2, "car", 5)],
      [track(1, 1, 0, 10), track(2, 2, 20, 30)],
      {},
    );
    const arranged = arrange(lanes, "none", none, none);
    const merge = { id: 1, track_a: 1, track_b: 2, state: "proposed", best_frames: [] as { frame_index: number }[] };
    expect(linksOf([merge as unknown as Merge], arranged)[0]).toMatchObject({
      frame: 15,
      from: { lane: 0 },
      to: { lane: 1 },
    });
    const seen = { ...merge, best_frames: [{ frame_index: 7 }] } as unknown as Merge;
    expect(linksOf([seen], arranged)[0]?.frame).toBe(7);
    expect(linksOf([{ ...seen, state: "rejected" }], arranged)).toEqual([]);
    expect(linksOf([{ ...seen, track_b: 99 }], arranged)).toEqual([]);
  });
});
