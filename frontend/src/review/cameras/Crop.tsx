import { useEffect, useRef, useState } from "react";
import { useShared } from "../ReviewContext";
import classes from "./Crop.module.css";
import { cropWindow } from "./cropWindow";
import { identityColour } from "./palette";

interface CropProps {
  frame: number;
  camera: string;
  /** null: there is no box to cut out; `emptyText` says why. undefined: not known yet. */
  box: readonly number[] | null | undefined;
  identityId: number;
  width: number;
  height: number;
  emptyText: string;
  alt: string;
  /** Fetched before others. */
  first?: boolean;
}

/** A box cut out of its original picture, with some surroundings. */
export function Crop({ frame, camera, box, identityId, width, height, emptyText, alt, first }: CropProps) {
  const { crops, drive } = useShared();
  const canvas = useRef<HTMLCanvasElement>(null);
  const [failed, setFailed] = useState(false);
  const source = drive.cameras.find((one) => one.name === camera);
  const [x1, y1, x2, y2] = box ?? [];

  useEffect(() => {
    if (x1 === undefined || y1 === undefined || x2 === undefined || y2 === undefined || !source) return;
    let stale = false;
    setFailed(false);
    const window_ = cropWindow([x1, y1, x2, y2], { width: source.width_px, height: source.height_px }, width / height);
    crops.get(frame, camera, window_, first).then(
      (picture) => {
        const ctx = canvas.current?.getContext("2d");
        if (stale || !ctx || !canvas.current) return;
        if (!picture) {
          setFailed(true);
          return;
        }
        const ratio = window.devicePixelRatio;
        canvas.current.width = Math.round(width * ratio);
        canvas.current.height = Math.round(height * ratio);
        ctx.scale(ratio, ratio);
        ctx.imageSmoothingQuality = "high";
        ctx.drawImage(picture, 0, 0, width, height);
        const scale = width / window_.width;
        ctx.strokeStyle = identityColour(identityId);
        ctx.lineWidth = 2;
        ctx.strokeRect((x1 - window_.x) * scale, (y1 - window_.y) * scale, (x2 - x1) * scale, (y2 - y1) * scale);
      },
      () => {
        if (!stale) setFailed(true);
      },
    );
    return () => {
      stale = true;
    };
  }, [crops, source, frame, camera, x1, y1, x2, y2, identityId, width, height, first]);

  return (
    <div className={classes.crop} style={{ width, height }}>
      {box && !failed ? (
        <canvas ref={canvas} style={{ width, height }} role="img" aria-label={alt} />
      ) : (
        box !== undefined && <span className={classes.empty}>{emptyText}</span>
      )}
    </div>
  );
}
