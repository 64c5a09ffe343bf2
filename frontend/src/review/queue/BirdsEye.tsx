import type { ReactNode } from "react";
import type { MergeLooks, Way } from "../../api/types";
import { useSize } from "../../app/useSize";
import { text } from "../../strings";
import classes from "./BirdsEye.module.css";
import { barLength, corners, type Plane, type Point, type Pose, planeOf, poseAt, rowAt } from "./birdsEye";

const CAR: Pose = { x: 0, y: 0, yaw: 0 };
const OUTLINES = 14;
const BAR_PX = 90;

interface BirdsEyeProps {
  looks: MergeLooks;
  /** The frames of the moment that the pictures show. */
  frames: [number, number];
}

/** Both tracks' ways and 3D boxes from above, the recording car's heading up. */
export function BirdsEye({ looks, frames }: BirdsEyeProps) {
  const [ref, size] = useSize<HTMLDivElement>();
  const ways = looks.sides.map((side) => side.way);
  const known = ways.some((way) => way.frame_index.length > 0);
  return (
    <figure className={classes.plot}>
      <div ref={ref} className={classes.room}>
        {!known && <p className={classes.none}>{text.queue.noBoxes}</p>}
        {known && size.width > 0 && size.height > 0 && <Plot looks={looks} frames={frames} size={size} />}
      </div>
      <figcaption className={classes.caption}>
        {looks.frame === "city" ? text.queue.aboveCity : text.queue.aboveEgo}
      </figcaption>
    </figure>
  );
}

function Plot({ looks, frames, size }: BirdsEyeProps & { size: { width: number; height: number } }) {
  const [a, b] = looks.sides;
  const ego = poseAt(looks.ego, frames[0]) ?? CAR;
  const points = [a.way, b.way].flatMap((way) => placesOf(way));
  const car = looks.frame === "ego" || looks.ego.frame_index.length > 0 ? ego : null;
  // The car is shown where that does not shrink what matters.
  const shown = car && near(car, points) ? [...points, car] : points;
  const plane = planeOf(shown, ego, size);
  const metres = barLength(plane.perMetre, BAR_PX);
  return (
    <svg width={size.width} height={size.height} role="img" aria-label={text.queue.above}>
      <Rings plane={plane} car={car} size={size} />
      <Line plane={plane} way={looks.ego} className={classes.ego} />
      {car && <Car plane={plane} pose={car} />}
      <Track plane={plane} way={b.way} frame={frames[1]} side="b" />
      <Track plane={plane} way={a.way} frame={frames[0]} side="a" />
      <g className={classes.bar}>
        <line x1={10} x2={10 + metres * plane.perMetre} y1={size.height - 12} y2={size.height - 12} />
        <text x={10} y={size.height - 18}>
          {text.queue.metres(metres)}
        </text>
      </g>
    </svg>
  );
}

const FAR_M = 45;

function near(car: Pose, points: readonly Point[]): boolean {
  return points.some((point) => Math.hypot(point.x - car.x, point.y - car.y) < FAR_M);
}

function placesOf(way: Way): Point[] {
  return way.x_m.map((x, row) => ({ x, y: way.y_m[row] as number }));
}

interface TrackProps {
  plane: Plane;
  way: Way;
  frame: number;
  side: "a" | "b";
}

/** The way, some boxes along it, and the box of the moment. */
function Track({ plane, way, frame, side }: TrackProps) {
  const count = way.frame_index.length;
  if (count === 0) return null;
  const step = Math.max(1, Math.floor(count / OUTLINES));
  const now = rowAt(way, frame) ?? 0;
  const pose = (row: number): Pose => ({
    x: way.x_m[row] as number,
    y: way.y_m[row] as number,
    yaw: way.yaw_rad[row] as number,
  });
  const box = (row: number, className: string | undefined) => (
    <polygon
      key={row}
      className={className}
      points={corners(pose(row), way.length_m[row] ?? 0, way.width_m[row] ?? 0)
        .map((corner) => at(plane, corner))
        .join(" ")}
    />
  );
  const rows = Array.from({ length: count }, (_, row) => row).filter((row) => row % step === 0 && row !== now);
  const tag = plane.toPicture(pose(now).x, pose(now).y);
  return (
    <g className={classes.track} data-side={side}>
      {rows.map((row) => box(row, classes.outline))}
      <Line plane={plane} way={way} className={classes.line} />
      {box(now, classes.now)}
      <text className={classes.tag} x={tag.x} y={tag.y} dy="0.35em" textAnchor="middle">
        {text.queue.sides[side]}
      </text>
    </g>
  );
}

function Line({ plane, way, className }: { plane: Plane; way: Way; className: string | undefined }): ReactNode {
  if (way.x_m.length < 2) return null;
  return (
    <polyline
      className={className}
      points={placesOf(way)
        .map((place) => at(plane, place))
        .join(" ")}
    />
  );
}

/** Distances from the car, so that near and far are told at a glance. */
function Rings({
  plane,
  car,
  size,
}: {
  plane: Plane;
  car: Pose | null;
  size: { width: number; height: number };
}): ReactNode {
  if (!car) return null;
  const centre = plane.toPicture(car.x, car.y);
  const reach = Math.hypot(size.width, size.height) / plane.perMetre;
  return [10, 20, 40, 80]
    .filter((metres) => metres < reach)
    .map((metres) => (
      <circle key={metres} className={classes.ring} cx={centre.x} cy={centre.y} r={metres * plane.perMetre} />
    ));
}

function Car({ plane, pose }: { plane: Plane; pose: Pose }) {
  const centre = plane.toPicture(pose.x, pose.y);
  const degrees = (plane.turn(pose.yaw) * 180) / Math.PI;
  const long = Math.max(9, 2.3 * plane.perMetre);
  const wide = Math.max(5, 0.95 * plane.perMetre);
  return (
    <path
      className={classes.car}
      transform={`translate(${centre.x} ${centre.y}) rotate(${degrees})`}
      d={`M ${long} 0 L ${-long} ${wide} L ${-0.6 * long} 0 L ${-long} ${-wide} Z`}
    >
      <title>{text.queue.ownCar}</title>
    </path>
  );
}

function at(plane: Plane, place: Point): string {
  const { x, y } = plane.toPicture(place.x, place.y);
  return `${x.toFixed(1)},${y.toFixed(1)}`;
}
