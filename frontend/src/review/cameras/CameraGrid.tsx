import { Loader } from "@mantine/core";
import { useCallback, useEffect, useMemo } from "react";
import { useStore } from "zustand";
import { Notice } from "../../app/Notice";
import { useSize } from "../../app/useSize";
import { text } from "../../strings";
import { useActions } from "../keys/actions";
import { useCommitted, useReview, useShared } from "../ReviewContext";
import classes from "./CameraGrid.module.css";
import { CameraView } from "./CameraView";
import { inCarOrder, layoutCameras, type Tile } from "./layout";
import { pictureWidth } from "./pictureWidth";
import { GammaFilter, StageBar } from "./StageBar";
import { panBy, zoomAt } from "./viewport";

const GAP_PX = 6;
const DEFAULT_ASPECT = 16 / 9;
const ZOOM_STEP = 1.4;
const PAN_STEP = 0.15;
const SHARPEN_AFTER_MS = 150;

/** All cameras in step, laid out like the car. */
export function CameraGrid() {
  const { drive, store, frames } = useShared();
  const [ref, { width, height }] = useSize<HTMLDivElement>();
  const enlarged = useReview((state) => state.enlarged);
  const setEnlarged = useReview((state) => state.setEnlarged);
  const committed = useCommitted();
  const cameras = drive.cameras;

  const tiles = useMemo(() => {
    const aspects = new Map(cameras.map((camera) => [camera.name, camera.width_px / camera.height_px]));
    return layoutCameras(
      cameras.map((camera) => camera.name),
      (camera) => aspects.get(camera) || DEFAULT_ASPECT,
      { width, height, gap: GAP_PX },
      enlarged,
    );
  }, [cameras, width, height, enlarged]);

  usePictureWidths(tiles);
  useViewKeys();
  const enlarge = useCallback(
    (camera: string) => setEnlarged(store.getState().enlarged === camera ? null : camera),
    [store, setEnlarged],
  );

  return (
    <section className={classes.grid} aria-label={text.cameras.name}>
      <StageBar />
      <GammaFilter />
      <div className={classes.stage} ref={ref}>
        {!committed && (
          <div className={classes.waiting}>
            <Loader size="sm" role="img" aria-label={text.cameras.loading} />
          </div>
        )}
        {committed &&
          tiles.map((tile) => {
            const camera = cameras.find((one) => one.name === tile.camera);
            return (
              camera && (
                <CameraView
                  key={tile.camera}
                  camera={camera}
                  tile={tile}
                  committed={committed}
                  enlarged={enlarged === tile.camera}
                  onEnlarge={cameras.length > 1 ? enlarge : null}
                />
              )
            );
          })}
        {committed?.observationsFailed && (
          <div className={classes.failed} role="alert">
            <Notice title={text.cameras.observationsFailed} onRetry={() => frames.request(committed.frame)} />
          </div>
        )}
      </div>
    </section>
  );
}

/** Asks for pictures as large as they are shown. What grows is asked for anew; what shrinks keeps what it has. */
function usePictureWidths(tiles: readonly Tile[]): void {
  const { drive, frames, pictureWidths, views } = useShared();
  const zooms = useStore(views, (state) => state.views);
  useEffect(() => {
    if (tiles.length === 0) return;
    const ask = () => {
      let grown = false;
      for (const tile of tiles) {
        const original = drive.cameras.find((camera) => camera.name === tile.camera)?.width_px ?? 0;
        const zoom = zooms[tile.camera]?.zoom ?? 1;
        const wanted = pictureWidth(tile.width * zoom * window.devicePixelRatio, original);
        const known = pictureWidths.has(tile.camera) ? (pictureWidths.get(tile.camera) ?? original) : 0;
        grown ||= (wanted ?? original) > known;
        pictureWidths.set(tile.camera, wanted);
      }
      if (!grown) return;
      frames.resize();
    };
    const timer = setTimeout(ask, SHARPEN_AFTER_MS);
    return () => clearTimeout(timer);
  }, [tiles, zooms, drive.cameras, frames, pictureWidths]);
}

/** Keys zoom and move the camera that was pointed at last; before that, the enlarged one or the first. */
function useViewKeys(): void {
  const { drive, store, views } = useShared();
  const change = (how: Parameters<ReturnType<typeof views.getState>["change"]>[1]) => {
    const { active, change: set } = views.getState();
    const camera = store.getState().enlarged ?? active ?? inCarOrder(drive.camera_names)[0];
    if (camera !== undefined) set(camera, how);
  };
  const middle = { x: 0.5, y: 0.5 };
  const pan = (x: number, y: number) => change((view) => panBy(view, { x, y }));
  useActions({
    zoomIn: () => change((view) => zoomAt(view, ZOOM_STEP, middle)),
    zoomOut: () => change((view) => zoomAt(view, 1 / ZOOM_STEP, middle)),
    zoomFit: () => views.getState().fit(),
    panLeft: () => pan(PAN_STEP, 0),
    panRight: () => pan(-PAN_STEP, 0),
    panUp: () => pan(0, PAN_STEP),
    panDown: () => pan(0, -PAN_STEP),
  });
}
