import { describe, expect, it } from "vitest";
import type { Look } from "../../api/types";
import { lanes } from "./strip";

const look = (camera: string, frame_index: number) => ({ camera, frame_index }) as Look;

describe("the strip of an identity", () => {
  it("has a lane for each camera that sees it, in the car's order, on one axis of time", () => {
    const strip = [look("front", 10), look("front", 20), look("left", 20), look("rear", 30)];
    const shown = lanes(strip, ["front", "left", "right", "rear"], 250, 50);
    expect(shown.map((lane) => lane.camera)).toEqual(["front", "left", "rear"]);
    // 20 frames on 200 px: 10 px a frame
    expect(shown.map((lane) => lane.looks.map((one) => one.left))).toEqual([[0, 100], [100], [200]]);
  });

  it("leaves out looks that would cover another", () => {
    const strip = Array.from({ length: 11 }, (_, frame) => look("front", frame));
    const [lane] = lanes(strip, ["front"], 150, 50);
    // 10 px a frame, 53 px for each look
    expect(lane?.looks.map((one) => one.look.frame_index)).toEqual([0, 6]);
  });

  it("shows a single look, and nothing of nothing", () => {
    expect(lanes([look("front", 4)], ["front"], 100, 50)[0]?.looks[0]?.left).toBe(0);
    expect(lanes([], ["front"], 100, 50)).toEqual([]);
  });
});
