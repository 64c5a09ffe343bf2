import { beforeEach, describe, expect, it } from "vitest";
import type { Observation } from "../../api/types";
import { AHEAD, FrameStore, type Picture } from "./frameStore";
import { ObservationStore } from "./observationStore";

interface FakePicture extends Picture {
  name: string;
  closed: boolean;
}

/** Loads that finish when the test says so. */
class Loads<T> {
  readonly asked: string[] = [];
  private readonly open = new Map<string, { resolve: (value: T) => void; reject: (cause: unknown) => void }[]>();

  start(key: string): Promise<T> {
    this.asked.push(key);
    return new Promise((resolve, reject) => {
      this.open.set(key, [...(this.open.get(key) ?? []), { resolve, reject }]);
    });
  }

  async finish(key: string, value: T): Promise<void> {
    for (const one of this.take(key)) one.resolve(value);
    await settle();
  }

  async fail(key: string): Promise<void> {
    for (const one of this.take(key)) one.reject(new Error("no answer"));
    await settle();
  }

  get running(): string[] {
    return [...this.open.keys()];
  }

  private take(key: string) {
    const loads = this.open.get(key);
    if (!loads) throw new Error(`${key} is not loading; loading: ${this.running.join(" ")}`);
    this.open.delete(key);
    return loads;
  }
}

/** Lets everything that is resolved already run on. */
async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

const picture = (name: string, side = 1): FakePicture => {
  const made = { name, width: side, height: side, closed: false, close: () => undefined as undefined };
  return Object.assign(made, {
    close: () => {
      made.closed = true;
      return undefined;
    },
  });
};

const observation = (id: number, identityId: number): Observation => ({
  id,
  track_id: identityId,
  identity_id: identityId,
  camera: "left",
  box: [0, 0, 1, 1],
  class_name: "car",
  score: 0.5,
  filled: false,
  label: { class_name: "car", score: 0.5, source: "auto", donor: null },
});

const FRAMES = 100;
let pictures: Loads<FakePicture | null>;
let labels: Loads<number>;
let observations: ObservationStore;
let store: FrameStore<FakePicture>;
let shown: string[];

function make(memoryBytes?: number, cameras = ["left", "right"]) {
  pictures = new Loads();
  labels = new Loads();
  observations = new ObservationStore(async (start, stop) => {
    const revision = await labels.start(`${start}-${stop}`);
    // One observation per frame; its identity is the revision, so that a test sees which one is shown.
    const frames = Array.from({ length: stop - start }, (_, at) => ({
      frame_index: start + at,
      observations: [observation(start + at, revision)],
    }));
    return { revision, frames };
  }, FRAMES);
  store = new FrameStore<FakePicture>({
    cameras,
    frameCount: FRAMES,
    loadPicture: (frame, camera) => pictures.start(`${frame}${camera}`),
    observations,
    memoryBytes,
  });
  shown = [];
  store.subscribe(() => {
    const committed = store.committed();
    if (!committed) return;
    const names = [...committed.pictures.values()].map((one) => one.picture?.name ?? "none");
    shown.push(`${committed.frame}: ${names.join(" ")} boxes ${committed.observations.map((one) => one.id).join()}`);
  });
}

async function finishFrame(frame: number) {
  await pictures.finish(`${frame}left`, picture(`${frame}L`));
  await pictures.finish(`${frame}right`, picture(`${frame}R`));
}

async function finishAll(made: (key: string) => FakePicture) {
  for (let left = pictures.running; left.length > 0; left = pictures.running) {
    for (const key of left) await pictures.finish(key, made(key));
  }
}

describe("FrameStore", () => {
  beforeEach(() => make());

  it("commits a frame only when all its pictures and its observations are here", async () => {
    store.request(5);
    await pictures.finish("5left", picture("5L"));
    await labels.finish("0-20", 1);
    expect(shown).toEqual([]);
    await pictures.finish("5right", picture("5R"));
    expect(shown).toEqual(["5: 5L 5R boxes 5"]);
  });

  it("never shows pictures of one frame with boxes of another", async () => {
    store.request(19);
    store.request(20);
    await finishFrame(19);
    await finishFrame(20);
    await labels.finish("20-40", 1);
    await labels.finish("0-20", 1);
    expect(shown).toEqual(["20: 20L 20R boxes 20"]);
  });

  it("follows the hand: a frame of a moment ago is shown while the newest is not here yet", async () => {
    store.request(1);
    store.request(2);
    await labels.finish("0-20", 1);
    await finishFrame(1);
    expect(shown).toEqual(["1: 1L 1R boxes 1"]);
    await finishFrame(2);
    expect(shown.at(-1)).toBe("2: 2L 2R boxes 2");
    expect(shown).toHaveLength(2);
  });

  it("loads the nearest first, then ahead in the direction of travel, a few at once", async () => {
    store.request(50);
    expect(pictures.asked.slice(0, 5)).toEqual(["50left", "50right", "51left", "51right", "49left"]);
    expect(pictures.asked).toHaveLength(5);
    await finishFrame(50);
    expect(pictures.asked).toHaveLength(7);
    make();
    store.request(50);
    store.request(40);
    // What runs goes on; what waited for frame 50 gives way to the frames before 40.
    await finishFrame(50);
    expect(pictures.asked.slice(5)).toEqual(["40left", "40right"]);
    await pictures.finish("51left", picture("51L"));
    expect(pictures.asked.at(-1)).toBe("39left");
  });

  it("shows what it fetched ahead at once, and asks for nothing outside the drive", async () => {
    store.request(FRAMES - 2);
    await labels.finish("98-99", 1);
    await labels.finish("80-100", 1);
    await finishAll((key) => picture(key));
    const asked = pictures.asked.map((key) => Number.parseInt(key, 10));
    expect(Math.max(...asked)).toBe(FRAMES - 1);
    expect(store.isReady(FRAMES - 1)).toBe(true);
    store.request(FRAMES - 1);
    expect(store.committed()?.frame).toBe(FRAMES - 1);
  });

  it("fetches the observations of the block ahead before they are needed", () => {
    store.request(20 - AHEAD);
    expect(labels.asked).toEqual(["0-20", "20-40"]);
  });

  it("shows the frame that is jumped to with its own labels, ahead of those of its block", async () => {
    store.request(50);
    await finishFrame(50);
    expect(labels.asked).toEqual(["50-51"]);
    await labels.finish("50-51", 1);
    expect(shown).toEqual(["50: 50L 50R boxes 50"]);
    expect(labels.asked).toEqual(["50-51", "40-60"]);
  });

  it("asks for nothing but what is to be shown while a decision is on its way, and for the rest after it", async () => {
    store.request(5);
    store.hold();
    await labels.finish("0-20", 1);
    await finishFrame(5);
    const before = pictures.asked.length;
    store.request(50);
    await finishAll((key) => picture(key));
    expect(pictures.asked.slice(before)).toEqual(["50left", "50right"]);
    await labels.finish("50-51", 1);
    expect(shown.at(-1)).toBe("50: 50left 50right boxes 50");
    expect(labels.running).toEqual([]);
    store.release();
    expect(labels.running).toEqual(["40-60"]);
    expect(pictures.asked.slice(before + 2, before + 4)).toEqual(["51left", "51right"]);
  });

  it("tells when the decision has come back", async () => {
    const free: string[] = [];
    void store.whenFree().then(() => free.push("before"));
    store.hold();
    void store.whenFree().then(() => free.push("after"));
    await settle();
    expect(free).toEqual(["before"]);
    store.release();
    await settle();
    expect(free).toEqual(["before", "after"]);
  });

  it("fetches frames that it is told to expect before those around", async () => {
    store.request(5);
    await finishFrame(5);
    store.expect([80]);
    await finishAll((key) => picture(key));
    expect(pictures.asked.indexOf("80left")).toBeLessThan(pictures.asked.indexOf("8left"));
    expect(labels.asked).toContain("80-81");
  });

  it("shows what was changed here without asking for it", async () => {
    store.request(5);
    await labels.finish("0-20", 1);
    await finishFrame(5);
    const moved = { ...observation(5, 7), track_id: 1 }; // as the server names it
    observations.changedHere(2, {
      trackIds: [moved.track_id],
      frames: [{ frame_index: 5, observations: [moved] }],
    });
    store.refreshObservations();
    expect(store.committed()).toMatchObject({ revision: 2, observations: [{ id: 5, identity_id: 7 }] });
    expect(labels.asked).toEqual(["0-20"]);
  });

  it("shows a frame whose camera has no picture, and one whose picture failed, and tries that one again", async () => {
    store.request(3);
    await labels.finish("0-20", 1);
    await pictures.finish("3left", null);
    await pictures.fail("3right");
    expect(store.committed()?.pictures.get("left")).toEqual({ picture: null, missing: true });
    expect(store.committed()?.pictures.get("right")).toEqual({ picture: null, missing: false });
    store.request(3);
    await finishAll((key) => picture(key));
    expect(store.committed()?.pictures.get("right")).toMatchObject({ picture: { name: "3right" } });
    expect(pictures.asked.filter((key) => key === "3left")).toHaveLength(1);
  });

  it("shows pictures without boxes, and says so, where observations cannot be had", async () => {
    store.request(7);
    await finishFrame(7);
    await labels.fail("0-20");
    expect(store.committed()).toMatchObject({ frame: 7, observations: [], observationsFailed: true });
    store.request(7);
    await labels.finish("0-20", 1);
    expect(store.committed()).toMatchObject({ frame: 7, observationsFailed: false });
  });

  it("repaints the frame on the screen with new labels, and no frame twice without need", async () => {
    store.request(5);
    await labels.finish("0-20", 1);
    await finishFrame(5);
    observations.invalidate(2);
    store.refreshObservations();
    // The frame's own labels come first; those of its block bring nothing new to the screen.
    await labels.finish("5-6", 2);
    expect(store.committed()?.observations[0]?.identity_id).toBe(2);
    await labels.finish("0-20", 2);
    expect(shown).toHaveLength(2);
  });

  it("keeps the old pictures on the screen until those of the new size are here", async () => {
    store.request(5);
    await labels.finish("0-20", 1);
    await finishFrame(5);
    const before = store.committed()?.pictures.get("left")?.picture;
    await finishAll((key) => picture(key));
    store.resize();
    expect(store.committed()?.pictures.get("left")?.picture).toBe(before);
    await finishAll((key) => picture(`large ${key}`));
    expect(store.committed()?.pictures.get("left")?.picture?.name).toBe("large 5left");
  });

  it("closes pictures beyond its memory, never those on the screen", async () => {
    // Room for two pictures of 10 x 10 at 4 bytes a pixel.
    make(800, ["left"]);
    const made: FakePicture[] = [];
    store.request(0);
    await labels.finish("0-20", 1);
    await finishAll((key) => {
      const one = picture(key, 10);
      made.push(one);
      return one;
    });
    const open = made.filter((one) => !one.closed).map((one) => one.name);
    expect(open).toEqual(["0left", `${AHEAD}left`]);
    store.close();
    expect(made.every((one) => one.closed)).toBe(true);
  });
});
