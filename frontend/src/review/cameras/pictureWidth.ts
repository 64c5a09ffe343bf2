/** Steps of picture widths, so that a slightly wider window does not load everything anew. */
const WIDTHS = [480, 720, 960, 1280, 1600, 1920, 2560];
/** An original so much wider is taken as it is: the server sends it from disk, and would have to make a smaller one. */
const WORTH_SHRINKING = 1.5;

/** The width to ask for, for a tile of so many device pixels; undefined is the original. */
export function pictureWidth(devicePx: number, originalPx: number): number | undefined {
  const width = WIDTHS.find((step) => step >= devicePx * 0.92);
  return width === undefined || width * WORTH_SHRINKING > originalPx ? undefined : width;
}
