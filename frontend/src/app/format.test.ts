import { describe, expect, it } from "vitest";
import { bytes, clock, duration, metres, percent, plural, score, sentence } from "./format";

describe("numbers", () => {
  it.each([
    [plural(1, "box", "boxes"), "1 box"],
    [plural(1200, "box", "boxes"), "1,200 boxes"],
    [score(0.9), "0.90"],
    [score(null), "–"],
    [percent(0.19672), "19.7%"],
    [percent(1), "100.0%"],
    [percent(null), "–"],
    [metres(0.456), "0.46 m"],
    [metres(12.34), "12.3 m"],
    [metres(null), "–"],
    [clock(95_300), "1:35.3"],
    // Rounds up into the next minute, not to 60 seconds.
    [clock(59_960), "1:00.0"],
    [duration(23_900), "23.9 s"],
    [duration(119_600), "2 min 0 s"],
    [duration(7_260_000), "2 h 1 min"],
    [bytes(999), "999 B"],
    [bytes(1_500), "1.5 kB"],
    [bytes(25_000_000), "25 MB"],
    [sentence("boxes at the same place in 2 of 2 frames"), "Boxes at the same place in 2 of 2 frames."],
    [sentence("Is said already."), "Is said already."],
    [sentence(" "), ""],
  ])("%s", (said, expected) => {
    expect(said).toBe(expected);
  });
});
