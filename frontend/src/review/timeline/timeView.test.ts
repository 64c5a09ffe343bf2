import { describe, expect, it } from "vitest";
import { frameAt, panTime, reveal, tickSeconds, wholeDrive, xOf, zoomTime } from "./timeView";

const all = wholeDrive(1000);

describe("the view along time", () => {
  it("zooms at the pointer", () => {
    const view = zoomTime(all, 4, 0.5, 1000);
    expect(view).toEqual({ start: 375, frames: 250 });
    expect(frameAt(view, 200, 400, 1000)).toBe(500);
    expect(xOf(view, 500, 400)).toBe(200);
  });

  it("never leaves the drive, nor shows fewer than twelve frames", () => {
    expect(zoomTime(all, 0.1, 0.3, 1000)).toEqual(all);
    expect(zoomTime(all, 1e6, 0, 1000)).toEqual({ start: 0, frames: 12 });
    expect(panTime({ start: 900, frames: 50 }, 500, 1000)).toEqual({ start: 950, frames: 50 });
    expect(panTime({ start: 10, frames: 50 }, -500, 1000)).toEqual({ start: 0, frames: 50 });
    // A drive of fewer frames than that is shown whole.
    expect(zoomTime(wholeDrive(5), 10, 0.5, 5)).toEqual({ start: 0, frames: 5 });
  });

  it("moves only where the frame is not shown", () => {
    const view = { start: 100, frames: 100 };
    expect(reveal(view, 150, 1000)).toBe(view);
    expect(reveal(view, 99, 1000)).toEqual({ start: 89, frames: 100 });
    expect(reveal(view, 200, 1000)).toEqual({ start: 111, frames: 100 });
  });

  it.each([
    // A hundred seconds on 700 px: a mark every ten seconds stands 70 px apart.
    [100, 700, 10],
    [100, 690, 15],
    [1.2, 1200, 0.1],
    [90_000, 300, 21_600],
  ])("marks %d seconds on %d px every %d seconds", (seconds, width, step) => {
    expect(tickSeconds(seconds, width)).toBe(step);
  });
});
