import { describe, expect, it } from "vitest";
import type { Track } from "../../api/types";
import { frameAt, segmentsOf } from "./segments";

const track = (id: number, identity_id: number, first_frame: number, last_frame: number) =>
  ({ id, identity_id, first_frame, last_frame, camera: "left" }) as Track;

describe("segmentsOf", () => {
  it("gives the tracks of the selection as parts of the drive; one frame has the length of a frame", () => {
    const all = [track(1, 1, 0, 9), track(2, 1, 99, 99), track(3, 3, 0, 99)];
    expect(segmentsOf(all, [1], 100)).toEqual([
      { trackId: 1, identityId: 1, camera: "left", start: 0, length: 0.1 },
      { trackId: 2, identityId: 1, camera: "left", start: 0.99, length: 0.01 },
    ]);
  });
});

describe("frameAt", () => {
  it.each([
    [-0.2, 0],
    [0, 0],
    [0.049, 0],
    [0.05, 1],
    [0.999, 19],
    [1, 19],
    [1.5, 19],
  ])("at %d of 20 frames is frame %i", (part, frame) => {
    expect(frameAt(part, 20)).toBe(frame);
  });
});
