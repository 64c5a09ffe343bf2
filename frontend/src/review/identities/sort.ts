import type { Identity, IdentityFacts } from "../../api/types";
import { lengthOf } from "./filter";

export const SORTS = [
  "frames",
  "score",
  "score_low",
  "propagated",
  "length",
  "near",
  "far",
  "failed",
  "purity_low",
  "class",
] as const;
export type IdentitySort = (typeof SORTS)[number];

export type FactsById = ReadonlyMap<number, IdentityFacts>;

/** What a sort goes by, the greatest first; what is not known comes last. */
const KEY: Record<
  Exclude<IdentitySort, "class">,
  (one: Identity, facts: IdentityFacts | undefined) => number | null
> = {
  frames: (one) => one.observation_count,
  score: (one) => one.score,
  score_low: (one) => (one.score === null ? null : -one.score),
  propagated: (one) => one.propagated_count,
  length: lengthOf,
  near: (_, facts) => (facts?.nearest_m == null ? null : -facts.nearest_m),
  far: (_, facts) => facts?.farthest_m ?? null,
  failed: (_, facts) => facts?.failed.length ?? null,
  purity_low: (_, facts) => (facts?.purity == null ? null : -facts.purity),
};

/** Identities in order; equal ones by id, so that the order never jumps. */
export function sortIdentities(all: readonly Identity[], by: IdentitySort, facts: FactsById): Identity[] {
  if (by === "class") {
    const compare = (a: Identity, b: Identity) =>
      a.class_name.localeCompare(b.class_name) || b.observation_count - a.observation_count || a.id - b.id;
    return [...all].sort(compare);
  }
  const key = new Map(all.map((one) => [one.id, KEY[by](one, facts.get(one.id)) ?? Number.NEGATIVE_INFINITY]));
  const keyOf = (one: Identity) => key.get(one.id) as number;
  return [...all].sort((a, b) => (keyOf(a) === keyOf(b) ? a.id - b.id : keyOf(b) > keyOf(a) ? 1 : -1));
}
