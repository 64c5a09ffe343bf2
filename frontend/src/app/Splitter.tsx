import { useRef } from "react";
import classes from "./Splitter.module.css";

interface SplitterProps {
  /** "vertical" is a vertical line that changes a width. */
  orientation: "vertical" | "horizontal";
  label: string;
  /** Size of the part right of or below the line (px). */
  size: number;
  min: number;
  max: number;
  onChange: (size: number) => void;
}

const KEY_STEP_PX = 24;

/** A line between two parts that can be dragged, or moved with the arrow keys. */
export function Splitter({ orientation, label, size, min, max, onChange }: SplitterProps) {
  const start = useRef<{ pointer: number; size: number } | null>(null);
  const vertical = orientation === "vertical";
  const set = (next: number) => onChange(Math.round(Math.min(max, Math.max(min, next))));
  return (
    // biome-ignore lint/a11y/useSemanticElements: a separator that moves is a widget; <hr> is not one.
    <div
      className={classes.splitter}
      data-orientation={orientation}
      role="separator"
      tabIndex={0}
      aria-label={label}
      aria-orientation={orientation}
      aria-valuenow={size}
      aria-valuemin={min}
      aria-valuemax={max}
      onPointerDown={(event) => {
        event.currentTarget.setPointerCapture(event.pointerId);
        start.current = { pointer: vertical ? event.clientX : event.clientY, size };
      }}
      onPointerMove={(event) => {
        if (!start.current) return;
        set(start.current.size + start.current.pointer - (vertical ? event.clientX : event.clientY));
      }}
      onPointerUp={() => {
        start.current = null;
      }}
      onPointerCancel={() => {
        start.current = null;
      }}
      onKeyDown={(event) => {
        const grow = vertical ? "ArrowLeft" : "ArrowUp";
        const shrink = vertical ? "ArrowRight" : "ArrowDown";
        if (event.key === grow) set(size + KEY_STEP_PX);
        else if (event.key === shrink) set(size - KEY_STEP_PX);
        else return;
        event.preventDefault();
      }}
    />
  );
}
