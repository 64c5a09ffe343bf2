/** How wide the first pictures are asked for, before anything is laid out. */

import type { DriveDetail } from "../../api/types";
import { layoutCameras } from "./layout";
import { pictureWidth } from "./pictureWidth";

/** What the cameras have of the window, about. */
const SHARE = { width: 0.75, height: 0.65 };

/** Widths by camera; undefined is the original. Where the guess is too small, sharper pictures follow. */
export function firstWidths(drive: Pick<DriveDetail, "cameras">): Map<string, number | undefined> {
  const cameras = new Map(drive.cameras.map((camera) => [camera.name, camera]));
  const room = { width: window.innerWidth * SHARE.width, height: window.innerHeight * SHARE.height, gap: 0 };
  const aspect = (name: string) => {
    const camera = cameras.get(name);
    return camera && camera.height_px > 0 ? camera.width_px / camera.height_px : 16 / 9;
  };
  const tiles = layoutCameras([...cameras.keys()], aspect, room, null);
  return new Map(
    tiles.map((tile) => [
      tile.camera,
      pictureWidth(tile.width * window.devicePixelRatio, cameras.get(tile.camera)?.width_px ?? 0),
    ]),
  );
}
