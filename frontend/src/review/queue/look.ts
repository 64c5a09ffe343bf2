/** Cut-outs of pictures, made by the server. */

import { imageUrl } from "../../api/imageUrl";
import type { DriveDetail, Look } from "../../api/types";
import { cropWindow, type Window } from "../cameras/cropWindow";

export interface CutOut {
  url: string;
  /** Where the box lies in the cut-out, in percent of its size. */
  box: { left: number; top: number; width: number; height: number };
}

/** Widths that are asked for: few, so that the same cut-out serves in several places. */
export type LookWidth = 160 | 720;

/** The cut-out of a look with some surroundings, in an aspect (width / height); null for a camera that is not known. */
export function cutOut(drive: DriveDetail, look: Look, aspect: number, width: LookWidth): CutOut | null {
  const camera = drive.cameras.find((one) => one.name === look.camera);
  if (!camera) return null;
  const part = rounded(cropWindow(look.box, { width: camera.width_px, height: camera.height_px }, aspect));
  const [x1, y1, x2, y2] = look.box as [number, number, number, number];
  const url = new URLSearchParams({ crop: `${part.x},${part.y},${part.width},${part.height}`, max_width: `${width}` });
  return {
    url: `${imageUrl(drive.id, look.frame_index, look.camera)}?${url}`,
    box: {
      left: (100 * (x1 - part.x)) / part.width,
      top: (100 * (y1 - part.y)) / part.height,
      width: (100 * (x2 - x1)) / part.width,
      height: (100 * (y2 - y1)) / part.height,
    },
  };
}

function rounded(part: Window): Window {
  const x = Math.floor(part.x);
  const y = Math.floor(part.y);
  return { x, y, width: Math.max(1, Math.round(part.width)), height: Math.max(1, Math.round(part.height)) };
}

const LOADED_KEPT = 200;
const loaded = new Map<string, HTMLImageElement>();

/** Loads a picture ahead and keeps it decoded, so that it is there at once when it is shown. */
export function preload(url: string): void {
  const known = loaded.get(url);
  if (known) return;
  const image = new Image();
  image.src = url;
  void image.decode().catch(() => loaded.delete(url));
  loaded.set(url, image);
  for (const old of loaded.keys()) {
    if (loaded.size <= LOADED_KEPT) break;
    loaded.delete(old);
  }
}
