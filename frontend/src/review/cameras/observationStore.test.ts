import { describe, expect, it } from "vitest";
import type { Observation } from "../../api/types";
import { type ObservationPage, ObservationStore } from "./observationStore";

/** Answers with empty frames of a revision that the test sets. */
function serve(frameCount: number) {
  const asked: string[] = [];
  const newer: number[] = [];
  const server = { revision: 1 };
  const store = new ObservationStore(
    async (start, stop): Promise<ObservationPage> => {
      asked.push(`${start}-${stop}`);
      return { revision: server.revision, frames: [{ frame_index: start, observations: [] }] };
    },
    frameCount,
    (revision) => newer.push(revision),
  );
  return { store, asked, newer, server };
}

describe("ObservationStore", () => {
  it("fetches a block once for all of its frames, and stops at the end of the drive", async () => {
    const { store, asked } = serve(50);
    await Promise.all([store.ensure(40), store.ensure(49)]);
    await store.ensure(41);
    expect(asked).toEqual(["40-50"]);
    expect(store.get(49)).toEqual([]);
    expect(store.get(39)).toBeUndefined();
  });

  it("serves old labels until new ones are here", async () => {
    const { store, asked } = serve(20);
    const before = await store.ensure(0);
    store.invalidate(2);
    expect(store.isFresh(0)).toBe(false);
    expect(store.get(0)).toBe(before);
    const after = await store.ensure(0);
    expect(after).not.toBe(before);
    expect(asked).toHaveLength(2);
  });

  it("loads again where the labels changed while they were on their way", async () => {
    const { store, asked } = serve(20);
    const ensured = store.ensure(0);
    store.invalidate(2);
    await ensured;
    expect(store.isFresh(0)).toBe(true);
    expect(asked).toHaveLength(2);
  });

  it("tells once when the server is ahead of what was known", async () => {
    const { store, newer, server } = serve(60);
    store.invalidate(1);
    await store.ensure(0);
    server.revision = 4;
    await store.ensure(20);
    await store.ensure(40);
    expect(newer).toEqual([4]);
    expect(store.isOlderThan(4)).toBe(false);
    expect(store.isOlderThan(5)).toBe(true);
  });

  it("gets one frame alone ahead of its block, and prefers the block once it is here", async () => {
    const { store, asked } = serve(60);
    await store.ensureAlone(25);
    expect(asked).toEqual(["25-26"]);
    expect(store.get(25)).toEqual([]);
    expect(store.isFresh(25)).toBe(false);
    await store.ensure(25);
    await store.ensureAlone(25);
    expect(asked).toEqual(["25-26", "20-40"]);
  });

  it("patches what this page changed into what it knows, and loads nothing again", async () => {
    const box = (id: number, track_id: number, identity_id: number) => ({ id, track_id, identity_id }) as Observation;
    const asked: number[] = [];
    const store = new ObservationStore(async (start) => {
      asked.push(start);
      const frame = (frame_index: number) => ({ frame_index, observations: [box(1, 3, 3), box(2, 5, 5)] });
      return { revision: 1, frames: [frame(start), frame(start + 1)] };
    }, 60);
    store.invalidate(1);
    const before = await store.ensureAlone(25);
    const untouched = await store.ensureAlone(40);
    await store.ensure(0);
    // Track 5 became one object with track 3, lost its box in frame 1, and got one in frame 2; track 4 is new.
    const frames = [
      { frame_index: 0, observations: [box(2, 5, 3)] },
      { frame_index: 2, observations: [box(9, 5, 3)] },
      { frame_index: 25, observations: [box(7, 4, 4), box(2, 5, 3)] },
    ];
    store.changedHere(2, { trackIds: [4, 5], frames });
    expect(store.get(0)).toEqual([box(1, 3, 3), box(2, 5, 3)]);
    expect(store.get(1)).toEqual([box(1, 3, 3)]);
    expect(store.get(2)).toEqual([box(9, 5, 3)]);
    expect(store.get(3)).toEqual([]);
    expect(store.get(25)).toEqual([box(1, 3, 3), box(7, 4, 4), box(2, 5, 3)]);
    expect(store.get(25)).not.toBe(before);
    expect(store.get(40)).not.toBe(untouched); // track 5 is gone from there
    expect(store.get(40)).toEqual([box(1, 3, 3)]);
    expect(store.isFresh(0)).toBe(true);
    expect(store.revisionOf(25)).toBe(2);

    const same = store.get(0);
    store.changedHere(3, { trackIds: [8], frames: [] });
    expect(store.get(0)).toBe(same); // nothing to paint anew
    await store.ensureAlone(25);
    expect(asked).toEqual([25, 40, 0]);
  });

  it("patches what was on its way while this page changed it", async () => {
    const { store, asked } = serve(60);
    store.invalidate(1);
    const ensured = store.ensure(0); // the server answers with revision 1
    store.changedHere(2, { trackIds: [], frames: [] });
    await ensured;
    expect(store.isFresh(0)).toBe(true);
    expect(asked).toHaveLength(1);
  });

  it("loads anew where somebody else changed something in between, or where nobody says what was changed", async () => {
    const { store, asked, server } = serve(60);
    store.invalidate(1);
    await store.ensure(0);
    server.revision = 3;
    store.changedHere(3, { trackIds: [], frames: [] }); // 2 was somebody else's
    expect(store.isFresh(0)).toBe(false);
    await store.ensure(0);
    server.revision = 4;
    store.changedHere(4);
    await store.ensure(0);
    expect(asked).toHaveLength(3);
  });

  it("shows a frame's new labels before those of its block", async () => {
    const { store } = serve(60);
    const before = await store.ensure(25);
    store.invalidate(2);
    const after = await store.ensureAlone(25);
    expect(after).not.toBe(before);
    expect(store.get(25)).toBe(after);
  });
});
