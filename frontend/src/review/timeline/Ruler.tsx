import { type KeyboardEvent, type PointerEvent, useLayoutEffect, useRef } from "react";
import { clock } from "../../app/format";
import { text } from "../../strings";
import { useReview, useShared } from "../ReviewContext";
import classes from "./Lanes.module.css";
import type { Ink } from "./paint";
import { frameAt, type TimeView, tickSeconds, xOf } from "./timeView";

const PAGE = 10;
export const RULER_PX = 26;
const FONT = '11px "Inter Variable", system-ui, sans-serif';

interface RulerProps {
  view: TimeView;
  width: number;
  gutter: number;
  ink: Ink;
  onWheel: (event: React.WheelEvent) => void;
}

/** The time above the lanes. It carries the playhead, which can be dragged, or moved with keys. */
export function Ruler({ view, width, gutter, ink, onWheel }: RulerProps) {
  const { drive, store } = useShared();
  const frame = useReview((state) => state.frame);
  const canvas = useRef<HTMLCanvasElement>(null);
  const dragging = useRef(false);
  const across = Math.max(1, width - gutter);
  const count = drive.frame_count;

  useLayoutEffect(() => {
    const ctx = sized(canvas.current, across, RULER_PX);
    if (ctx) paintRuler(ctx, { view, across, ink, frame, timesMs: drive.frame_times_ms });
  }, [view, across, ink, frame, drive.frame_times_ms]);

  const seekTo = (event: PointerEvent<HTMLElement>) => {
    const x = event.clientX - event.currentTarget.getBoundingClientRect().left;
    store.getState().seek(frameAt(view, x, across, count));
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const to: Record<string, number> = {
      ArrowLeft: frame - 1,
      ArrowDown: frame - 1,
      ArrowRight: frame + 1,
      ArrowUp: frame + 1,
      PageDown: frame - PAGE,
      PageUp: frame + PAGE,
      Home: 0,
      End: count - 1,
    };
    const target = to[event.key];
    if (target === undefined || event.shiftKey || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    store.getState().setPlaying(false);
    store.getState().seek(target);
  };

  return (
    <div
      className={classes.ruler}
      style={{ marginLeft: gutter, height: RULER_PX }}
      role="slider"
      tabIndex={0}
      aria-label={text.timeline.label}
      aria-valuemin={1}
      aria-valuemax={count}
      aria-valuenow={frame + 1}
      aria-valuetext={`${text.review.frame(frame, count)}, ${clock(drive.frame_times_ms[frame] ?? 0)}`}
      onKeyDown={onKeyDown}
      onWheel={onWheel}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        dragging.current = true;
        store.getState().setPlaying(false);
        seekTo(event);
      }}
      onPointerMove={(event) => dragging.current && seekTo(event)}
      onPointerUp={() => {
        dragging.current = false;
      }}
      onPointerCancel={() => {
        dragging.current = false;
      }}
    >
      <canvas ref={canvas} className={classes.canvas} aria-hidden style={{ width: across, height: RULER_PX }} />
    </div>
  );
}

interface RulerScene {
  view: TimeView;
  across: number;
  ink: Ink;
  frame: number;
  timesMs: readonly number[];
}

function paintRuler(ctx: CanvasRenderingContext2D, { view, across, ink, frame, timesMs }: RulerScene): void {
  ctx.clearRect(0, 0, across, RULER_PX);
  const msAt = (at: number) => timesMs[Math.min(timesMs.length - 1, Math.max(0, Math.round(at)))] ?? 0;
  const [from, to] = [msAt(view.start), msAt(view.start + view.frames)];
  const stepMs = tickSeconds(Math.max(0.1, (to - from) / 1000), across) * 1000;
  ctx.font = FONT;
  ctx.textBaseline = "middle";
  let next = Math.ceil(from / stepMs) * stepMs;
  const last = Math.min(timesMs.length, Math.ceil(view.start + view.frames));
  for (let index = Math.max(0, Math.floor(view.start)); index < last; index += 1) {
    if ((timesMs[index] as number) < next - 0.5) continue;
    const x = xOf(view, index, across);
    ctx.fillStyle = ink.line;
    ctx.fillRect(x, 0, 1, RULER_PX);
    ctx.fillStyle = ink.muted;
    ctx.fillText(clock(next), x + 4, RULER_PX / 2);
    next += stepMs;
  }
  const x = (xOf(view, frame, across) + xOf(view, frame + 1, across)) / 2;
  ctx.fillStyle = ink.words;
  ctx.beginPath();
  ctx.roundRect(x - 5, RULER_PX - 11, 10, 8, [2, 2, 5, 5]);
  ctx.fill();
  ctx.fillRect(x - 1, RULER_PX - 6, 2, 6);
}

/** Sizes a canvas to the device's pixels and gives a context whose unit is the CSS pixel. */
export function sized(
  canvas: HTMLCanvasElement | null,
  width: number,
  height: number,
): CanvasRenderingContext2D | null {
  const ctx = canvas?.getContext("2d");
  if (!canvas || !ctx || width <= 0 || height <= 0) return null;
  const ratio = window.devicePixelRatio;
  const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) {
    canvas.width = wide;
    canvas.height = high;
  }
  ctx.setTransform(wide / width, 0, 0, high / height, 0, 0);
  return ctx;
}
