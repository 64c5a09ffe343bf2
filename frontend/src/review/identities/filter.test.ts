import { describe, expect, it } from "vitest";
import type { Identity, IdentityFacts } from "../../api/types";
import { type IdentityFilter, matches, NO_FILTER, partsOf, readFilter, writeFilter } from "./filter";

const car = {
  id: 7,
  class_name: "car",
  score: 0.8,
  camera_names: ["front", "left"],
  first_frame: 10,
  last_frame: 19,
  propagated_count: 3,
} as Identity;
const facts: IdentityFacts = {
  identity_id: 7,
  nearest_m: 8,
  farthest_m: 40,
  purity: 0.8,
  failed: [{ check: "speed", value: 90, unit: "m/s", frame_index: 12 }],
};

describe("looking for identities", () => {
  it.each<[Partial<IdentityFilter>, boolean]>([
    [{}, true],
    [{ className: "car" }, true],
    [{ className: "truck" }, false],
    [{ camera: "left" }, true],
    [{ camera: "rear" }, false],
    [{ minScore: 0.8, maxScore: 0.8 }, true],
    [{ minScore: 0.81 }, false],
    [{ minLength: 10, maxLength: 10 }, true], // frames 10 to 19
    [{ minLength: 11 }, false],
    [{ minDistance: 30, maxDistance: 35 }, true], // it passes through from 8 to 40 m
    [{ minDistance: 41 }, false],
    [{ maxDistance: 7 }, false],
    [{ provenance: "propagated" }, true],
    [{ provenance: "own" }, false],
    [{ reviewed: "no" }, true],
    [{ reviewed: "yes" }, false],
    [{ fails: "speed" }, true],
    [{ fails: "any" }, true],
    [{ fails: "yaw" }, false],
    [{ maxPurity: 0.9 }, true], // four of five boxes are of it
    [{ minPurity: 0.9 }, false],
    [{ text: "CAR front" }, true],
    [{ text: "car rear" }, false],
    [{ text: "#7" }, true],
    [{ text: "7" }, true],
    [{ text: "77" }, false], // a number is a whole one
  ])("%o: %s", (part, found) => {
    expect(matches({ ...NO_FILTER, ...part }, car, facts)).toBe(found);
  });

  it("knows what was reviewed, and finds nothing by a purity that is not known", () => {
    expect(matches({ ...NO_FILTER, reviewed: "yes" }, { ...car, mark: "reviewed" as const }, facts)).toBe(true);
    for (const unknown of [undefined, { ...facts, purity: null }]) {
      expect(matches({ ...NO_FILTER, maxPurity: 1 }, car, unknown)).toBe(false);
    }
  });

  it("does not find by distance or checks what has no 3D box", () => {
    const unknown = { ...facts, nearest_m: null, farthest_m: null, failed: [] };
    for (const part of [{ minDistance: 0 }, { maxDistance: 500 }, { fails: "any" as const }]) {
      expect(matches({ ...NO_FILTER, ...part }, car, unknown)).toBe(false);
      expect(matches({ ...NO_FILTER, ...part }, car, undefined)).toBe(false);
    }
  });
});

describe("a filter in the address", () => {
  it.each<[string, Partial<IdentityFilter>]>([
    ["", {}],
    ["className:car,minScore:0.5", { className: "car", minScore: 0.5 }],
    ["text:a%2C%20b%3A", { text: "a, b:" }],
    ["reviewed:no,fails:twice", { reviewed: "no", fails: "twice" }],
  ])("%s is read and written as it was", (written, part) => {
    expect(readFilter(written)).toEqual({ ...NO_FILTER, ...part });
    expect(writeFilter(readFilter(written))).toBe(written);
    expect(partsOf(readFilter(written))).toBe(Object.keys(part).length);
  });

  it.each(["minScore:x", "fails:gravity", "what:ever", ":", "text:%E0%A4%A", "reviewed:maybe"])(
    "%s makes no sense and is left out",
    (written) => {
      expect(readFilter(written)).toEqual(NO_FILTER);
    },
  );
});
