import { describe, expect, it } from "vitest";
import { arrangements, inCarOrder, layoutCameras, placeOf } from "./layout";

describe("placeOf", () => {
  it.each([
    ["front", "front", "centre"],
    ["rear", "rear", "centre"],
    ["left", "side", "left"],
    ["right", "side", "right"],
    // Argoverse 2
    ["ring_front_center", "front", "centre"],
    ["ring_side_left", "side", "left"],
    ["ring_rear_right", "rear", "right"],
    // nuScenes
    ["CAM_FRONT", "front", "centre"],
    ["CAM_BACK_LEFT", "rear", "left"],
    // Words without a gap, and camel case
    ["frontleft", "front", "left"],
    ["CameraRearRight", "rear", "right"],
    ["center", "front", "centre"],
  ])("%s stands %s, %s", (camera, row, column) => {
    expect(placeOf(camera)).toEqual({ row, column });
  });

  it.each(["image_02", "cam3", "", "thermal", "bright"])("says nothing about %s", (camera) => {
    expect(placeOf(camera)).toBeNull();
  });
});

describe("inCarOrder", () => {
  it.each([
    [
      ["CAM_BACK", "CAM_BACK_LEFT", "CAM_FRONT", "CAM_FRONT_LEFT"],
      ["CAM_FRONT_LEFT", "CAM_FRONT", "CAM_BACK_LEFT", "CAM_BACK"],
    ],
    // Cameras whose name says nothing keep their order and come last.
    [
      ["x2", "rear", "x1", "right", "left", "front"],
      ["front", "left", "right", "rear", "x2", "x1"],
    ],
  ])("%s", (cameras, expected) => {
    expect(inCarOrder(cameras)).toEqual(expected);
  });
});

const square = () => 1;
const wide = () => 2;

function centre(tiles: ReturnType<typeof layoutCameras>, camera: string) {
  const tile = tiles.find((one) => one.camera === camera);
  if (!tile) throw new Error(`no tile for ${camera}`);
  return { x: tile.x + tile.width / 2, y: tile.y + tile.height / 2 };
}

describe("layoutCameras", () => {
  const rig = ["rear", "left", "front", "right"];

  it.each([
    // Higher than wide: one above two above one.
    ["a high room", 700, 1000],
    // Left, front and right in a line.
    ["a low room", 2400, 600],
  ])("keeps front above rear and left beside right in %s", (_, width, height) => {
    const tiles = layoutCameras(rig, wide, { width, height, gap: 6 });
    expect(tiles).toHaveLength(4);
    expect(centre(tiles, "front").y).toBeLessThan(centre(tiles, "rear").y);
    expect(centre(tiles, "left").x).toBeLessThan(centre(tiles, "right").x);
    expect(centre(tiles, "left").y).toBe(centre(tiles, "right").y);
    expect(centre(tiles, "front").x).toBeCloseTo(width / 2);
    expect(centre(tiles, "rear").x).toBeCloseTo(width / 2);
  });

  it("puts the usual rig two by two where that shows more: front and rear above left and right", () => {
    const tiles = layoutCameras(rig, wide, { width: 1000, height: 700, gap: 0 });
    // 500 wide each; one above two above one would have 233 px of height each, so 466 of width.
    expect(tiles).toEqual([
      { camera: "front", x: 0, y: 100, width: 500, height: 250 },
      { camera: "rear", x: 500, y: 100, width: 500, height: 250 },
      { camera: "left", x: 0, y: 350, width: 500, height: 250 },
      { camera: "right", x: 500, y: 350, width: 500, height: 250 },
    ]);
  });

  it.each([
    // Names say nothing, a wide room: beside each other in their order, 400 wide each. Below each other: 200.
    ["beside each other", ["cam2", "cam3"], 800, 200, { cam2: [0, 0, 400], cam3: [400, 0, 400] }],
    ["below each other", ["cam2", "cam3"], 400, 400, { cam2: [0, 0, 400], cam3: [0, 200, 400] }],
    ["rear right of front", ["rear", "front"], 800, 200, { front: [0, 0, 400], rear: [400, 0, 400] }],
    [
      "left on the left, though the front comes first",
      ["front", "left"],
      800,
      200,
      { left: [0, 0, 400], front: [400, 0, 400] },
    ],
    ["front on top", ["left", "front"], 400, 400, { front: [0, 0, 400], left: [0, 200, 400] }],
  ])("shows two cameras as large as it can: %s", (_, cameras, width, height, expected) => {
    const tiles = layoutCameras(cameras, wide, { width, height, gap: 0 });
    expect(Object.fromEntries(tiles.map((tile) => [tile.camera, [tile.x, tile.y, tile.width]]))).toEqual(expected);
  });

  it("shows nothing larger than what is ahead", () => {
    // The rear has a line for itself; it could be three times as large as the three above it.
    const tiles = layoutCameras(["front", "front_left", "front_right", "rear"], wide, {
      width: 900,
      height: 500,
      gap: 0,
    });
    const front = tiles.find((tile) => tile.camera === "front")?.width ?? 0;
    for (const tile of tiles) expect(tile.width).toBeLessThanOrEqual(front);
  });

  it("gives one camera all the room that its shape can use", () => {
    expect(layoutCameras(["image_02"], wide, { width: 1000, height: 900, gap: 6 })).toEqual([
      { camera: "image_02", x: 0, y: 200, width: 1000, height: 500 },
    ]);
  });

  it("stays inside the room, keeps the shape and overlaps nothing, whatever the cameras", () => {
    const six = ["CAM_BACK", "CAM_FRONT_LEFT", "CAM_FRONT", "CAM_BACK_RIGHT", "x1", "x2", "x3"];
    const tiles = layoutCameras(six, () => 16 / 9, { width: 1013, height: 677, gap: 6 });
    expect(tiles.map((tile) => tile.camera).sort()).toEqual([...six].sort());
    for (const tile of tiles) {
      expect(tile.x).toBeGreaterThanOrEqual(0);
      expect(tile.y).toBeGreaterThanOrEqual(0);
      expect(tile.x + tile.width).toBeLessThanOrEqual(1013.001);
      expect(tile.y + tile.height).toBeLessThanOrEqual(677.001);
      expect(tile.width / tile.height).toBeCloseTo(16 / 9);
      for (const other of tiles) {
        if (other === tile) continue;
        const apart =
          tile.x + tile.width <= other.x ||
          other.x + other.width <= tile.x ||
          tile.y + tile.height <= other.y ||
          other.y + other.height <= tile.y;
        expect(apart).toBe(true);
      }
    }
  });

  it("gives slack of a wide row to the row that can use it", () => {
    // Two squares in a room 100 wide and 90 high: the lower row is capped at 50 by its width, the upper takes 40.
    const tiles = layoutCameras(["front", "left", "right"], square, { width: 60, height: 90, gap: 0 });
    // One above two: 30 for the row of two, 60 for the one above. It beats three in a line (20 each).
    expect(tiles.map(({ camera, width }) => [camera, width])).toEqual([
      ["front", 60],
      ["left", 30],
      ["right", 30],
    ]);
  });

  it("puts an enlarged camera over a strip of the others", () => {
    const tiles = layoutCameras(rig, wide, { width: 1000, height: 700, gap: 6 }, "left");
    expect(tiles[0]?.camera).toBe("left");
    for (const tile of tiles.slice(1)) {
      expect(tile.y).toBeGreaterThan((tiles[0]?.y ?? 0) + (tiles[0]?.height ?? 0));
      expect(tile.width).toBeLessThan((tiles[0]?.width ?? 0) / 2);
    }
  });

  it("shows nothing where there is no room or no camera", () => {
    expect(layoutCameras(rig, wide, { width: 0, height: 700, gap: 6 })).toEqual([]);
    expect(layoutCameras([], wide, { width: 100, height: 100, gap: 6 })).toEqual([]);
  });

  it("tries cameras without a place in every number of columns", () => {
    const rows = arrangements(["a", "b", "c"]).map((arrangement) => arrangement.map((row) => row.join("")).join("|"));
    expect(new Set(rows)).toEqual(new Set(["a|b|c", "ab|c", "abc"]));
  });
});
