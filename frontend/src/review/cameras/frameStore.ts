/**
 * Shows one frame at a time, whole: the pictures of all cameras and their boxes are committed together or not at all,
 * so a box never stands on a picture of another frame.
 *
 * `request` names the frame that should be shown. A frame commits when everything of it is here. While a person scrubs,
 * frames that arrive late still commit as long as nothing requested later has: the pictures follow the hand. Around the
 * requested frame, others are fetched ahead, in the direction of travel. At most `CONCURRENT` pictures load at once,
 * nearest first, and what is no longer near is dropped from the queue.
 *
 * While a decision is on its way to the server (`hold`), only what is to be shown now is asked for.
 */

import type { Observation } from "../../api/types";
import { LeastRecentlyUsed } from "./lru";
import { BLOCK_FRAMES, type ObservationStore } from "./observationStore";

export const AHEAD = 10;
const BEHIND = 3;
const CONCURRENT = 5;
const WAITING_REQUESTS = 3;

/** What the store needs of a decoded picture; an `ImageBitmap` is one. */
export interface Picture {
  width: number;
  height: number;
  close: () => void;
}

export type CameraPicture<P extends Picture> = { picture: P } | { picture: null; missing: boolean };

export interface CommittedFrame<P extends Picture> {
  frame: number;
  pictures: ReadonlyMap<string, CameraPicture<P>>;
  observations: readonly Observation[];
  /** Of the labels. */
  revision: number | null;
  /** True where the observations could not be loaded: the pictures are shown without boxes, and it is said. */
  observationsFailed: boolean;
}

/** Resolves to null where the drive has no picture of this camera in this frame. */
export type LoadPicture<P extends Picture> = (frame: number, camera: string) => Promise<P | null>;

export interface FrameStoreOptions<P extends Picture> {
  cameras: readonly string[];
  frameCount: number;
  loadPicture: LoadPicture<P>;
  observations: ObservationStore;
  /** Pictures kept, in bytes of decoded pixels. */
  memoryBytes?: number;
}

type Key = string;

export class FrameStore<P extends Picture> {
  private committedFrame: CommittedFrame<P> | null = null;
  private committedOrder = 0;
  private order = 0;
  private target = 0;
  private direction: 1 | -1 = 1;
  private waiting: { order: number; frame: number }[] = [];
  private queue: { frame: number; camera: string }[] = [];
  private readonly loading = new Set<Key>();
  private readonly failed = new Map<Key, { missing: boolean }>();
  private readonly failedObservations = new Set<number>();
  /** Pictures on the screen: they must stay open until others take their place. */
  private shownKeys: ReadonlySet<Key> = new Set();
  /** Grows when pictures are wanted in another size; keys carry it. */
  private size = 0;
  private readonly pictures: LeastRecentlyUsed<Key, P>;
  private readonly listeners = new Set<() => void>();
  private closed = false;
  /** Frames that are likely to be asked for next, out of the direction of travel. */
  private expected: readonly number[] = [];
  private holds = 0;
  private readonly held: (() => void)[] = [];
  private begins = false;

  constructor(private readonly options: FrameStoreOptions<P>) {
    this.pictures = new LeastRecentlyUsed<Key, P>(
      options.memoryBytes ?? 400e6,
      (picture) => picture.close(),
      (key) => this.shownKeys.has(key),
    );
  }

  committed = (): CommittedFrame<P> | null => this.committedFrame;

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  /** Show this frame as soon as all of it is here. */
  request(frame: number): void {
    this.goTo(frame, Math.abs(frame - this.target) > BLOCK_FRAMES);
  }

  /** Show the first frame; nothing else is asked for until it is shown. */
  begin(frame: number): void {
    this.hold();
    this.begins = true;
    this.goTo(frame, true);
  }

  private goTo(frame: number, jumps: boolean): void {
    if (this.closed) return;
    this.direction = frame < this.target ? -1 : 1;
    this.target = frame;
    this.order += 1;
    this.failedObservations.delete(frame);
    for (const camera of this.options.cameras) {
      if (this.failed.get(this.keyOf(frame, camera))?.missing === false) this.failed.delete(this.keyOf(frame, camera));
    }
    this.waiting = [...this.waiting, { order: this.order, frame }].slice(-WAITING_REQUESTS);
    this.plan();
    this.loadObservations(frame, jumps || this.holds > 0);
    this.commitReady();
    if (!jumps) this.loadBlockAhead();
  }

  /** The labels changed: show the same pictures with the new ones, as soon as they are here. */
  refreshObservations(): void {
    if (!this.committedFrame) return;
    this.replaceObservations(this.committedFrame.frame);
    this.loadObservations(this.committedFrame.frame, true);
  }

  /** Fetch these frames too, before those around the one on the screen. */
  expect(frames: readonly number[]): void {
    this.expected = frames;
    if (this.order === 0) return;
    this.plan();
    if (this.holds === 0) this.loadExpected();
  }

  /** Ask for nothing ahead until `release`: the server has something to do that a person waits for. */
  hold(): void {
    this.holds += 1;
  }

  release(): void {
    this.holds = Math.max(0, this.holds - 1);
    if (this.holds > 0) return;
    for (const go of this.held.splice(0)) go();
    if (this.closed || this.order === 0) return;
    this.pump();
    this.loadObservations(this.target);
    this.loadExpected();
  }

  /** Resolves when nothing is held; at once where nothing is. */
  whenFree = (): Promise<void> => (this.holds === 0 ? Promise.resolve() : new Promise((go) => this.held.push(go)));

  /** Pictures are wanted in another size from now on: load the frame on the screen anew; it stays until then. */
  resize(): void {
    this.size += 1;
    this.failed.clear();
    if (this.order > 0) this.request(this.target);
  }

  /** True if the frame would commit at once. */
  isReady(frame: number): boolean {
    return (
      (this.options.observations.get(frame) !== undefined || this.failedObservations.has(frame)) &&
      this.options.cameras.every((camera) => this.has(frame, camera))
    );
  }

  close(): void {
    this.closed = true;
    this.queue = [];
    this.committedFrame = null;
    this.pictures.clear();
    this.listeners.clear();
  }

  private has(frame: number, camera: string): boolean {
    const key = this.keyOf(frame, camera);
    return this.pictures.has(key) || this.failed.has(key);
  }

  private plan(): void {
    const wanted = [this.target, ...this.waiting.map((one) => one.frame).reverse(), ...this.expected];
    for (let step = 1; step <= AHEAD; step += 1) {
      wanted.push(this.target + this.direction * step);
      if (step <= BEHIND) wanted.push(this.target - this.direction * step);
    }
    this.queue = [];
    for (const frame of new Set(wanted)) {
      if (frame < 0 || frame >= this.options.frameCount) continue;
      for (const camera of this.options.cameras) {
        if (!this.has(frame, camera) && !this.loading.has(this.keyOf(frame, camera)))
          this.queue.push({ frame, camera });
      }
    }
    this.pump();
  }

  private pump(): void {
    while (this.loading.size < CONCURRENT) {
      const next = this.queue[0];
      if (!next || (this.holds > 0 && next.frame !== this.target)) return;
      this.queue.shift();
      const key = this.keyOf(next.frame, next.camera);
      this.loading.add(key);
      this.options
        .loadPicture(next.frame, next.camera)
        .then(
          (picture) => {
            if (this.closed) picture?.close();
            else if (picture) this.pictures.set(key, picture, picture.width * picture.height * 4);
            else this.failed.set(key, { missing: true });
          },
          () => {
            this.failed.set(key, { missing: false });
          },
        )
        .then(() => {
          this.loading.delete(key);
          if (this.closed) return;
          this.commitReady();
          this.pump();
        });
    }
  }

  private loadExpected(): void {
    // What can't be had is asked for again when it is to be shown.
    for (const frame of this.expected) void this.options.observations.ensureAlone(frame).catch(() => undefined);
  }

  private loadBlockAhead(): void {
    const ahead = this.target + this.direction * AHEAD;
    if (this.holds === 0 && ahead >= 0 && ahead < this.options.frameCount) this.loadObservations(ahead);
  }

  /** Loads them by the block; `alone` gets the frame itself first, where a person waits for it. */
  private loadObservations(frame: number, alone = false): void {
    const { observations } = this.options;
    if (observations.isFresh(frame)) return;
    (alone ? observations.ensureAlone(frame) : observations.ensure(frame)).then(
      () => {
        // A frame that was left meanwhile needs no block, nor does one while the server is waited for.
        const stays = frame === this.target || frame === this.committedFrame?.frame;
        if (alone && stays && this.holds === 0 && !this.closed) this.loadObservations(frame);
        this.failedObservations.delete(frame);
        if (this.closed) return;
        this.commitReady();
        this.replaceObservations(frame);
      },
      () => {
        this.failedObservations.add(frame);
        if (!this.closed) this.commitReady();
      },
    );
  }

  /** Gives the frame on the screen its newest labels. */
  private replaceObservations(frame: number): void {
    const observations = this.options.observations.get(frame);
    const revision = this.options.observations.revisionOf(frame);
    if (!observations || this.committedFrame?.frame !== frame) return;
    if (this.committedFrame.observations === observations && this.committedFrame.revision === revision) return;
    this.commit({ ...this.committedFrame, observations, revision, observationsFailed: false });
  }

  /** Commits the newest request that is complete, and forgets the older ones. */
  private commitReady(): void {
    const ready = this.waiting.findLast((one) => one.order > this.committedOrder && this.isReady(one.frame));
    if (!ready) return;
    this.committedOrder = ready.order;
    this.waiting = this.waiting.filter((one) => one.order > ready.order);
    const pictures = new Map<string, CameraPicture<P>>();
    const keys = new Set<Key>();
    for (const camera of this.options.cameras) {
      const key = this.keyOf(ready.frame, camera);
      keys.add(key);
      const picture = this.pictures.get(key);
      pictures.set(camera, picture ? { picture } : { picture: null, missing: this.failed.get(key)?.missing ?? true });
    }
    this.shownKeys = keys;
    const observations = this.options.observations.get(ready.frame);
    this.commit({
      frame: ready.frame,
      pictures,
      observations: observations ?? [],
      revision: this.options.observations.revisionOf(ready.frame),
      observationsFailed: !observations,
    });
  }

  private commit(committed: CommittedFrame<P>): void {
    this.committedFrame = committed;
    for (const listener of this.listeners) listener();
    if (!this.begins) return;
    this.begins = false;
    this.release();
  }

  private keyOf(frame: number, camera: string): Key {
    return `${this.size}/${frame}/${camera}`;
  }
}
