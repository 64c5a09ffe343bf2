/**
 * Where each camera's picture stands: like on the car, seen from above with the front on top.
 *
 * The place is read from the camera's name. Candidate arrangements that all keep front above rear and left beside
 * right are filled into the room that there is, and the one that shows the largest pictures wins. Cameras whose name
 * says nothing follow in a grid.
 */

export type Row = "front" | "side" | "rear";
export type Column = "left" | "centre" | "right";

export interface Place {
  row: Row;
  column: Column;
}

export interface Tile {
  camera: string;
  x: number;
  y: number;
  width: number;
  height: number;
}

interface Room {
  width: number;
  height: number;
  gap: number;
}

const WORDS: [RegExp, { row?: Row; column?: Column }][] = [
  [/^(front|forward|fwd)/, { row: "front" }],
  [/^(rear|back|backward|behind|aft)/, { row: "rear" }],
  [/^side/, { row: "side" }],
  [/^left/, { column: "left" }],
  [/^right/, { column: "right" }],
  [/^(cent(er|re)|middle|mid)/, { column: "centre" }],
];

/** The place that a camera's name tells, or null. `CAM_BACK_LEFT` -> rear, left; `left` -> side, left. */
export function placeOf(camera: string): Place | null {
  const words = camera
    .replace(/([a-z0-9])([A-Z])/g, "$1_$2")
    .toLowerCase()
    .split(/[^a-z]+/);
  let row: Row | undefined;
  let column: Column | undefined;
  for (const word of words) {
    let rest = word;
    // "frontleft" holds two words: take known words off the front for as long as there are any.
    for (let found = true; found && rest; ) {
      found = false;
      for (const [pattern, says] of WORDS) {
        const match = pattern.exec(rest);
        if (!match) continue;
        row ??= says.row;
        column ??= says.column;
        rest = rest.slice(match[0].length);
        found = true;
        break;
      }
    }
  }
  if (!row && !column) return null;
  if (!row) return column === "centre" ? { row: "front", column } : { row: "side", column: column as Column };
  return { row, column: column ?? "centre" };
}

const COLUMNS: Column[] = ["left", "centre", "right"];

function inColumns(cameras: { camera: string; place: Place }[]): string[] {
  return COLUMNS.flatMap((column) => cameras.filter((one) => one.place.column === column).map((one) => one.camera));
}

/** Arrangements of the cameras in rows, all true to the car. */
export function arrangements(cameras: readonly string[]): string[][][] {
  const placed: { camera: string; place: Place }[] = [];
  const unknown: string[] = [];
  for (const camera of cameras) {
    const place = placeOf(camera);
    if (place) placed.push({ camera, place });
    else unknown.push(camera);
  }
  const rowOf = (...wanted: ((place: Place) => boolean)[]) =>
    wanted.map((want) => inColumns(placed.filter((one) => want(one.place))));
  const centre = (place: Place) => place.column === "centre";
  const bases = [
    // As the names say.
    rowOf(
      (place) => place.row === "front",
      (place) => place.row === "side",
      (place) => place.row === "rear",
    ),
    // The front camera alone on top, all that look to a side below it.
    rowOf(
      (place) => place.row === "front" && centre(place),
      (place) => place.row === "front" && !centre(place),
      (place) => place.row === "side",
      (place) => place.row === "rear" && !centre(place),
      (place) => place.row === "rear" && centre(place),
    ),
    // Left, front, right in one line; the rear below.
    rowOf(
      (place) => place.row === "front" || place.row === "side",
      (place) => place.row === "rear",
    ),
  ].map((rows) => rows.filter((row) => row.length > 0));
  if (unknown.length === 0) return bases;
  const grids: string[][][] = [];
  for (let columns = 1; columns <= unknown.length; columns += 1) {
    const grid: string[][] = [];
    for (let start = 0; start < unknown.length; start += columns) grid.push(unknown.slice(start, start + columns));
    grids.push(grid);
  }
  return bases.flatMap((base) => grids.map((grid) => [...base, ...grid]));
}

/** Rows as large as the room allows: one common height, but for rows too wide for it; the slack goes to the others. */
function fill(rows: string[][], aspectOf: (camera: string) => number, room: Room): Tile[] {
  const free = room.height - room.gap * (rows.length - 1);
  const caps = rows.map((row) => {
    const aspects = row.reduce((sum, camera) => sum + aspectOf(camera), 0);
    return (room.width - room.gap * (row.length - 1)) / aspects;
  });
  // The height h with sum(min(h, cap)) = free, found by letting the rows with the smallest cap settle first.
  let left = free;
  let open = rows.length;
  let common = 0;
  for (const cap of [...caps].sort((a, b) => a - b)) {
    common = left / open;
    if (cap >= common) break;
    left -= cap;
    open -= 1;
    common = cap;
  }
  const heights = caps.map((cap) => Math.max(1, Math.min(cap, common)));
  const used = heights.reduce((sum, height) => sum + height, 0) + room.gap * (rows.length - 1);
  const tiles: Tile[] = [];
  let y = Math.max(0, (room.height - used) / 2);
  rows.forEach((row, index) => {
    const height = heights[index] as number;
    const widths = row.map((camera) => height * aspectOf(camera));
    const total = widths.reduce((sum, width) => sum + width, 0) + room.gap * (row.length - 1);
    let x = Math.max(0, (room.width - total) / 2);
    row.forEach((camera, place) => {
      const width = widths[place] as number;
      tiles.push({ camera, x, y, width, height });
      x += width + room.gap;
    });
    y += height + room.gap;
  });
  return tiles;
}

/** How much picture is seen. The root lets a small picture that grows count for more than a large one that grows. */
function worth(tiles: Tile[]): number {
  return tiles.reduce((sum, tile) => sum + Math.sqrt(tile.width * tile.height), 0);
}

/** Tiles of all cameras in a room of the given size (px), or of one enlarged camera with the others as a strip below. */
export function layoutCameras(
  cameras: readonly string[],
  aspectOf: (camera: string) => number,
  room: Room,
  enlarged: string | null = null,
): Tile[] {
  if (cameras.length === 0 || room.width <= 0 || room.height <= 0) return [];
  if (enlarged !== null && cameras.length > 1 && cameras.includes(enlarged)) {
    const others = cameras.filter((camera) => camera !== enlarged);
    const stripHeight = Math.max(80, room.height * 0.16);
    const top = fill([[enlarged]], aspectOf, { ...room, height: room.height - stripHeight - room.gap });
    const strip = fill([others], aspectOf, { ...room, height: stripHeight });
    return [...top, ...strip.map((tile) => ({ ...tile, y: tile.y + room.height - stripHeight }))];
  }
  let best: Tile[] = [];
  for (const rows of arrangements(cameras)) {
    const tiles = fill(rows, aspectOf, room);
    if (worth(tiles) > worth(best) * 1.001) best = tiles;
  }
  return best;
}
