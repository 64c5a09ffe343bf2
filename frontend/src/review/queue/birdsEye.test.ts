import { describe, expect, it } from "vitest";
import type { Way } from "../../api/types";
import { barLength, corners, planeOf, poseAt, rowAt } from "./birdsEye";

const way: Way = {
  frame_index: [2, 5, 9],
  x_m: [1, 2, 3],
  y_m: [10, 20, 30],
  yaw_rad: [0, 0.1, 0.2],
  length_m: [4, 4, 4],
  width_m: [2, 2, 2],
};
const empty: Way = { frame_index: [], x_m: [], y_m: [], yaw_rad: [], length_m: [], width_m: [] };

describe("the plot from above", () => {
  it.each([
    ["before the first", 0, 0],
    ["at one", 5, 1],
    ["between two: the one before", 8, 1],
    ["after the last", 99, 2],
  ])("finds the place of a frame %s", (_, frame, row) => {
    expect(rowAt(way, frame)).toBe(row);
  });

  it("has no place on an empty way", () => {
    expect(rowAt(empty, 3)).toBeNull();
    expect(poseAt(empty, 3)).toBeNull();
    expect(poseAt(way, 5)).toEqual({ x: 2, y: 20, yaw: 0.1 });
  });

  it("puts what is ahead up, and what is left left, wherever the car looks", () => {
    for (const yaw of [0, Math.PI / 2, -2.5]) {
      const at = { x: 100, y: -40, yaw };
      const ahead = { x: at.x + 7 * Math.cos(yaw), y: at.y + 7 * Math.sin(yaw) };
      const left = { x: at.x - 7 * Math.sin(yaw), y: at.y + 7 * Math.cos(yaw) };
      const plane = planeOf([{ x: at.x, y: at.y }, ahead, left], at, { width: 200, height: 200 });
      const car = plane.toPicture(at.x, at.y);
      const up = plane.toPicture(ahead.x, ahead.y);
      const side = plane.toPicture(left.x, left.y);
      expect(up.x).toBeCloseTo(car.x);
      expect(car.y - up.y).toBeCloseTo(7 * plane.perMetre);
      expect(car.x - side.x).toBeCloseTo(7 * plane.perMetre);
      expect(side.y).toBeCloseTo(car.y);
      expect(plane.turn(yaw)).toBeCloseTo(-Math.PI / 2); // the car itself points up
    }
  });

  it("shows all points, each as far as it is, and a single one not too large", () => {
    const plane = planeOf(
      [
        { x: 0, y: 0 },
        { x: 58, y: 0 },
      ],
      { x: 0, y: 0, yaw: 0 },
      { width: 100, height: 116 },
    );
    expect(plane.perMetre).toBeCloseTo(116 / 58 / 1.16);
    expect(plane.toPicture(0, 0).y).toBeLessThanOrEqual(116);
    expect(planeOf([{ x: 3, y: 3 }], { x: 0, y: 0, yaw: 0 }, { width: 140, height: 140 }).perMetre).toBeCloseTo(
      10 / 1.16,
    );
    expect(planeOf([], { x: 0, y: 0, yaw: 0 }, { width: 140, height: 140 }).toPicture(0, 0)).toEqual({ x: 70, y: 70 });
  });

  it("has boxes with right corners", () => {
    const [front] = corners({ x: 1, y: 1, yaw: Math.PI / 2 }, 4, 2);
    expect(front?.x).toBeCloseTo(0); // 2 ahead is up along y, 1 to the left is back along x
    expect(front?.y).toBeCloseTo(3);
  });

  it.each([
    [10, 60, 5],
    [0.1, 60, 500],
    [100, 60, 1],
  ])("has a round scale: %d points a metre, at most %d points", (perMetre, atMost, metres) => {
    expect(barLength(perMetre, atMost)).toBe(metres);
  });
});
