import { ActionIcon, Tooltip } from "@mantine/core";
import { IconArrowsDiagonal, IconArrowsDiagonalMinimize2, IconZoomReset } from "@tabler/icons-react";
import { memo, useLayoutEffect, useMemo, useRef } from "react";
import { useStore } from "zustand";
import type { DriveDetail } from "../../api/types";
import { text } from "../../strings";
import { withKey } from "../keys/Key";
import { useReview, useShared } from "../ReviewContext";
import { filterOf, useAppearance } from "./appearance";
import classes from "./CameraView.module.css";
import { drawBoxes } from "./drawBoxes";
import type { CommittedFrame } from "./frameStore";
import type { Tile } from "./layout";
import { ObservationCaption } from "./ObservationCaption";
import { usePointerTool } from "./pointerTool";
import { usePointer } from "./usePointer";
import { FIT, type Transform, transformOf } from "./viewport";

interface CameraViewProps {
  camera: DriveDetail["cameras"][number];
  tile: Tile;
  committed: CommittedFrame<ImageBitmap>;
  enlarged: boolean;
  onEnlarge: ((camera: string) => void) | null;
}

/**
 * One camera's picture and the boxes on it.
 *
 * Both are painted in the layout effects of one commit of React, and so are those of all other cameras: what belongs to
 * one frame of the drive comes to the screen in one frame of the browser.
 */
export const CameraView = memo(function CameraView({ camera, tile, committed, enlarged, onEnlarge }: CameraViewProps) {
  const { views } = useShared();
  const view = useStore(views, (state) => state.views[camera.name] ?? FIT);
  const hover = useReview((state) => state.hover);
  const pictureCanvas = useRef<HTMLCanvasElement>(null);
  const shown = committed.pictures.get(camera.name);
  const picture = shown?.picture ?? null;
  const filter = useAppearance((state) => filterOf(state.adjustments));
  const transform = useMemo(
    () => transformOf(view, tile, { width: camera.width_px, height: camera.height_px }),
    [view, tile, camera],
  );
  const observations = useMemo(
    () => committed.observations.filter((one) => one.camera === camera.name),
    [committed.observations, camera.name],
  );
  const hovered = hover ? observations.find((one) => one.id === hover.observationId) : undefined;

  useLayoutEffect(() => {
    const ctx = prepare(pictureCanvas.current, tile);
    if (!ctx) return;
    // A closed bitmap has no width; the next frame is about to take its place.
    if (!picture || picture.width === 0) {
      ctx.clearRect(0, 0, tile.width, tile.height);
      return;
    }
    // Far in, the pixels are what one wants to see.
    ctx.imageSmoothingEnabled = transform.scale * (camera.width_px / picture.width) < 6;
    ctx.imageSmoothingQuality = "high";
    const { scale, offsetX, offsetY } = transform;
    ctx.drawImage(picture, offsetX, offsetY, camera.width_px * scale, camera.height_px * scale);
  }, [picture, tile, transform, camera]);

  const boxCanvas = useBoxes({
    observations: picture ? observations : [],
    tile,
    transform,
    camera: camera.name,
    frame: committed.frame,
  });
  const pointer = usePointer(boxCanvas, { camera: camera.name, frame: committed.frame, observations, tile, transform });

  return (
    <figure
      className={classes.view}
      style={{ left: tile.x, top: tile.y, width: tile.width, height: tile.height }}
      data-frame={committed.frame}
      data-revision={committed.revision}
      data-zoom={view.zoom}
      aria-label={text.cameras.view(camera.name, observations.length)}
    >
      <canvas ref={pictureCanvas} className={classes.layer} style={{ filter }} aria-hidden />
      <canvas
        ref={boxCanvas}
        className={classes.layer}
        aria-hidden
        data-hit={hovered !== undefined || undefined}
        {...pointer}
      />
      {!picture && (
        <div className={classes.missing}>
          {shown?.picture === null && shown.missing ? text.cameras.noPicture : text.cameras.pictureFailed}
        </div>
      )}
      <figcaption className={classes.name}>{camera.name}</figcaption>
      <div className={classes.buttons} data-kept={enlarged || view.zoom > 1 || undefined}>
        {view.zoom > 1 && (
          <Tooltip label={withKey(text.cameras.zoomFit, "zoomFit")} openDelay={500}>
            <button
              type="button"
              className={classes.zoom}
              aria-label={text.cameras.zoomFit}
              onClick={() => views.getState().change(camera.name, () => FIT)}
            >
              {view.zoom.toFixed(1)}× <IconZoomReset size={14} />
            </button>
          </Tooltip>
        )}
        {onEnlarge && (
          <Tooltip
            label={withKey(enlarged ? text.cameras.shrink : text.cameras.enlarge(camera.name), "enlarge")}
            openDelay={500}
          >
            <ActionIcon
              size={26}
              variant="filled"
              color="dark.8"
              aria-label={enlarged ? text.cameras.shrink : text.cameras.enlarge(camera.name)}
              aria-pressed={enlarged}
              onClick={() => onEnlarge(camera.name)}
            >
              {enlarged ? <IconArrowsDiagonalMinimize2 size={15} /> : <IconArrowsDiagonal size={15} />}
            </ActionIcon>
          </Tooltip>
        )}
      </div>
      {hovered && <ObservationCaption observation={hovered} />}
    </figure>
  );
});

interface Boxes {
  observations: CommittedFrame<ImageBitmap>["observations"];
  tile: Tile;
  transform: Transform;
  camera: string;
  frame: number;
}

/** The canvas of the boxes, painted anew whenever what they show changes; a tool paints over them. */
function useBoxes({ observations, tile, transform, camera, frame }: Boxes) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const selectedIds = useReview((state) => state.identityIds);
  const hoveredId = useReview((state) => state.hover?.identityId ?? null);
  const colouring = useAppearance((state) => state.colouring);
  const { tool, painted } = usePointerTool();
  // biome-ignore lint/correctness/useExhaustiveDependencies: `painted` says when the tool looks different.
  useLayoutEffect(() => {
    const ctx = prepare(canvas.current, tile);
    if (!ctx) return;
    const pixelRatio = window.devicePixelRatio;
    const { width, height } = tile;
    drawBoxes(ctx, observations, { transform, colouring, pixelRatio, selectedIds, hoveredId, width, height });
    tool?.paint?.(ctx, { camera, frame, transform });
  }, [observations, tile, transform, camera, frame, selectedIds, hoveredId, colouring, tool, painted]);
  return canvas;
}

/** Sizes a canvas to the device's pixels and gives a context whose unit is the CSS pixel. */
function prepare(canvas: HTMLCanvasElement | null, tile: Tile): CanvasRenderingContext2D | null {
  const ctx = canvas?.getContext("2d");
  if (!canvas || !ctx) return null;
  const ratio = window.devicePixelRatio;
  const width = Math.round(tile.width * ratio);
  const height = Math.round(tile.height * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  ctx.setTransform(width / tile.width, 0, 0, height / tile.height, 0, 0);
  return ctx;
}
