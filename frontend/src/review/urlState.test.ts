import { describe, expect, it } from "vitest";
import { NO_FILTER } from "./identities/filter";
import { readUrl, type UrlState, writeUrl } from "./urlState";

const fresh: UrlState = {
  view: "cameras",
  frame: 0,
  identityIds: [],
  tab: "merges",
  mergeId: null,
  filter: NO_FILTER,
  sort: "frames",
};

describe("the page's address", () => {
  it.each<[string, UrlState]>([
    ["", fresh],
    ["?frame=12", { ...fresh, frame: 12 }],
    ["?frame=12&identity=7", { ...fresh, frame: 12, identityIds: [7] }],
    ["?identity=7,9&merge=3", { ...fresh, identityIds: [7, 9], mergeId: 3 }],
    ["?view=queue&merge=3", { ...fresh, view: "queue", mergeId: 3 }],
    [
      "?tab=identities&find=className:car,minScore:0.5&sort=length",
      {
        ...fresh,
        tab: "identities",
        filter: { ...NO_FILTER, className: "car", minScore: 0.5 },
        sort: "length",
      },
    ],
    ["?find=text:50%2525", { ...fresh, filter: { ...NO_FILTER, text: "50%" } }],
    ["?identity=0&tab=selected", { ...fresh, identityIds: [0], tab: "selected" }],
  ])("%s is read and written as it was", (search, state) => {
    expect(readUrl(search)).toEqual(state);
    expect(writeUrl(state)).toBe(search);
  });

  it.each([
    ["?frame=-1", fresh],
    ["?frame=1e3&merge=x", fresh],
    ["?frame=99999999999999999999", fresh],
    ["?identity=,x,4,4", { ...fresh, identityIds: [4] }],
    ["?tab=secret", fresh],
    ["?view=attic", fresh],
    ["?find=nonsense&sort=by-magic", fresh],
  ])("%s: what makes no sense is left out", (search, state) => {
    expect(readUrl(search)).toEqual(state);
  });
});
