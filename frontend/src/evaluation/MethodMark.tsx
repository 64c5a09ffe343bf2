import classes from "./EvaluationPage.module.css";
import type { Method } from "./figures";

const RADIUS = 4.5;

/** The sign of a method, at a place in a drawing: told apart by shape as well as by colour. */
export function MarkShape({ method, x, y }: { method: Method; x: number; y: number }) {
  if (method === "without-tracking") return <circle cx={x} cy={y} r={RADIUS} className={classes.mark} />;
  if (method === "single-camera") {
    return <rect x={x - 4} y={y - 4} width={8} height={8} rx={1} className={classes.mark} />;
  }
  return <path d={`M${x} ${y - 6}l6 6l-6 6l-6-6z`} className={classes.mark} />;
}

/** The same sign beside words. */
export function MethodMark({ method }: { method: Method }) {
  return (
    <svg width={14} height={14} className={classes.series} data-method={method} aria-hidden>
      <MarkShape method={method} x={7} y={7} />
    </svg>
  );
}
