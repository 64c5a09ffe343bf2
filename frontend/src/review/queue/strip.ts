/** Which looks of a strip there is room for, and where they stand. */

import type { Look } from "../../api/types";

export interface Lane {
  camera: string;
  looks: { look: Look; left: number }[];
}

/**
 * Lanes of cameras in the given order, with the looks that fit at their times without covering each other.
 * `width` is the room for a lane, `thumb` that of a look (px); `left` is where a look begins.
 */
export function lanes(strip: readonly Look[], cameras: readonly string[], width: number, thumb: number): Lane[] {
  const frames = strip.map((look) => look.frame_index);
  const first = Math.min(...frames);
  const span = Math.max(1, Math.max(...frames) - first);
  const room = Math.max(0, width - thumb);
  return cameras
    .map((camera) => {
      const looks: Lane["looks"] = [];
      let free = 0;
      for (const look of strip) {
        if (look.camera !== camera) continue;
        const left = ((look.frame_index - first) / span) * room;
        if (left < free - 0.5) continue;
        looks.push({ look, left });
        free = left + thumb + 3;
      }
      return { camera, looks };
    })
    .filter((lane) => lane.looks.length > 0);
}
