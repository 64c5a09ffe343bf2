import { describe, expect, it } from "vitest";
import { pictureWidth } from "./pictureWidth";

describe("pictureWidth", () => {
  it.each([
    ["the next step above the tile", 700, 1936, 720],
    ["a step that is nearly enough", 1000, 1936, 960],
    ["the original where no step is large enough", 3000, 3840, undefined],
    ["the original where the step is no smaller", 600, 720, undefined],
    ["the original where the step is not much smaller", 480, 640, undefined],
    ["the step where the original is half as wide again", 480, 720, 480],
  ])("asks for %s", (_, tile, original, width) => {
    expect(pictureWidth(tile, original)).toBe(width);
  });
});
