import { Loader } from "@mantine/core";
import { useEffect, useMemo } from "react";
import { Notice } from "../../app/Notice";
import { useSize } from "../../app/useSize";
import { text } from "../../strings";
import { useCommitted, useReview, useShared } from "../ReviewContext";
import classes from "./CameraGrid.module.css";
import { CameraView } from "./CameraView";
import { layoutCameras } from "./layout";
import { pictureWidth } from "./pictures";

const GAP_PX = 6;
const DEFAULT_ASPECT = 16 / 9;

/** All cameras in step, laid out like the car. */
export function CameraGrid() {
  const { drive, store, frames, pictureWidths } = useShared();
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

  // Pictures are asked for as large as they are shown. A larger tile asks anew; a smaller one keeps what it has.
  useEffect(() => {
    if (tiles.length === 0) return;
    let grown = false;
    for (const tile of tiles) {
      const original = cameras.find((camera) => camera.name === tile.camera)?.width_px ?? 0;
      const wanted = pictureWidth(tile.width * window.devicePixelRatio, original);
      const known = pictureWidths.has(tile.camera) ? (pictureWidths.get(tile.camera) ?? original) : 0;
      if ((wanted ?? original) > known) {
        pictureWidths.set(tile.camera, wanted);
        grown = true;
      }
    }
    if (!grown) return;
    if (frames.committed()) frames.resize();
    else frames.request(store.getState().frame);
  }, [tiles, cameras, frames, pictureWidths, store]);

  return (
    <section className={classes.stage} ref={ref}>
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
                onEnlarge={cameras.length > 1 ? () => setEnlarged(enlarged === tile.camera ? null : tile.camera) : null}
              />
            )
          );
        })}
      {committed?.observationsFailed && (
        <div className={classes.failed} role="alert">
          <Notice title={text.cameras.observationsFailed} onRetry={() => frames.request(committed.frame)} />
        </div>
      )}
    </section>
  );
}
