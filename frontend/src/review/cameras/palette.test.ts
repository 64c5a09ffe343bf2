import { describe, expect, it } from "vitest";
import { identityColour, PALETTE } from "./palette";

/** Relative luminance (WCAG 2.2, https://www.w3.org/TR/WCAG22/#dfn-relative-luminance). */
function luminance(hex: string): number {
  const [r, g, b] = [1, 3, 5].map((at) => {
    const part = Number.parseInt(hex.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  }) as [number, number, number];
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

describe("identityColour", () => {
  it("takes every colour once in twelve ids", () => {
    const colours = Array.from({ length: PALETTE.length }, (_, id) => identityColour(id));
    expect(new Set(colours).size).toBe(PALETTE.length);
  });

  it("tells neighbouring ids, and ids a round apart, from each other", () => {
    for (let id = 0; id < 500; id += 1) {
      expect(identityColour(id)).not.toBe(identityColour(id + 1));
      expect(identityColour(id)).not.toBe(identityColour(id + PALETTE.length));
    }
  });

  it("is readable as a chip with dark words: contrast of at least 4.5", () => {
    const words = luminance("#0b0d11");
    for (const colour of PALETTE) expect((luminance(colour) + 0.05) / (words + 0.05)).toBeGreaterThan(4.5);
  });
});
