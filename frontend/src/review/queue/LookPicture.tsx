import { useState } from "react";
import type { Look } from "../../api/types";
import { text } from "../../strings";
import { useShared } from "../ReviewContext";
import classes from "./LookPicture.module.css";
import { cutOut, type LookWidth } from "./look";

export type Side = "a" | "b" | "other";

interface LookPictureProps {
  look: Look;
  side: Side;
  aspect: number;
  width: LookWidth;
  alt: string;
}

/** A look at a track: cut out of its picture, its box in the colour of its side. */
export function LookPicture({ look, side, aspect, width, alt }: LookPictureProps) {
  const { drive } = useShared();
  const [failed, setFailed] = useState<string | null>(null);
  const part = cutOut(drive, look, aspect, width);
  return (
    <span className={classes.picture} style={{ aspectRatio: aspect }} data-side={side}>
      {part && failed !== part.url ? (
        <>
          <img src={part.url} alt={alt} decoding="sync" draggable={false} onError={() => setFailed(part.url)} />
          <span
            className={classes.box}
            style={{
              left: `${part.box.left}%`,
              top: `${part.box.top}%`,
              width: `${part.box.width}%`,
              height: `${part.box.height}%`,
            }}
          />
        </>
      ) : (
        <span className={classes.none}>{text.cameras.pictureFailed}</span>
      )}
    </span>
  );
}
