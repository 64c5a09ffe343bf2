import { describe, expect, it } from "vitest";
import { typedNumber } from "./typedNumber";

describe("typedNumber", () => {
  it.each<[string | number, number | null]>([
    [0.5, 0.5],
    ["0.50", 0.5],
    ["0.", 0],
    ["", null],
    [" ", null],
    ["-", null],
  ])("of %o is %s", (typed, number) => {
    expect(typedNumber(typed)).toBe(number);
  });
});
