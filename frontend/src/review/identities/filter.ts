/** Which identities a person looks for. It lives in the address, and can be kept under a name. */

import type { Identity, IdentityFacts } from "../../api/types";

export type Provenance = "propagated" | "own";
export type CheckName = IdentityFacts["failed"][number]["check"];
export const CHECKS: readonly CheckName[] = ["speed", "size", "yaw", "twice"];

/** Every part narrows the search; what is empty or null does not. */
export interface IdentityFilter {
  text: string;
  className: string | null;
  camera: string | null;
  minScore: number | null;
  maxScore: number | null;
  minDistance: number | null;
  maxDistance: number | null;
  minLength: number | null;
  maxLength: number | null;
  provenance: Provenance | null;
  /** "yes": a person looked at it; "no": nobody did. */
  reviewed: "yes" | "no" | null;
  minPurity: number | null;
  maxPurity: number | null;
  /** "any" or one of the physics checks. */
  fails: CheckName | "any" | null;
}

export const NO_FILTER: IdentityFilter = {
  text: "",
  className: null,
  camera: null,
  minScore: null,
  maxScore: null,
  minDistance: null,
  maxDistance: null,
  minLength: null,
  maxLength: null,
  provenance: null,
  reviewed: null,
  minPurity: null,
  maxPurity: null,
  fails: null,
};

export function isReviewed(identity: Identity): boolean {
  return identity.mark === "reviewed" || identity.mark === "ignored";
}

/** How many frames an identity is there. */
export function lengthOf(identity: Identity): number {
  return identity.last_frame - identity.first_frame + 1;
}

/**
 * Whether an identity is looked for. What is not known (no 3D box, no purity) does not match where it is asked about.
 * Words of the text must each be found, in the number (#7), the class or a camera.
 */
export function matches(filter: IdentityFilter, identity: Identity, facts: IdentityFacts | undefined): boolean {
  const { fails } = filter;
  return (
    (filter.className === null || identity.class_name === filter.className) &&
    (filter.camera === null || identity.camera_names.includes(filter.camera)) &&
    within(identity.score, filter.minScore, filter.maxScore) &&
    within(lengthOf(identity), filter.minLength, filter.maxLength) &&
    // Somewhere on its way it must have been in the range.
    (filter.minDistance === null || (facts?.farthest_m ?? -1) >= filter.minDistance) &&
    (filter.maxDistance === null || (facts?.nearest_m ?? Number.POSITIVE_INFINITY) <= filter.maxDistance) &&
    (filter.provenance === null ||
      (filter.provenance === "propagated" ? identity.propagated_count > 0 : identity.propagated_count === 0)) &&
    (filter.reviewed === null || isReviewed(identity) === (filter.reviewed === "yes")) &&
    within(facts?.purity ?? null, filter.minPurity, filter.maxPurity) &&
    (fails === null || (facts?.failed.some((failed) => fails === "any" || failed.check === fails) ?? false)) &&
    hasWords(identity, filter.text)
  );
}

function within(value: number | null, least: number | null, most: number | null): boolean {
  if (least === null && most === null) return true;
  return value !== null && value >= (least ?? Number.NEGATIVE_INFINITY) && value <= (most ?? Number.POSITIVE_INFINITY);
}

function hasWords(identity: Identity, text: string): boolean {
  const words = text.trim().toLowerCase().split(/\s+/).filter(Boolean);
  const said = [`#${identity.id}`, identity.class_name, ...identity.camera_names].map((one) => one.toLowerCase());
  return words.every((word) =>
    /^#?\d+$/.test(word) ? said[0] === `#${word.replace("#", "")}` : said.some((one) => one.includes(word)),
  );
}

/** How many parts of the filter narrow the search. */
export function partsOf(filter: IdentityFilter): number {
  return Object.values(filter).filter((value) => value !== null && value !== "").length;
}

const NUMBERS = [
  "minScore",
  "maxScore",
  "minDistance",
  "maxDistance",
  "minLength",
  "maxLength",
  "minPurity",
  "maxPurity",
] as const satisfies readonly (keyof IdentityFilter)[];

/** The filter as one word for an address: `class:car,minScore:0.5`. Empty without a filter. */
export function writeFilter(filter: IdentityFilter): string {
  return Object.entries(filter)
    .filter(([, value]) => value !== null && value !== "")
    .map(([name, value]) => `${name}:${encodeURIComponent(String(value))}`)
    .join(",");
}

/** Reads what {@link writeFilter} wrote; whatever it cannot make sense of is as if it were not there. */
export function readFilter(written: string | null): IdentityFilter {
  const filter: IdentityFilter = { ...NO_FILTER };
  for (const part of (written ?? "").split(",")) {
    const colon = part.indexOf(":");
    const name = part.slice(0, colon);
    const value = decode(part.slice(colon + 1));
    if (colon < 0 || value === null || value === "") continue;
    if ((NUMBERS as readonly string[]).includes(name)) {
      const number = Number(value);
      if (Number.isFinite(number)) filter[name as (typeof NUMBERS)[number]] = number;
    } else if (name === "text" || name === "className" || name === "camera") filter[name] = value;
    else if (name === "provenance" && (value === "propagated" || value === "own")) filter.provenance = value;
    else if (name === "reviewed" && (value === "yes" || value === "no")) filter.reviewed = value;
    else if (name === "fails" && (value === "any" || (CHECKS as readonly string[]).includes(value))) {
      filter.fails = value as CheckName | "any";
    }
  }
  return filter;
}

function decode(value: string): string | null {
  try {
    return decodeURIComponent(value);
  } catch {
    return null;
  }
}
