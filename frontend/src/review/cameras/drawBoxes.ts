/** Draws boxes and their labels on a canvas whose units are CSS pixels of the tile. */

import type { Observation } from "../../api/types";
import { score } from "../../app/format";
import { type Colouring, colourOf } from "./colouring";
import type { Transform } from "./viewport";

/** Labels of a lower score, or of none, are drawn faded. */
export const FADED_BELOW = 0.3;
const FADED_ALPHA = 0.5;

export interface BoxStyle {
  transform: Transform;
  colouring: Colouring;
  /** Device px per CSS px: edges are put on whole device px, so that they stay sharp. */
  pixelRatio: number;
  selectedIds: readonly number[];
  hoveredId: number | null;
  width: number;
  height: number;
}

interface Rect {
  x: number;
  y: number;
  width: number;
  height: number;
}

const FONT = '600 11px "Inter Variable", system-ui, sans-serif';
const LABEL_HEIGHT = 16;
const ARROW_WIDTH = 11;
const NARROWEST_LABELLED = 26;

type Emphasis = "strong" | "normal" | "dim";

function emphasisOf(one: Observation, style: BoxStyle): Emphasis {
  if (one.identity_id === style.hoveredId || style.selectedIds.includes(one.identity_id)) return "strong";
  return style.selectedIds.length > 0 ? "dim" : "normal";
}

export function drawBoxes(ctx: CanvasRenderingContext2D, observations: readonly Observation[], style: BoxStyle): void {
  ctx.clearRect(0, 0, style.width, style.height);
  const order: Record<Emphasis, number> = { dim: 0, normal: 1, strong: 2 };
  const items = observations
    .map((one) => ({
      one,
      emphasis: emphasisOf(one, style),
      rect: rectOf(one, style),
      colour: colourOf(one, style.colouring),
    }))
    .filter(({ rect }) => isSeen(rect, style))
    .sort((a, b) => order[a.emphasis] - order[b.emphasis]);
  // Lines grow a little with the picture, so that they are seen on a large screen too.
  const weight = Math.min(2, Math.max(1, style.width / 800));
  for (const item of items) drawBox(ctx, item, weight);
  drawLabels(ctx, items, style);
}

/** The box on the tile (CSS px), its edges on whole device px. */
export function rectOf(one: Pick<Observation, "box">, { transform, pixelRatio }: BoxStyle): Rect {
  const [x1, y1, x2, y2] = one.box as [number, number, number, number];
  const place = (offset: number, value: number) =>
    Math.round((offset + value * transform.scale) * pixelRatio) / pixelRatio;
  const x = place(transform.offsetX, x1);
  const y = place(transform.offsetY, y1);
  return { x, y, width: place(transform.offsetX, x2) - x, height: place(transform.offsetY, y2) - y };
}

function isSeen(rect: Rect, { width, height }: BoxStyle): boolean {
  return rect.x < width && rect.y < height && rect.x + rect.width > 0 && rect.y + rect.height > 0;
}

function drawBox(ctx: CanvasRenderingContext2D, { one, rect, emphasis, colour }: Item, weight: number): void {
  const faded = emphasis !== "strong" && (one.label.score ?? 0) < FADED_BELOW ? FADED_ALPHA : 1;
  ctx.globalAlpha = faded * (emphasis === "dim" ? 0.4 : 1);
  if (emphasis === "strong") {
    ctx.fillStyle = colour;
    ctx.globalAlpha = 0.16;
    ctx.fillRect(rect.x, rect.y, rect.width, rect.height);
    ctx.globalAlpha = 1;
  }
  const line = weight * (emphasis === "strong" ? 2.5 : emphasis === "dim" ? 1 : 1.75);
  ctx.setLineDash(one.filled ? [5, 4] : []);
  if (emphasis !== "dim") {
    // A dark rim keeps a light line visible on a light street.
    ctx.strokeStyle = "rgba(0, 0, 0, 0.55)";
    ctx.lineWidth = line + 2;
    ctx.strokeRect(rect.x, rect.y, rect.width, rect.height);
  }
  ctx.strokeStyle = colour;
  ctx.lineWidth = line;
  ctx.strokeRect(rect.x, rect.y, rect.width, rect.height);
  ctx.globalAlpha = 1;
  ctx.setLineDash([]);
}

interface Item {
  one: Observation;
  emphasis: Emphasis;
  rect: Rect;
  colour: string;
}

/** Labels of what matters most first: selected, then large; a label that would cover another is left out. */
function drawLabels(ctx: CanvasRenderingContext2D, items: readonly Item[], style: BoxStyle): void {
  ctx.font = FONT;
  ctx.textBaseline = "middle";
  const taken: Rect[] = [];
  const labelled = items
    .filter(
      (item) => item.emphasis === "strong" || (item.emphasis === "normal" && item.rect.width >= NARROWEST_LABELLED),
    )
    .sort(
      (a, b) =>
        Number(b.emphasis === "strong") - Number(a.emphasis === "strong") ||
        b.rect.width * b.rect.height - a.rect.width * a.rect.height,
    );
  for (const { one, rect, emphasis, colour } of labelled) {
    const words = `${one.label.class_name} ${score(one.label.score)}`;
    const marked = one.label.source !== "auto";
    const width = widthOf(ctx, words) + 10 + (marked ? ARROW_WIDTH : 0);
    const x = Math.min(Math.max(rect.x - 1, 0), Math.max(0, style.width - width));
    const above = rect.y - LABEL_HEIGHT - 1;
    const inside = Math.max(0, rect.y) + 1;
    const spots = above >= 0 ? [above, rect.y + rect.height + 1] : [inside, rect.y + rect.height + 1];
    const spot = spots
      .map((y) => ({ x, y: Math.min(y, style.height - LABEL_HEIGHT), width, height: LABEL_HEIGHT }))
      .find((candidate) => !taken.some((other) => overlap(candidate, other)));
    if (!spot && emphasis !== "strong") {
      if (one.label.source === "propagated") drawCornerArrow(ctx, colour, rect);
      continue;
    }
    const place = spot ?? { x, y: Math.max(0, above), width, height: LABEL_HEIGHT };
    taken.push(place);
    drawLabel(ctx, one, colour, words, place);
  }
}

/** Measuring words is slow, and they repeat from frame to frame. */
const widths = new Map<string, number>();

function widthOf(ctx: CanvasRenderingContext2D, words: string): number {
  let width = widths.get(words);
  if (width === undefined) {
    if (widths.size > 5_000) widths.clear();
    width = ctx.measureText(words).width;
    // Before its font has come, the browser measures another.
    if (document.fonts.status === "loaded") widths.set(words, width);
  }
  return width;
}

function overlap(a: Rect, b: Rect): boolean {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/** The label's own origin is a full chip; a propagated one is a dark chip with a dotted rim and an arrow into it. */
function drawLabel(ctx: CanvasRenderingContext2D, one: Observation, colour: string, words: string, place: Rect): void {
  const propagated = one.label.source === "propagated";
  ctx.save();
  ctx.beginPath();
  ctx.roundRect(place.x, place.y, place.width, place.height, 3);
  ctx.fillStyle = propagated ? "rgba(8, 10, 14, 0.86)" : colour;
  ctx.fill();
  if (propagated) {
    ctx.setLineDash([2, 2]);
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1;
    ctx.stroke();
    ctx.setLineDash([]);
  }
  ctx.fillStyle = propagated ? colour : "#0b0d11";
  let textX = place.x + 5;
  const middle = place.y + place.height / 2;
  if (propagated) {
    drawArrow(ctx, textX, middle, colour);
    textX += ARROW_WIDTH;
  } else if (one.label.source === "human") {
    ctx.beginPath();
    ctx.arc(textX + 3, middle, 3, 0, 2 * Math.PI);
    ctx.fill();
    textX += ARROW_WIDTH;
  }
  ctx.fillText(words, textX, middle + 0.5);
  ctx.restore();
}

function drawArrow(ctx: CanvasRenderingContext2D, x: number, y: number, colour: string): void {
  ctx.save();
  ctx.setLineDash([]);
  ctx.strokeStyle = colour;
  ctx.lineWidth = 1.5;
  ctx.lineCap = "round";
  ctx.lineJoin = "round";
  ctx.beginPath();
  ctx.moveTo(x, y);
  ctx.lineTo(x + 7, y);
  ctx.moveTo(x + 4, y - 3);
  ctx.lineTo(x + 7, y);
  ctx.lineTo(x + 4, y + 3);
  ctx.stroke();
  ctx.restore();
}

/** Where there is no room for the label, the arrow alone says that it is propagated. */
function drawCornerArrow(ctx: CanvasRenderingContext2D, colour: string, rect: Rect): void {
  if (rect.width < 14 || rect.height < 12) return;
  ctx.fillStyle = "rgba(8, 10, 14, 0.8)";
  ctx.fillRect(rect.x + 1, rect.y + 1, 11, 9);
  drawArrow(ctx, rect.x + 3, rect.y + 5.5, colour);
}
