/**
 * The observations of a drive by frame, fetched in blocks of frames and kept for as long as their revision holds.
 *
 * The frame that a person waits for, or of which only a crop is wanted, may be fetched alone: it is there many times
 * sooner than its block.
 *
 * Labels have a revision. What this page changes itself is patched into what is known when that is asked for, and
 * nothing need be loaded again. What is of an older revision is still served (it shows the right boxes of the right
 * frame, with labels of a moment ago) until the newest is here.
 */

import type { Observation } from "../../api/types";
import { LeastRecentlyUsed } from "./lru";

export const BLOCK_FRAMES = 20;
const BLOCKS_KEPT = 40;
const ALONE_KEPT = 400;
const CHANGES_KEPT = 100;

export interface FrameObservations {
  frame_index: number;
  observations: Observation[];
}

export interface ObservationPage {
  revision: number;
  frames: FrameObservations[];
}

/** What this page changed: all observations of some tracks, which may have lost or got some, or be no more. */
export interface ObservationChange {
  trackIds: readonly number[];
  frames: readonly FrameObservations[];
}

export type LoadObservations = (start: number, stop: number) => Promise<ObservationPage>;

interface ByFrame {
  trackIds: ReadonlySet<number>;
  frames: ReadonlyMap<number, readonly Observation[]>;
}

interface Block {
  revision: number;
  frames: Map<number, Observation[]>;
}

export class ObservationStore {
  private readonly blocks = new LeastRecentlyUsed<number, Block>(BLOCKS_KEPT);
  /** Frames that were fetched alone, until their block is here. */
  private readonly alone = new LeastRecentlyUsed<number, Block>(ALONE_KEPT);
  private readonly inFlight = new Map<string, Promise<void>>();
  private readonly listeners = new Set<() => void>();
  private revision = 0;
  private version = 0;
  private readonly own = new Set<number>();
  /** What this page changed, by the revision that came of it. */
  private readonly changes = new LeastRecentlyUsed<number, ByFrame>(CHANGES_KEPT);

  constructor(
    private readonly load: LoadObservations,
    private readonly frameCount: number,
    /** Called when the server's labels are newer than what was known: someone else decided, or a job ended. */
    private readonly onNewRevision: (revision: number) => void = () => undefined,
  ) {}

  /** What is known of a frame now, maybe of an older revision; undefined if it must be loaded. */
  get(frame: number): Observation[] | undefined {
    return this.holder(frame)?.frames.get(frame);
  }

  /** The revision of what is known of a frame; null where nothing is. */
  revisionOf(frame: number): number | null {
    return this.holder(frame)?.revision ?? null;
  }

  /** Whether the frame's whole block is here and of the latest revision. */
  isFresh(frame: number): boolean {
    return (this.upToDate(this.blocks.get(blockOf(frame)))?.revision ?? -1) >= this.revision;
  }

  /** Resolves once the frame's own observations are known and of the latest revision; its block comes later. */
  async ensureAlone(frame: number): Promise<Observation[]> {
    while ((this.revisionOf(frame) ?? -1) < this.revision) {
      await this.fetch(frame, frame + 1, (page) => {
        if (!this.isFresh(frame)) this.alone.set(frame, page);
      });
    }
    return this.get(frame) ?? [];
  }

  /** Resolves once the frame's observations are known and of the latest revision, and those of its block. */
  async ensure(frame: number): Promise<Observation[]> {
    const block = blockOf(frame);
    const start = block * BLOCK_FRAMES;
    while (!this.isFresh(frame)) {
      await this.fetch(start, Math.min(start + BLOCK_FRAMES, this.frameCount), (page) => this.keepBlock(block, page));
    }
    return this.get(frame) ?? [];
  }

  /** The latest revision of the labels that is known. */
  knownRevision(): number {
    return this.revision;
  }

  /** A change that this page made itself; where it is not said what it was, everything is loaded anew. */
  changedHere(revision: number, change?: ObservationChange): void {
    this.own.add(revision);
    if (change) {
      const frames = new Map(change.frames.map((one) => [one.frame_index, one.observations] as const));
      this.changes.set(revision, { trackIds: new Set(change.trackIds), frames });
    }
    this.revision = Math.max(this.revision, revision);
    this.notify();
  }

  wasChangedHere(revision: number): boolean {
    return this.own.has(revision);
  }

  isOlderThan(revision: number): boolean {
    return this.revision < revision;
  }

  /** The labels changed: load anew what is asked for from now on. */
  invalidate(revision: number): void {
    this.revision = Math.max(this.revision, revision);
    this.notify();
  }

  /** Grows whenever labels changed, and what was read before may be old. */
  currentVersion = (): number => this.version;

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  private notify(): void {
    this.version += 1;
    for (const listener of this.listeners) listener();
  }

  /** Where the newest of what is known of a frame is; the block where both are as new. */
  private holder(frame: number): Block | undefined {
    const block = this.upToDate(this.blocks.get(blockOf(frame)));
    const single = this.upToDate(this.alone.get(frame));
    return single && single.revision > (block?.revision ?? -1) ? single : block;
  }

  private keepBlock(index: number, block: Block): void {
    const known = this.upToDate(this.blocks.get(index));
    if (known && known.revision > block.revision) return;
    for (const frame of block.frames.keys()) {
      // What is on the screen already stays the same object: nothing is painted twice.
      const single = this.upToDate(this.alone.get(frame));
      if (single?.revision === block.revision) block.frames.set(frame, single.frames.get(frame) as Observation[]);
      this.alone.delete(frame);
    }
    this.blocks.set(index, block);
  }

  private fetch(start: number, stop: number, keep: (page: Block) => void): Promise<void> {
    const known = this.revision;
    const key = `${start}/${stop}/${known}`;
    const running = this.inFlight.get(key);
    if (running) return running;
    const promise = this.load(start, stop)
      .then((page) => {
        const frames = new Map<number, Observation[]>();
        for (let frame = start; frame < stop; frame += 1) frames.set(frame, []);
        for (const one of page.frames) frames.set(one.frame_index, one.observations);
        // The server can't know less than it had told before this was asked.
        const block = { revision: Math.max(page.revision, known), frames };
        keep(this.upToDate(block));
        this.hear(page.revision);
      })
      .finally(() => this.inFlight.delete(key));
    this.inFlight.set(key, promise);
    return promise;
  }

  /** Patches into a block what this page changed since, up to the first change that it does not know. */
  private upToDate<B extends Block | undefined>(block: B): B {
    while (block && block.revision < this.revision) {
      const change = this.changes.get(block.revision + 1);
      if (!change) break;
      for (const [frame, before] of block.frames) block.frames.set(frame, patched(before, change, frame));
      block.revision += 1;
    }
    return block;
  }

  private hear(revision: number): void {
    if (revision <= this.revision) return;
    this.revision = revision;
    this.onNewRevision(revision);
  }
}

function blockOf(frame: number): number {
  return Math.floor(frame / BLOCK_FRAMES);
}

/** The observations of a frame after a change, in order of track as the server gives them; the same where none changed. */
function patched(before: Observation[], { trackIds, frames }: ByFrame, frame: number): Observation[] {
  const now = frames.get(frame) ?? [];
  if (now.length === 0 && !before.some((one) => trackIds.has(one.track_id))) return before;
  return [...before.filter((one) => !trackIds.has(one.track_id)), ...now].sort((a, b) => a.track_id - b.track_id);
}
