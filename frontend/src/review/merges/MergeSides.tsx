import { useQuery } from "@tanstack/react-query";
import { mergeLooksQuery } from "../../api/queries";
import type { Look, Merge, Observation } from "../../api/types";
import { clock, duration } from "../../app/format";
import { text } from "../../strings";
import { Crop } from "../cameras/Crop";
import { identityColour } from "../cameras/palette";
import { useShared } from "../ReviewContext";
import { useObservationsAt } from "../useObservationsAt";
import classes from "./MergeCard.module.css";
import { sharedFrame } from "./order";

interface Size {
  width: number;
  height: number;
}

interface SidesProps {
  merge: Merge;
  size: Size;
  /** Whether there is room for words under the pictures. */
  open: boolean;
}

/** What both tracks of a merge look like: at the moment that tells most, or where there is none, each at its best. */
export function MergeSides(props: SidesProps) {
  const frame = sharedFrame(props.merge);
  return frame === null ? <Apart {...props} /> : <Together {...props} frame={frame} />;
}

/** Both at the same moment. */
function Together({ merge, size, open, frame }: SidesProps & { frame: number }) {
  const observations = useObservationsAt(frame);
  const boxOf = (track: number) =>
    observations && (observations.find((one: Observation) => one.track_id === track)?.box ?? null);
  return (
    <span className={classes.sides}>
      {sidesOf(merge).map((side) => (
        <Picture
          key={side.track}
          side={side}
          size={size}
          frame={frame}
          box={boxOf(side.track)}
          under={open && text.merges.atFrame(frame)}
          first={open}
        />
      ))}
    </span>
  );
}

/** Never seen at once: each at its best, and where there is room for it, where the one ends and the other begins. */
function Apart({ merge, size, open }: SidesProps) {
  const { driveId, drive, frames } = useShared();
  const { data: looks, isError } = useQuery(mergeLooksQuery(driveId, merge.id, frames.whenFree));
  const sides = sidesOf(merge);
  const nearest = looks?.moments[0]?.looks;
  const times = nearest?.map((look) => drive.frame_times_ms[look.frame_index] ?? 0);
  const [a = 0, b = 0] = times ?? [];
  const row = (shown: readonly (Look | undefined)[] | undefined, height: number, under: (at: number) => string) => (
    <span className={classes.sides}>
      {sides.map((side, at) => {
        const look = shown?.[at];
        return (
          <Picture
            key={side.track}
            side={side}
            size={{ width: size.width, height }}
            frame={look?.frame_index ?? 0}
            box={look ? look.box : isError ? null : undefined}
            under={open && (look ? under(at) : "")}
            named={shown !== nearest}
            first={open}
          />
        );
      })}
    </span>
  );
  const best = looks?.sides.map((side) => side.best);
  const atBest = (at: number) => (best?.[at] ? text.merges.bestAt(best[at].frame_index) : "");
  if (!open) return row(best, size.height, atBest);
  const seenAt = (at: number) => {
    const time = clock((at === 0 ? a : b) - (drive.frame_times_ms[0] ?? 0));
    if (a === b) return time;
    return (at === 0) === a < b ? text.merges.lastSeen(time) : text.merges.firstSeen(time);
  };
  return (
    <span className={classes.apart}>
      {row(best, Math.round(size.width * 0.5), atBest)}
      <span className={classes.gap}>
        {nearest && (a === b ? text.queue.sameMoment : text.merges.gap(duration(Math.abs(b - a))))}
      </span>
      {row(nearest, Math.round(size.width * 0.4), seenAt)}
    </span>
  );
}

interface OneSide {
  track: number;
  camera: string;
  identity: number;
}

function sidesOf(merge: Merge): [OneSide, OneSide] {
  return [
    { track: merge.track_a, camera: merge.camera_a, identity: merge.identity_a },
    { track: merge.track_b, camera: merge.camera_b, identity: merge.identity_b },
  ];
}

interface PictureProps {
  side: OneSide;
  size: Size;
  frame: number;
  /** null: there is none; undefined: not known yet. */
  box: readonly number[] | null | undefined;
  /** What stands below the picture; nothing where it is false. */
  under: string | false;
  /** Whether camera and identity are said below it too. */
  named?: boolean;
  /** Whether it is fetched before others. */
  first: boolean;
}

function Picture({ side, size, frame, box, under, named = true, first }: PictureProps) {
  return (
    <span className={classes.look} style={{ width: size.width }}>
      <Crop
        frame={frame}
        camera={side.camera}
        box={box}
        identityId={side.identity}
        width={size.width}
        height={size.height}
        emptyText={text.merges.noCrop}
        alt={`${side.camera}, ${text.merges.track(side.track)}`}
        first={first}
      />
      {under !== false && (
        <span className={classes.under}>
          {named && <SideName id={side.identity} camera={side.camera} />}
          <span className={classes.quiet}>
            {named && `#${side.identity}`}
            {named && under && ", "}
            {under}
          </span>
        </span>
      )}
    </span>
  );
}

/** An identity by its colour, and the camera that sees it. */
export function SideName({ id, camera }: { id: number; camera: string }) {
  return (
    <span className={classes.side}>
      <span className={classes.swatch} style={{ background: identityColour(id) }} />
      <span className={classes.camera}>{camera}</span>
    </span>
  );
}
