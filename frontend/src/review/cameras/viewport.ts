/**
 * Which part of a picture its tile shows: pan and zoom.
 *
 * A tile has the aspect of its picture, so a viewport is a zoom (1 shows all of it) and the point of the picture that
 * is in the middle, as parts of its width and height. Points of the tile are parts of the tile.
 */

export interface Viewport {
  readonly zoom: number;
  readonly x: number;
  readonly y: number;
}

/** Where picture px fall on the tile, in CSS px: `screen = offset + scale * picture`. */
export interface Transform {
  readonly scale: number;
  readonly offsetX: number;
  readonly offsetY: number;
}

interface Point {
  x: number;
  y: number;
}

interface Size {
  width: number;
  height: number;
}

export const FIT: Viewport = { zoom: 1, x: 0.5, y: 0.5 };
export const LARGEST_ZOOM = 32;

/** The viewport with its picture covering the whole tile, and its zoom within limits. */
function inside({ zoom, x, y }: Viewport): Viewport {
  const limited = Math.min(LARGEST_ZOOM, Math.max(1, zoom));
  const half = 0.5 / limited;
  const clamp = (value: number) => Math.min(1 - half, Math.max(half, value));
  return { zoom: limited, x: clamp(x), y: clamp(y) };
}

/** Zooms by a factor; what is under the point of the tile stays under it. */
export function zoomAt(view: Viewport, factor: number, at: Point): Viewport {
  const zoom = Math.min(LARGEST_ZOOM, Math.max(1, view.zoom * factor));
  const move = (centre: number, part: number) => centre + (part - 0.5) * (1 / view.zoom - 1 / zoom);
  return inside({ zoom, x: move(view.x, at.x), y: move(view.y, at.y) });
}

/** Moves the picture with the hand: by so large a part of the tile. */
export function panBy(view: Viewport, by: Point): Viewport {
  return inside({ zoom: view.zoom, x: view.x - by.x / view.zoom, y: view.y - by.y / view.zoom });
}

export function transformOf(view: Viewport, tile: Size, picture: Size): Transform {
  const scale = (tile.width / picture.width) * view.zoom;
  return {
    scale,
    offsetX: tile.width / 2 - view.x * picture.width * scale,
    offsetY: tile.height / 2 - view.y * picture.height * scale,
  };
}

/** The point of the picture (px) under a point of the tile (CSS px). */
export function toPicture(transform: Transform, at: Point): Point {
  return { x: (at.x - transform.offsetX) / transform.scale, y: (at.y - transform.offsetY) / transform.scale };
}
