import { ActionIcon, Tooltip } from "@mantine/core";
import { IconArrowsDiagonal, IconArrowsDiagonalMinimize2 } from "@tabler/icons-react";
import { type MouseEvent, type PointerEvent, useEffect, useMemo, useRef } from "react";
import type { DriveDetail, Observation } from "../../api/types";
import { text } from "../../strings";
import { withKey } from "../keys/Key";
import { useReview, useShared } from "../ReviewContext";
import classes from "./CameraView.module.css";
import { drawBoxes } from "./drawBoxes";
import type { CommittedFrame } from "./frameStore";
import { observationAt } from "./hitTest";
import type { Tile } from "./layout";
import { ObservationCaption } from "./ObservationCaption";

interface CameraViewProps {
  camera: DriveDetail["cameras"][number];
  tile: Tile;
  committed: CommittedFrame<ImageBitmap>;
  enlarged: boolean;
  onEnlarge: (() => void) | null;
}

const HIT_SLACK_PX = 3;

/** One camera's picture and the boxes on it. */
export function CameraView({ camera, tile, committed, enlarged, onEnlarge }: CameraViewProps) {
  const { store } = useShared();
  const identityIds = useReview((state) => state.identityIds);
  const hover = useReview((state) => state.hover);
  const pictureCanvas = useRef<HTMLCanvasElement>(null);
  const boxCanvas = useRef<HTMLCanvasElement>(null);
  const shown = committed.pictures.get(camera.name);
  const picture = shown?.picture ?? null;
  const scale = tile.width / camera.width_px;
  const observations = useMemo(
    () => committed.observations.filter((one) => one.camera === camera.name),
    [committed.observations, camera.name],
  );
  const hovered = hover ? observations.find((one) => one.id === hover.observationId) : undefined;

  useEffect(() => {
    const ctx = prepare(pictureCanvas.current, tile);
    if (!ctx) return;
    ctx.imageSmoothingQuality = "high";
    // A closed bitmap has no width; the next frame is about to take its place.
    if (picture && picture.width > 0) ctx.drawImage(picture, 0, 0, tile.width, tile.height);
  }, [picture, tile]);

  useEffect(() => {
    const ctx = prepare(boxCanvas.current, tile);
    if (!ctx) return;
    drawBoxes(ctx, picture ? observations : [], {
      scale,
      selectedIds: identityIds,
      hoveredId: hover?.identityId ?? null,
      width: tile.width,
      height: tile.height,
    });
  }, [observations, picture, tile, scale, identityIds, hover]);

  const under = (event: MouseEvent<HTMLElement>): Observation | null => {
    const bounds = event.currentTarget.getBoundingClientRect();
    const x = (event.clientX - bounds.left) / scale;
    const y = (event.clientY - bounds.top) / scale;
    return observationAt(observations, x, y, HIT_SLACK_PX / scale);
  };

  const onMove = (event: PointerEvent<HTMLElement>) => {
    const one = under(event);
    const { hover: before, setHover } = store.getState();
    if (one?.id !== before?.observationId) {
      setHover(one && { identityId: one.identity_id, observationId: one.id });
    }
  };

  return (
    <figure
      className={classes.view}
      style={{ left: tile.x, top: tile.y, width: tile.width, height: tile.height }}
      data-hit={hovered !== undefined || undefined}
      aria-label={text.cameras.view(camera.name, observations.length)}
    >
      <canvas ref={pictureCanvas} className={classes.layer} aria-hidden />
      <canvas
        ref={boxCanvas}
        className={classes.layer}
        aria-hidden
        onPointerMove={onMove}
        onPointerLeave={() => store.getState().setHover(null)}
        onClick={(event) => {
          const one = under(event);
          if (one) store.getState().select([one.identity_id], "selected");
          else store.getState().clear();
        }}
        onDoubleClick={() => onEnlarge?.()}
      />
      {!picture && (
        <div className={classes.missing}>
          {shown?.picture === null && shown.missing ? text.cameras.noPicture : text.cameras.pictureFailed}
        </div>
      )}
      <figcaption className={classes.name}>{camera.name}</figcaption>
      {onEnlarge && (
        <Tooltip
          label={withKey(enlarged ? text.cameras.shrink : text.cameras.enlarge(camera.name), "enlarge")}
          openDelay={500}
        >
          <ActionIcon
            className={classes.enlarge}
            size={26}
            variant="filled"
            color="dark.8"
            aria-label={enlarged ? text.cameras.shrink : text.cameras.enlarge(camera.name)}
            aria-pressed={enlarged}
            onClick={onEnlarge}
          >
            {enlarged ? <IconArrowsDiagonalMinimize2 size={15} /> : <IconArrowsDiagonal size={15} />}
          </ActionIcon>
        </Tooltip>
      )}
      {hovered && <ObservationCaption observation={hovered} />}
    </figure>
  );
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
