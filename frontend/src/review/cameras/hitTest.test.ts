import { describe, expect, it } from "vitest";
import type { Observation } from "../../api/types";
import { observationAt } from "./hitTest";

const boxed = (id: number, box: [number, number, number, number]) => ({ id, box }) as Observation;
const near = boxed(1, [0, 0, 100, 100]);
const far = boxed(2, [40, 40, 60, 60]);

describe("observationAt", () => {
  it.each([
    ["the smaller of two boxes around the point", 50, 50, 0, 2],
    ["the larger where the smaller is not", 10, 10, 0, 1],
    ["the edge belongs to the box", 100, 100, 0, 1],
    ["beside all boxes", 101, 50, 0, undefined],
    ["beside, but within the slack", 101, 50, 2, 1],
  ])("finds %s", (_, x, y, slack, id) => {
    expect(observationAt([far, near], x, y, slack)?.id).toBe(id);
  });
});
