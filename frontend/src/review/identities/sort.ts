import type { Identity } from "../../api/types";

export type IdentitySort = "frames" | "score" | "score_low" | "propagated" | "class";

const COMPARE: Record<IdentitySort, (a: Identity, b: Identity) => number> = {
  frames: (a, b) => b.observation_count - a.observation_count,
  score: (a, b) => b.score - a.score,
  score_low: (a, b) => a.score - b.score,
  propagated: (a, b) => b.propagated_count - a.propagated_count,
  class: (a, b) => a.class_name.localeCompare(b.class_name) || b.observation_count - a.observation_count,
};

/** Identities of a class (null: all) in order; equal ones by id, so that the order never jumps. */
export function sortIdentities(all: readonly Identity[], by: IdentitySort, className: string | null): Identity[] {
  const wanted = className === null ? [...all] : all.filter((one) => one.class_name === className);
  return wanted.sort((a, b) => COMPARE[by](a, b) || a.id - b.id);
}
