import { describe, expect, it } from "vitest";
import type { Identity, Merge, Track } from "../../api/types";
import { patchIdentities, patchMerges, patchTracks } from "./patchLists";

const identity = (id: number, track_ids: number[]) => ({ id, track_ids }) as Identity;
const track = (id: number, identity_id: number) => ({ id, identity_id }) as Track;
const merge = (id: number, track_a: number, track_b: number, score: number, state = "proposed") =>
  ({ id, track_a, track_b, score, state }) as Merge;

describe("what a decision changed", () => {
  it("takes out identities that are gone, and keeps the order where one is split off", () => {
    const joined = { identities: [identity(1, [1, 4])], gone_identity_ids: [4] };
    expect(patchIdentities([identity(1, [1]), identity(3, [3]), identity(4, [4])], joined)).toEqual([
      identity(1, [1, 4]),
      identity(3, [3]),
    ]);
    const split = { identities: [identity(1, [1]), identity(2, [2])], gone_identity_ids: [] };
    expect(patchIdentities([identity(1, [1, 2]), identity(3, [3])], split).map((one) => one.id)).toEqual([1, 2, 3]);
  });

  it("moves tracks, and leaves the others the same objects", () => {
    const before = [track(1, 1), track(3, 3), track(4, 4)];
    const after = patchTracks(before, { tracks: [track(1, 1), track(4, 1)], changed_track_ids: [4] });
    expect(after.map((one) => one.identity_id)).toEqual([1, 3, 1]);
    expect(after[0]).toBe(before[0]);
    expect(after[1]).toBe(before[1]);
  });

  it("takes out tracks that are no more, and puts new ones in their place", () => {
    const before = [track(1, 1), track(3, 3), track(9, 9)];
    const after = patchTracks(before, { tracks: [track(1, 1), track(5, 5)], changed_track_ids: [1, 3, 5] });
    expect(after.map((one) => one.id)).toEqual([1, 5, 9]);
  });

  it("replaces merges in their places, and takes out those of tracks that are no more", () => {
    const before = [merge(7, 1, 2, 0.9), merge(8, 1, 4, 0.8), merge(9, 5, 6, 0.7)];
    const change = {
      tracks: [track(1, 1), track(2, 1)],
      changed_track_ids: [2, 4],
      merges: [merge(7, 1, 2, 0.9, "x")],
    };
    const after = patchMerges(before, change);
    expect(after.map((one) => [one.id, one.state])).toEqual([
      [7, "x"],
      [9, "proposed"],
    ]);
    expect(after[1]).toBe(before[2]);
  });

  it("puts merges that are there again where their score belongs", () => {
    const change = { tracks: [track(4, 4)], changed_track_ids: [4], merges: [merge(8, 1, 4, 0.8)] };
    expect(patchMerges([merge(7, 1, 2, 0.9), merge(9, 5, 6, 0.7)], change).map((one) => one.id)).toEqual([7, 8, 9]);
  });

  it("leaves merges alone that other decisions are on their way about", () => {
    const shown = merge(7, 1, 2, 0.9, "accepted");
    const change = { tracks: [track(1, 1)], changed_track_ids: [], merges: [merge(7, 1, 2, 0.9)] };
    expect(patchMerges([shown], change, new Set([7]))).toEqual([shown]);
  });
});
