/** What the colour of a box says: which identity, which class, how sure, or where its label comes from. */

import type { Observation } from "../../api/types";
import { identityColour, PALETTE } from "./palette";

export type Colouring = "identity" | "class" | "score" | "provenance";
export const COLOURINGS: readonly Colouring[] = ["identity", "class", "score", "provenance"];

/** Road users in a fixed order, so that a class has its colour in every drive; other classes share what is left. */
const ROAD_USERS = ["car", "person", "bicycle", "truck", "motorcycle", "bus", "pedestrian", "cyclist", "van", "train"];

export function classColour(name: string): string {
  const known = ROAD_USERS.indexOf(name);
  let hash = 0;
  for (const letter of name) hash = (hash * 31 + letter.charCodeAt(0)) % 997;
  return PALETTE[(known >= 0 ? known : ROAD_USERS.length + hash) % PALETTE.length] as string;
}

/** Scores in steps: the lower, the darker and the more violet. The order is that of lightness, for every eye. */
export const SCORE_STEPS: readonly { from: number; colour: string }[] = [
  { from: 0, colour: "#8f6bdc" },
  { from: 0.3, colour: "#5f93ea" },
  { from: 0.5, colour: "#35b8b1" },
  { from: 0.7, colour: "#83d653" },
  { from: 0.85, colour: "#fde725" },
];
export const NO_SCORE_COLOUR = "#8d93a1";

export function scoreColour(score: number | null): string {
  if (score === null) return NO_SCORE_COLOUR;
  return SCORE_STEPS.findLast((step) => score >= step.from)?.colour ?? NO_SCORE_COLOUR;
}

export type Provenance = "own" | "sameCamera" | "otherCamera" | "human";
export const PROVENANCES: Record<Provenance, string> = {
  own: "#2fd39a",
  sameCamera: "#56b4e9",
  otherCamera: "#ffb000",
  human: "#ffc2d1",
};

export function provenanceOf({ label, camera }: Pick<Observation, "label" | "camera">): Provenance {
  if (label.source === "human") return "human";
  if (label.source === "auto" || !label.donor) return "own";
  return label.donor.camera === camera ? "sameCamera" : "otherCamera";
}

export function colourOf(one: Observation, colouring: Colouring): string {
  if (colouring === "class") return classColour(one.label.class_name);
  if (colouring === "score") return scoreColour(one.label.score);
  if (colouring === "provenance") return PROVENANCES[provenanceOf(one)];
  return identityColour(one.identity_id);
}
