import { describe, expect, it } from "vitest";
import { LeastRecentlyUsed } from "./lru";

describe("LeastRecentlyUsed", () => {
  it("forgets what was not used for longest, by weight", () => {
    const evicted: string[] = [];
    const cache = new LeastRecentlyUsed<string, number>(10, (_, key) => evicted.push(key));
    cache.set("a", 1, 4);
    cache.set("b", 2, 4);
    cache.get("a");
    cache.set("c", 3, 4);
    expect(evicted).toEqual(["b"]);
    expect([cache.has("a"), cache.has("b"), cache.has("c")]).toEqual([true, false, true]);
  });

  it("keeps what is pinned and what was just set, even over the limit", () => {
    const cache = new LeastRecentlyUsed<string, number>(
      5,
      () => undefined,
      (key) => key === "shown",
    );
    cache.set("shown", 1, 5);
    cache.set("large", 2, 9);
    expect([cache.has("shown"), cache.has("large")]).toEqual([true, true]);
    cache.set("next", 3, 1);
    expect([cache.has("shown"), cache.has("large"), cache.has("next")]).toEqual([true, false, true]);
  });

  it("counts a value that replaces another once, and gives the old one up", () => {
    const evicted: number[] = [];
    const cache = new LeastRecentlyUsed<string, number>(10, (value) => evicted.push(value));
    cache.set("a", 1, 6);
    cache.set("a", 2, 6);
    cache.set("b", 3, 4);
    expect(evicted).toEqual([1]);
    expect(cache.get("a")).toBe(2);
  });
});
