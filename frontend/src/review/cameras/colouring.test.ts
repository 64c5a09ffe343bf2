import { describe, expect, it } from "vitest";
import type { Observation } from "../../api/types";
import { filterOf, sane, UNCHANGED } from "./appearance";
import {
  classColour,
  colourOf,
  NO_SCORE_COLOUR,
  PROVENANCES,
  provenanceOf,
  SCORE_STEPS,
  scoreColour,
} from "./colouring";
import { identityColour } from "./palette";

const donor = { observation_id: 1, camera: "front", frame_index: 3, score: 0.9 };
const make = (source: string, from: typeof donor | null, camera = "front") =>
  ({ identity_id: 7, camera, label: { class_name: "car", score: 0.6, source, donor: from } }) as Observation;

describe("colourOf", () => {
  it("is that of the identity, the class, the score or the label's origin", () => {
    const one = make("propagated", donor, "left");
    expect(colourOf(one, "identity")).toBe(identityColour(7));
    expect(colourOf(one, "class")).toBe(classColour("car"));
    expect(colourOf(one, "score")).toBe(SCORE_STEPS[2]?.colour);
    expect(colourOf(one, "provenance")).toBe(PROVENANCES.otherCamera);
  });

  it.each([
    [0, 0],
    [0.299, 0],
    [0.3, 1],
    [0.85, 4],
    [1, 4],
  ])("score %d is step %d", (score, step) => {
    expect(scoreColour(score)).toBe(SCORE_STEPS[step]?.colour);
  });

  it("has a colour of its own for no score", () => {
    expect(scoreColour(null)).toBe(NO_SCORE_COLOUR);
  });

  it.each([
    ["auto", null, "front", "own"],
    ["propagated", donor, "front", "sameCamera"],
    ["propagated", donor, "left", "otherCamera"],
    ["human", donor, "left", "human"],
  ] as const)("%s, from %o, in %s is %s", (source, from, camera, provenance) => {
    expect(provenanceOf(make(source, from, camera))).toBe(provenance);
  });

  it("tells the common classes apart", () => {
    const names = ["car", "person", "bicycle", "truck", "motorcycle", "bus"];
    expect(new Set(names.map(classColour)).size).toBe(names.length);
  });
});

describe("appearance", () => {
  it("is read back, but for what makes no sense", () => {
    const adjustments = { brightness: 1.5, contrast: 1, gamma: 0.5 };
    expect(sane({ colouring: "class", adjustments })).toEqual({ colouring: "class", adjustments });
    expect(sane({ colouring: "mood", adjustments: { brightness: 99, gamma: "much" } })).toEqual({
      adjustments: UNCHANGED,
    });
    expect(sane(null)).toEqual({ adjustments: UNCHANGED });
  });

  it("filters only where something is changed", () => {
    expect(filterOf(UNCHANGED)).toBeUndefined();
    expect(filterOf({ brightness: 1.5, contrast: 1, gamma: 2 })).toBe("url(#picture-gamma) brightness(1.5)");
  });
});
