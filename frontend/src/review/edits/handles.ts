/** Handles of a box: what is under the pointer, and what dragging it makes of the box. Px of the original picture. */

export type Box = readonly [number, number, number, number];

/** Which sides a drag moves: a corner two of them, a side one, the inside all four. */
export interface Grip {
  left: boolean;
  top: boolean;
  right: boolean;
  bottom: boolean;
}

export const MOVE: Grip = { left: true, top: true, right: true, bottom: true };
const SMALLEST_PX = 2;

/** The grip under a point; null outside of the box. `near` is how far beside a line still counts. */
export function gripAt([x1, y1, x2, y2]: Box, x: number, y: number, near: number): Grip | null {
  if (x < x1 - near || x > x2 + near || y < y1 - near || y > y2 + near) return null;
  // On a small box the sides are what one wants to reach, but each of them.
  const reachX = Math.min(near, (x2 - x1) / 3);
  const reachY = Math.min(near, (y2 - y1) / 3);
  const grip = { left: x < x1 + reachX, top: y < y1 + reachY, right: x > x2 - reachX, bottom: y > y2 - reachY };
  return Object.values(grip).some(Boolean) ? grip : MOVE;
}

/** The box after its grip was dragged; a side that goes beyond the other one changes places with it. */
export function drag(box: Box, grip: Grip, dx: number, dy: number): Box {
  const [x1, y1, x2, y2] = box;
  return ordered([
    x1 + (grip.left ? dx : 0),
    y1 + (grip.top ? dy : 0),
    x2 + (grip.right ? dx : 0),
    y2 + (grip.bottom ? dy : 0),
  ]);
}

/** Left before right, top before bottom. */
export function ordered([x1, y1, x2, y2]: Box): Box {
  return [Math.min(x1, x2), Math.min(y1, y2), Math.max(x1, x2), Math.max(y1, y2)];
}

/** The part of a box inside a picture; null where it is too small to be one. */
export function insidePicture([x1, y1, x2, y2]: Box, width: number, height: number): Box | null {
  const clamp = (value: number, most: number) => Math.min(most, Math.max(0, value));
  const box: Box = [clamp(x1, width), clamp(y1, height), clamp(x2, width), clamp(y2, height)];
  return box[2] - box[0] >= SMALLEST_PX && box[3] - box[1] >= SMALLEST_PX ? box : null;
}

export function cursorOf(grip: Grip): string {
  if (grip.left && grip.right) return "move";
  if ((grip.left && grip.top) || (grip.right && grip.bottom)) return "nwse-resize";
  if ((grip.left && grip.bottom) || (grip.right && grip.top)) return "nesw-resize";
  return grip.left || grip.right ? "ew-resize" : "ns-resize";
}

/** The eight points that are drawn: corners, and middles of sides. */
export function handlePoints([x1, y1, x2, y2]: Box): [number, number][] {
  const mx = (x1 + x2) / 2;
  const my = (y1 + y2) / 2;
  return [
    [x1, y1],
    [mx, y1],
    [x2, y1],
    [x2, my],
    [x2, y2],
    [mx, y2],
    [x1, y2],
    [x1, my],
  ];
}
