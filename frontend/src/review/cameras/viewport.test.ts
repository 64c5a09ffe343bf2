import { describe, expect, it } from "vitest";
import { FIT, LARGEST_ZOOM, panBy, toPicture, transformOf, zoomAt } from "./viewport";

const tile = { width: 400, height: 200 };
const picture = { width: 1600, height: 800 };

describe("zoomAt", () => {
  it("keeps what is under the pointer under it", () => {
    const at = { x: 0.25, y: 0.75 };
    const before = toPicture(transformOf(FIT, tile, picture), { x: 100, y: 150 });
    const view = zoomAt(zoomAt(FIT, 2, at), 1.7, at);
    const after = toPicture(transformOf(view, tile, picture), { x: 100, y: 150 });
    expect(before).toEqual({ x: 400, y: 600 });
    expect(after.x).toBeCloseTo(400);
    expect(after.y).toBeCloseTo(600);
  });

  it("never shows more than the picture, nor zooms without end", () => {
    expect(zoomAt(FIT, 0.2, { x: 0, y: 0 })).toEqual(FIT);
    expect(zoomAt(FIT, 1e9, { x: 0.5, y: 0.5 }).zoom).toBe(LARGEST_ZOOM);
    // Zoomed at a corner, then out elsewhere: the picture is moved back in.
    expect(zoomAt(zoomAt(FIT, 4, { x: 0, y: 0 }), 0.25, { x: 1, y: 1 })).toEqual(FIT);
  });
});

describe("panBy", () => {
  it("moves by parts of the tile, and stops at the picture's edge", () => {
    const view = zoomAt(FIT, 2, { x: 0.5, y: 0.5 });
    expect(panBy(view, { x: 0.25, y: 0 })).toEqual({ zoom: 2, x: 0.375, y: 0.5 });
    expect(panBy(view, { x: 5, y: -5 })).toEqual({ zoom: 2, x: 0.25, y: 0.75 });
    expect(panBy(FIT, { x: 0.5, y: 0.5 })).toEqual(FIT);
  });
});

describe("transformOf", () => {
  it("places the picture on the tile", () => {
    expect(transformOf(FIT, tile, picture)).toEqual({ scale: 0.25, offsetX: 0, offsetY: 0 });
    expect(transformOf({ zoom: 2, x: 0.25, y: 0.75 }, tile, picture)).toEqual({
      scale: 0.5,
      offsetX: 0,
      offsetY: -200,
    });
  });
});
