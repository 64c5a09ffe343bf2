/** Which frames the timeline shows, and where they stand: zoom and pan along time. */

export interface TimeView {
  /** The frame at the left edge; a fraction while one pans. */
  readonly start: number;
  /** So many frames are shown. */
  readonly frames: number;
}

const FEWEST_FRAMES = 12;

export function wholeDrive(frameCount: number): TimeView {
  return { start: 0, frames: frameCount };
}

function inside({ start, frames }: TimeView, frameCount: number): TimeView {
  const shown = Math.min(frameCount, Math.max(Math.min(FEWEST_FRAMES, frameCount), frames));
  return { start: Math.max(0, Math.min(frameCount - shown, start)), frames: shown };
}

/** Shows `1 / factor` as many frames; what is at the part `at` of the width (0 to 1) stays there. */
export function zoomTime(view: TimeView, factor: number, at: number, frameCount: number): TimeView {
  const frames = inside({ start: 0, frames: view.frames / factor }, frameCount).frames;
  return inside({ start: view.start + at * (view.frames - frames), frames }, frameCount);
}

/** Moves by so many frames. */
export function panTime(view: TimeView, frames: number, frameCount: number): TimeView {
  return inside({ ...view, start: view.start + frames }, frameCount);
}

/** Moves as little as is needed to show a frame with some room around it; the same view where it is shown already. */
export function reveal(view: TimeView, frame: number, frameCount: number): TimeView {
  const room = Math.min(view.frames * 0.1, 20);
  if (frame < view.start) return inside({ ...view, start: frame - room }, frameCount);
  if (frame >= view.start + view.frames) return inside({ ...view, start: frame + 1 + room - view.frames }, frameCount);
  return view;
}

/** The left edge of a frame, px from the left of the view. */
export function xOf(view: TimeView, frame: number, width: number): number {
  return ((frame - view.start) / view.frames) * width;
}

/** The frame under a point of the view, within the drive. */
export function frameAt(view: TimeView, x: number, width: number, frameCount: number): number {
  return Math.max(0, Math.min(frameCount - 1, Math.floor(view.start + (x / width) * view.frames)));
}

/** Seconds between two marks of the ruler, so that they stand at least `apart` px from each other. */
export function tickSeconds(secondsShown: number, width: number, apart = 70): number {
  const least = (secondsShown * apart) / Math.max(1, width);
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1200, 1800, 3600];
  return steps.find((step) => step >= least) ?? Math.ceil(least / 3600) * 3600;
}
