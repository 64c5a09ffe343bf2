import type { Look } from "../../api/types";
import { useSize } from "../../app/useSize";
import { text } from "../../strings";
import { inCarOrder } from "../cameras/layout";
import { useShared } from "../ReviewContext";
import classes from "./HandoverStrip.module.css";
import { LookPicture, type Side } from "./LookPicture";
import { lanes } from "./strip";

const NAME_PX = 108;

interface HandoverStripProps {
  strip: readonly Look[];
  sideOf: (look: Look) => Side;
  onLook: (look: Look) => void;
}

/** One object through all cameras on one axis of time: front, left, rear. */
export function HandoverStrip({ strip, sideOf, onLook }: HandoverStripProps) {
  const { drive } = useShared();
  const [ref, { width }] = useSize<HTMLDivElement>();
  const cameras = inCarOrder(drive.camera_names);
  const thumb = width > 1400 ? 92 : 68;
  const shown = width > 0 ? lanes(strip, cameras, width - NAME_PX, thumb) : [];
  const first = strip[0]?.frame_index ?? 0;
  const last = strip.at(-1)?.frame_index ?? 0;
  return (
    <div ref={ref} className={classes.strip}>
      {shown.map((lane) => (
        <div key={lane.camera} className={classes.lane} style={{ height: Math.round(thumb * 0.75) }}>
          <span className={classes.camera} style={{ width: NAME_PX }}>
            {lane.camera}
          </span>
          <span className={classes.looks}>
            {lane.looks.map(({ look, left }) => (
              <button
                key={`${look.track_id}/${look.frame_index}`}
                type="button"
                className={classes.look}
                style={{ left, width: thumb }}
                aria-label={text.queue.lookAt(look.camera, look.frame_index)}
                title={text.queue.lookAt(look.camera, look.frame_index)}
                onClick={() => onLook(look)}
                data-side={sideOf(look)}
              >
                <LookPicture look={look} side={sideOf(look)} aspect={4 / 3} width={160} alt="" />
              </button>
            ))}
          </span>
        </div>
      ))}
      <div className={classes.axis} style={{ marginLeft: NAME_PX }} aria-hidden>
        <span>{text.queue.frame(first)}</span>
        <span>{text.queue.frame(last)}</span>
      </div>
    </div>
  );
}
