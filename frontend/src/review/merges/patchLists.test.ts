import { describe, expect, it } from "vitest";
import type { Identity, Track } from "../../api/types";
import { patchIdentities, patchTracks } from "./patchLists";

const identity = (id: number, track_ids: number[]) => ({ id, track_ids }) as Identity;
const track = (id: number, identity_id: number) => ({ id, identity_id }) as Track;

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
    const after = patchTracks(before, { identities: [identity(1, [1, 4])], gone_identity_ids: [4] });
    expect(after.map((one) => one.identity_id)).toEqual([1, 3, 1]);
    expect(after[0]).toBe(before[0]);
    expect(after[1]).toBe(before[1]);
  });
});
