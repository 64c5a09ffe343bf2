/**
 * The observations of a drive by frame, fetched in blocks of frames and kept for as long as their revision holds.
 *
 * The frame that a person waits for may be fetched alone, ahead of its block: it is there many times sooner.
 *
 * After a decision the labels change: `invalidate` marks all blocks as old. Old blocks are still served (they show the
 * right boxes of the right frame, with labels of a moment ago) until the new ones are here.
 */

import type { Observation } from "../../api/types";
import { LeastRecentlyUsed } from "./lru";

export const BLOCK_FRAMES = 20;
const BLOCKS_KEPT = 40;

export interface ObservationPage {
  revision: number;
  frames: { frame_index: number; observations: Observation[] }[];
}

export type LoadObservations = (start: number, stop: number) => Promise<ObservationPage>;

interface Block {
  generation: number;
  frames: Map<number, Observation[]>;
}

export class ObservationStore {
  private readonly blocks = new LeastRecentlyUsed<number, Block>(BLOCKS_KEPT);
  /** Frames that were fetched alone, until their block is here. */
  private readonly alone = new Map<number, { generation: number; observations: Observation[] }>();
  private readonly inFlight = new Map<string, Promise<void>>();
  private readonly listeners = new Set<() => void>();
  private generation = 0;
  private revision: number | null = null;
  private own = new Set<number>();

  constructor(
    private readonly load: LoadObservations,
    private readonly frameCount: number,
    /** Called when the server's labels are newer than what was known: someone else decided, or a job ended. */
    private readonly onNewRevision: (revision: number) => void = () => undefined,
  ) {}

  /** What is known of a frame now, maybe of an older revision; undefined if it must be loaded. */
  get(frame: number): Observation[] | undefined {
    const block = this.blocks.get(blockOf(frame));
    const single = this.alone.get(frame);
    if (single && single.generation > (block?.generation ?? -1)) return single.observations;
    return block?.frames.get(frame);
  }

  isFresh(frame: number): boolean {
    return this.blocks.get(blockOf(frame))?.generation === this.generation;
  }

  /** Resolves once the frame's own observations are known and of the latest revision; its block comes later. */
  async ensureAlone(frame: number): Promise<Observation[]> {
    while (!this.isFresh(frame) && this.alone.get(frame)?.generation !== this.generation) {
      const generation = this.generation;
      const page = await this.load(frame, frame + 1);
      this.hear(page.revision);
      const observations = page.frames.find((one) => one.frame_index === frame)?.observations ?? [];
      // An answer that was overtaken by another change is of no use any more.
      if (generation === this.generation) this.alone.set(frame, { generation, observations });
    }
    return this.get(frame) ?? [];
  }

  /** Resolves once the frame's observations are known and of the latest revision. */
  async ensure(frame: number): Promise<Observation[]> {
    while (!this.isFresh(frame)) await this.fetchBlock(blockOf(frame));
    return this.get(frame) ?? [];
  }

  /** The revision of the labels that is known; null before the first. */
  knownRevision(): number | null {
    return this.revision;
  }

  /** A change that this page made itself. */
  changedHere(revision: number): void {
    this.own.add(revision);
    this.invalidate(revision);
  }

  wasChangedHere(revision: number): boolean {
    return this.own.has(revision);
  }

  isOlderThan(revision: number): boolean {
    return this.revision !== null && this.revision < revision;
  }

  /** The labels changed: load anew what is asked for from now on. */
  invalidate(revision: number): void {
    this.revision = revision;
    this.generation += 1;
    for (const listener of this.listeners) listener();
  }

  /** Grows whenever labels changed, and what was read before is old. */
  currentGeneration = (): number => this.generation;

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  private fetchBlock(block: number): Promise<void> {
    const generation = this.generation;
    const key = `${block}/${generation}`;
    const running = this.inFlight.get(key);
    if (running) return running;
    const start = block * BLOCK_FRAMES;
    const stop = Math.min(start + BLOCK_FRAMES, this.frameCount);
    const promise = this.load(start, stop)
      .then((page) => {
        const known = this.blocks.get(block);
        if (known && known.generation > generation) return;
        const frames = new Map<number, Observation[]>();
        for (let frame = start; frame < stop; frame += 1) frames.set(frame, []);
        for (const one of page.frames) {
          // What is on the screen already stays the same object: nothing is painted twice.
          const single = this.alone.get(one.frame_index);
          frames.set(one.frame_index, single?.generation === generation ? single.observations : one.observations);
        }
        this.blocks.set(block, { generation, frames });
        for (const frame of frames.keys()) this.alone.delete(frame);
        this.hear(page.revision);
      })
      .finally(() => this.inFlight.delete(key));
    this.inFlight.set(key, promise);
    return promise;
  }

  private hear(revision: number): void {
    const newer = this.revision !== null && revision > this.revision;
    this.revision = Math.max(this.revision ?? revision, revision);
    if (newer) this.onNewRevision(revision);
  }
}

function blockOf(frame: number): number {
  return Math.floor(frame / BLOCK_FRAMES);
}
