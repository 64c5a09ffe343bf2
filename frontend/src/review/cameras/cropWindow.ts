export interface Window {
  x: number;
  y: number;
  width: number;
  height: number;
}

const MARGIN = 0.3;
const SMALLEST_PX = 40;

/**
 * The part of a picture to show around a box `[x1, y1, x2, y2]` (px): the box with some surroundings, in the aspect
 * (width / height) of the view, moved into the picture where it would stick out.
 */
export function cropWindow(box: readonly number[], picture: { width: number; height: number }, aspect: number): Window {
  const [x1 = 0, y1 = 0, x2 = 0, y2 = 0] = box;
  let width = Math.max((x2 - x1) * (1 + 2 * MARGIN), SMALLEST_PX);
  let height = Math.max((y2 - y1) * (1 + 2 * MARGIN), SMALLEST_PX / aspect);
  if (width / height < aspect) width = height * aspect;
  else height = width / aspect;
  const shrink = Math.min(1, picture.width / width, picture.height / height);
  width *= shrink;
  height *= shrink;
  const x = Math.min(Math.max((x1 + x2 - width) / 2, 0), picture.width - width);
  const y = Math.min(Math.max((y1 + y2 - height) / 2, 0), picture.height - height);
  return { x, y, width, height };
}
