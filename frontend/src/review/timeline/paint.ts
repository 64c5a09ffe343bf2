/** Paints the lanes that are on the screen. The context's unit is the CSS px of the canvas. */

import { text } from "../../strings";
import { SCORE_STEPS } from "../cameras/colouring";
import { identityColour } from "../cameras/palette";
import {
  type Arrangement,
  FILLED,
  GROUP_PX,
  LANE_PAD_PX,
  type Lane,
  type Link,
  rowAt,
  rowHeight,
  type Segment,
} from "./lanes";
import { type TimeView, xOf } from "./timeView";

/** What the page's colours are, as the canvas needs them. */
export interface Ink {
  words: string;
  muted: string;
  line: string;
  raised: string;
  hover: string;
  active: string;
  rim: string;
  accent: string;
}

export interface LaneScene {
  width: number;
  height: number;
  /** Width of the names at the left. */
  gutter: number;
  scrollTop: number;
  view: TimeView;
  arrangement: Arrangement;
  links: readonly Link[];
  frame: number;
  selected: ReadonlySet<number>;
  hovered: number | null;
  mergeId: number | null;
  closed: ReadonlySet<string>;
  ink: Ink;
}

const FONT = '11px "Inter Variable", system-ui, sans-serif';
const BOLD = '600 11px "Inter Variable", system-ui, sans-serif';

/** The colour of each tenth of a score, as on the pictures. */
const LEVELS = Array.from(
  { length: FILLED },
  (_, tenth) => SCORE_STEPS.findLast((step) => (tenth + 0.5) / 10 >= step.from)?.colour as string,
);

export function paintLanes(ctx: CanvasRenderingContext2D, scene: LaneScene): void {
  const { width, height, arrangement, scrollTop } = scene;
  ctx.clearRect(0, 0, width, height);
  ctx.textBaseline = "middle";
  const first = Math.max(0, rowAt(arrangement, scrollTop));
  const last = rowsUntil(arrangement, first, scrollTop + height);
  for (let index = first; index < last; index += 1) {
    const row = arrangement.rows[index];
    const top = (arrangement.tops[index] as number) - scrollTop;
    if (row?.kind === "group") paintGroup(ctx, scene, row.name, row.count, top);
    else if (row) paintLane(ctx, scene, row.lane, top, (arrangement.tops[index + 1] as number) - scrollTop - top);
  }
  paintLinks(ctx, scene, first, last);
  paintPlayhead(ctx, scene);
}

function rowsUntil({ rows, tops }: Arrangement, first: number, bottom: number): number {
  let last = first;
  while (last < rows.length && (tops[last] as number) < bottom) last += 1;
  return last;
}

function paintGroup(ctx: CanvasRenderingContext2D, scene: LaneScene, name: string, count: number, top: number): void {
  const { ink, width, closed } = scene;
  ctx.fillStyle = ink.raised;
  ctx.fillRect(0, top, width, GROUP_PX);
  ctx.fillStyle = ink.words;
  ctx.font = BOLD;
  ctx.fillText(`${closed.has(name) ? "▸" : "▾"} ${name}`, 8, top + GROUP_PX / 2 + 0.5);
  const used = ctx.measureText(`${closed.has(name) ? "▸" : "▾"} ${name}`).width;
  ctx.font = FONT;
  ctx.fillStyle = ink.muted;
  ctx.fillText(String(count), 8 + used + 8, top + GROUP_PX / 2 + 0.5);
}

function paintLane(ctx: CanvasRenderingContext2D, scene: LaneScene, lane: Lane, top: number, height: number): void {
  const { ink, width, gutter, selected, hovered, view } = scene;
  const { identity } = lane;
  const isSelected = selected.has(identity.id);
  if (isSelected || hovered === identity.id) {
    ctx.fillStyle = isSelected ? ink.active : ink.hover;
    ctx.fillRect(0, top, width, height);
  }
  ctx.fillStyle = ink.line;
  ctx.fillRect(gutter, top + height - 1, width - gutter, 1);
  paintName(ctx, scene, lane, top + height / 2);

  const step = rowHeight(lane, selected);
  ctx.save();
  ctx.beginPath();
  ctx.rect(gutter, top, width - gutter, height);
  ctx.clip();
  ctx.translate(gutter, 0);
  const across = width - gutter;
  const faded = identity.mark === "ignored";
  if (faded) ctx.globalAlpha = 0.35;
  for (const segment of lane.segments) {
    if (segment.last + 1 < view.start || segment.first > view.start + view.frames) continue;
    paintSegment(ctx, scene, segment, top + LANE_PAD_PX / 2 + segment.row * step, step - 2, across);
    if (isSelected) paintCamera(ctx, scene, segment, top + LANE_PAD_PX / 2 + segment.row * step, step - 2, across);
  }
  ctx.globalAlpha = 1;
  const donor = lane.segments.find((one) => one.trackId === identity.donor.track_id);
  if (donor) {
    const x = (xOf(view, identity.donor.frame_index, across) + xOf(view, identity.donor.frame_index + 1, across)) / 2;
    paintDonor(ctx, scene, x, top + LANE_PAD_PX / 2 + donor.row * step + (step - 2) / 2, isSelected ? 5 : 3.5);
  }
  ctx.restore();
}

function paintName(
  ctx: CanvasRenderingContext2D,
  { ink, gutter }: LaneScene,
  { identity }: Lane,
  middle: number,
): void {
  ctx.fillStyle = identityColour(identity.id);
  ctx.beginPath();
  ctx.roundRect(8, middle - 4, 8, 8, 2.5);
  ctx.fill();
  ctx.font = FONT;
  ctx.fillStyle = identity.mark === "ignored" ? ink.muted : ink.words;
  const words = `${identity.class_name} #${identity.id}`;
  ctx.save();
  ctx.beginPath();
  ctx.rect(0, middle - 10, gutter - 22, 20);
  ctx.clip();
  ctx.fillText(words, 22, middle + 0.5);
  ctx.restore();
  if (identity.mark === "reviewed") {
    ctx.strokeStyle = ink.accent;
    ctx.lineWidth = 2;
    ctx.beginPath();
    ctx.moveTo(gutter - 18, middle);
    ctx.lineTo(gutter - 15, middle + 3);
    ctx.lineTo(gutter - 9, middle - 4);
    ctx.stroke();
  }
}

/** Full bars where the detector saw it, hollow ones where boxes are filled in, dots below where labels came from elsewhere. */
function paintSegment(
  ctx: CanvasRenderingContext2D,
  { ink, view }: LaneScene,
  segment: Segment,
  top: number,
  height: number,
  across: number,
): void {
  for (const run of segment.runs) {
    const x = xOf(view, run.start, across);
    const width = Math.max(1.5, xOf(view, run.stop, across) - x);
    if (x > across || x + width < 0) continue;
    if (run.level === FILLED) {
      ctx.strokeStyle = ink.muted;
      ctx.lineWidth = 1;
      ctx.strokeRect(x + 0.5, top + 0.5, width - 1, height - 1);
    } else {
      ctx.fillStyle = LEVELS[run.level] as string;
      ctx.fillRect(x, top, width, height);
    }
  }
  const start = Math.max(-4, xOf(view, segment.first, across));
  const stop = Math.min(across + 4, xOf(view, segment.last + 1, across));
  ctx.strokeStyle = ink.rim;
  ctx.lineWidth = 1;
  ctx.strokeRect(start, top, Math.max(1.5, stop - start), height);
  if (segment.fromOtherTrack) {
    ctx.strokeStyle = ink.words;
    ctx.lineWidth = 1.5;
    ctx.setLineDash([1.5, 2.5]);
    ctx.beginPath();
    ctx.moveTo(start, top + height + 1.5);
    ctx.lineTo(stop, top + height + 1.5);
    ctx.stroke();
    ctx.setLineDash([]);
  }
}

function paintCamera(
  ctx: CanvasRenderingContext2D,
  { view }: LaneScene,
  segment: Segment,
  top: number,
  height: number,
  across: number,
): void {
  const start = Math.max(0, xOf(view, segment.first, across));
  const stop = Math.min(across, xOf(view, segment.last + 1, across));
  ctx.font = '600 9px "Inter Variable", system-ui, sans-serif';
  if (stop - start < ctx.measureText(segment.camera).width + 8) return;
  ctx.fillStyle = "#0b0d11";
  ctx.fillText(segment.camera, start + 4, top + height / 2 + 0.5);
}

function paintDonor(ctx: CanvasRenderingContext2D, { ink }: LaneScene, x: number, y: number, size: number): void {
  ctx.beginPath();
  ctx.moveTo(x, y - size);
  ctx.lineTo(x + size, y);
  ctx.lineTo(x, y + size);
  ctx.lineTo(x - size, y);
  ctx.closePath();
  ctx.fillStyle = "#fff";
  ctx.strokeStyle = ink.rim;
  ctx.lineWidth = 1.5;
  ctx.fill();
  ctx.stroke();
}

/** Merges inside a lane as short ties; those between two lanes, and the open one, as arcs. */
function paintLinks(ctx: CanvasRenderingContext2D, scene: LaneScene, first: number, last: number): void {
  const { links, gutter, width, height, view, ink, mergeId, selected } = scene;
  ctx.save();
  ctx.beginPath();
  ctx.rect(gutter, 0, width - gutter, height);
  ctx.clip();
  ctx.translate(gutter, 0);
  const across = width - gutter;
  for (const link of links) {
    const [above, below] = link.from.lane <= link.to.lane ? [link.from, link.to] : [link.to, link.from];
    if (below.lane < first || above.lane >= last) continue;
    const isOpen = link.merge.id === mergeId;
    const inLane = above.lane === below.lane;
    if (!inLane && !isOpen && !touches(scene, link, selected)) continue;
    const x = (xOf(view, link.frame, across) + xOf(view, link.frame + 1, across)) / 2;
    if (x < -20 || x > across + 20) continue;
    const [y1, y2] = [middleOf(scene, above), middleOf(scene, below)];
    ctx.strokeStyle = isOpen ? ink.accent : ink.words;
    ctx.fillStyle = ctx.strokeStyle;
    ctx.lineWidth = isOpen ? 2 : 1.25;
    ctx.setLineDash(link.merge.state === "proposed" ? [3, 3] : []);
    ctx.beginPath();
    ctx.moveTo(x, y1);
    if (inLane) ctx.lineTo(x, y2);
    else ctx.bezierCurveTo(x + 14, y1, x + 14, y2, x, y2);
    ctx.stroke();
    for (const y of [y1, y2]) {
      ctx.beginPath();
      ctx.arc(x, y, isOpen ? 2.5 : 1.75, 0, 2 * Math.PI);
      ctx.fill();
    }
  }
  ctx.setLineDash([]);
  ctx.restore();
}

function touches({ arrangement }: LaneScene, link: Link, selected: ReadonlySet<number>): boolean {
  return [link.from, link.to].some(({ lane }) => {
    const row = arrangement.rows[lane];
    return row?.kind === "lane" && selected.has(row.lane.identity.id);
  });
}

function middleOf({ arrangement, scrollTop, selected }: LaneScene, end: Link["from"]): number {
  const row = arrangement.rows[end.lane];
  const top = (arrangement.tops[end.lane] as number) - scrollTop;
  if (row?.kind !== "lane") return top;
  const step = rowHeight(row.lane, selected);
  return top + LANE_PAD_PX / 2 + end.segment.row * step + (step - 2) / 2;
}

export function paintPlayhead(
  ctx: CanvasRenderingContext2D,
  {
    view,
    frame,
    gutter,
    width,
    height,
    ink,
  }: Pick<LaneScene, "view" | "frame" | "gutter" | "width" | "height" | "ink">,
): void {
  const across = width - gutter;
  const left = gutter + xOf(view, frame, across);
  const wide = Math.max(2, xOf(view, frame + 1, across) + gutter - left);
  if (left + wide < gutter || left > width) return;
  ctx.fillStyle = ink.words;
  ctx.globalAlpha = 0.14;
  ctx.fillRect(Math.max(gutter, left), 0, wide, height);
  ctx.globalAlpha = 1;
  ctx.fillRect(Math.max(gutter, left + wide / 2 - 1), 0, 2, height);
}

/** What a lane says when it is pointed at. */
export function wordsOf(lane: Lane, segment: Segment | undefined, frame: number): string {
  const { identity } = lane;
  const name = `#${identity.id} ${identity.class_name}`;
  if (!segment) return name;
  const run = segment.runs.find((one) => frame >= one.start && frame < one.stop);
  const sure = !run
    ? text.timeline.notSeen
    : run.level === FILLED
      ? text.timeline.filledIn
      : text.timeline.scoreAbout(run.level / 10, (run.level + 1) / 10);
  const parts = [name, segment.camera, text.timeline.frames(segment.first, segment.last), sure];
  if (segment.fromOtherTrack) parts.push(text.timeline.fromOtherTrack);
  return parts.join(" · ");
}
