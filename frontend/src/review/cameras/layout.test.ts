import { describe, expect, it } from "vitest";
import { arrangements, layoutCameras, placeOf } from "./layout";

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
    [1000, 700],
    [700, 1000],
    [2400, 600],
  ])("keeps front above rear and left beside right in %i x %i", (width, height) => {
    const tiles = layoutCameras(rig, wide, { width, height, gap: 6 });
    expect(tiles).toHaveLength(4);
    expect(centre(tiles, "front").y).toBeLessThan(centre(tiles, "rear").y);
    expect(centre(tiles, "left").x).toBeLessThan(centre(tiles, "right").x);
    expect(centre(tiles, "left").y).toBe(centre(tiles, "right").y);
    expect(centre(tiles, "front").x).toBeCloseTo(width / 2);
    expect(centre(tiles, "rear").x).toBeCloseTo(width / 2);
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
