/**
 * The clock of playback: which frame is due, by the drive's own times.
 *
 * It never runs ahead of the pictures: while a frame is asked for and not yet shown, it waits, and the time lost is
 * not caught up by skipping. So every frame is seen, at the drive's rate or slower.
 */

export class PlaybackClock {
  private frame = 0;
  private shownAt = 0;
  private waitingFor: number | null = null;

  constructor(
    private readonly frameTimesMs: readonly number[],
    private speed = 1,
  ) {}

  start(frame: number, nowMs: number): void {
    this.frame = frame;
    this.shownAt = nowMs;
    this.waitingFor = null;
  }

  setSpeed(speed: number): void {
    this.speed = speed;
  }

  /**
   * Called on every animation frame. `shown` is the frame on the screen. Returns the frame to ask for now, "end" after
   * the last one, or null if nothing is due.
   */
  tick(nowMs: number, shown: number | null): number | "end" | null {
    if (this.waitingFor !== null) {
      if (shown !== this.waitingFor) return null;
      const due = this.shownAt + this.interval(this.frame);
      // On time: count from when it was due, so that errors do not add up. Late: count from now.
      this.shownAt = nowMs - due < this.interval(this.frame) ? due : nowMs;
      this.frame = this.waitingFor;
      this.waitingFor = null;
    }
    if (this.frame >= this.frameTimesMs.length - 1) return "end";
    if (nowMs - this.shownAt < this.interval(this.frame)) return null;
    this.waitingFor = this.frame + 1;
    return this.waitingFor;
  }

  /** Milliseconds that a frame stays on the screen. */
  private interval(frame: number): number {
    const here = this.frameTimesMs[frame];
    const next = this.frameTimesMs[frame + 1];
    if (here === undefined || next === undefined) return 0;
    return Math.max(0, next - here) / this.speed;
  }
}
