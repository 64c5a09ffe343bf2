import { describe, expect, it } from "vitest";
import { cropWindow } from "./cropWindow";

const picture = { width: 1000, height: 600 };

describe("cropWindow", () => {
  it("shows the box in the middle, with a margin of 0.3 on its longer side, in the aspect of the view", () => {
    // 100 x 50 with margins is 160 x 80; a square view makes it 160 x 160 around (450, 275).
    expect(cropWindow([400, 250, 500, 300], picture, 1)).toEqual({ x: 370, y: 195, width: 160, height: 160 });
  });

  it("moves into the picture at a corner", () => {
    expect(cropWindow([0, 0, 100, 100], picture, 1)).toEqual({ x: 0, y: 0, width: 160, height: 160 });
    expect(cropWindow([950, 550, 1000, 600], picture, 1)).toEqual({ x: 920, y: 520, width: 80, height: 80 });
  });

  it("is never larger than the picture, and keeps its aspect", () => {
    const window = cropWindow([0, 0, 1000, 600], picture, 1);
    expect(window).toEqual({ x: 200, y: 0, width: 600, height: 600 });
  });

  it("does not blow up a tiny box", () => {
    expect(cropWindow([500, 300, 504, 303], picture, 2)).toMatchObject({ width: 40, height: 20 });
  });
});
