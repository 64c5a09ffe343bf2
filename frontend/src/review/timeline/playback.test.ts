import { describe, expect, it } from "vitest";
import { PlaybackClock } from "./playback";

/** Frames at 0, 100, 200, 350 ms. */
const TIMES = [0, 100, 200, 350];

describe("PlaybackClock", () => {
  it("asks for each frame when it is due, by the drive's own times", () => {
    const clock = new PlaybackClock(TIMES);
    clock.start(0, 1000);
    expect(clock.tick(1099, 0)).toBeNull();
    expect(clock.tick(1100, 0)).toBe(1);
    expect(clock.tick(1116, 1)).toBeNull();
    expect(clock.tick(1200, 1)).toBe(2);
    expect(clock.tick(1216, 2)).toBeNull();
    expect(clock.tick(1349, 2)).toBeNull();
    expect(clock.tick(1350, 2)).toBe(3);
    expect(clock.tick(1366, 3)).toBe("end");
  });

  it("does not drift when animation frames come a little late", () => {
    const clock = new PlaybackClock([0, 100, 200, 300]);
    clock.start(0, 0);
    expect(clock.tick(110, 0)).toBe(1);
    expect(clock.tick(120, 1)).toBeNull();
    // Due at 200, not at 110 + 100.
    expect(clock.tick(201, 1)).toBe(2);
  });

  it("waits for a frame that is not on the screen yet, and skips none to catch up", () => {
    const clock = new PlaybackClock(TIMES);
    clock.start(0, 0);
    expect(clock.tick(100, 0)).toBe(1);
    expect(clock.tick(900, 0)).toBeNull();
    expect(clock.tick(1000, 1)).toBeNull();
    expect(clock.tick(1099, 1)).toBeNull();
    expect(clock.tick(1100, 1)).toBe(2);
  });

  it("plays at twice and at half the speed", () => {
    const clock = new PlaybackClock(TIMES, 2);
    clock.start(0, 0);
    expect(clock.tick(49, 0)).toBeNull();
    expect(clock.tick(50, 0)).toBe(1);
    clock.setSpeed(0.5);
    clock.start(1, 0);
    expect(clock.tick(199, 1)).toBeNull();
    expect(clock.tick(200, 1)).toBe(2);
  });

  it("ends at once on a drive of one frame", () => {
    const clock = new PlaybackClock([0]);
    clock.start(0, 0);
    expect(clock.tick(0, 0)).toBe("end");
  });
});
