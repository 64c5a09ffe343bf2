/**
 * Where each camera's picture stands: like on the car, seen from above with the front on top.
 *
 * The place is read from the camera's name. Candidate arrangements that all keep the front on top and left beside
 * right are filled into the room that there is, and the one that shows the largest pictures wins. Cameras whose name
 * says nothing follow in a grid. Two cameras stand beside each other where that shows more of them.
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

const ROWS: Row[] = ["front", "side", "rear"];

/** The cameras as one goes round the car from its front to its rear, left before right; unknown ones come last. */
export function inCarOrder(cameras: readonly string[]): string[] {
  const rank = (camera: string) => {
    const place = placeOf(camera);
    return place ? ROWS.indexOf(place.row) * COLUMNS.length + COLUMNS.indexOf(place.column) : Number.POSITIVE_INFINITY;
  };
  const ranks = new Map(cameras.map((camera) => [camera, rank(camera)]));
  const of = (camera: string) => ranks.get(camera) as number;
  return [...cameras].sort((a, b) => (of(a) === of(b) ? 0 : of(a) - of(b)));
}

/** Two cameras below or beside each other. The left one stands on the left, whichever looks ahead. */
function arrangePair(cameras: readonly string[]): string[][][] {
  const [first, second] = inCarOrder(cameras) as [string, string];
  const [a, b] = [placeOf(first), placeOf(second)];
  const swapped = a && b && COLUMNS.indexOf(b.column) < COLUMNS.indexOf(a.column);
  return [[[first], [second]], [swapped ? [second, first] : [first, second]]];
}

/** Arrangements of the cameras in rows, all with the front on top and left beside right. */
export function arrangements(cameras: readonly string[]): string[][][] {
  if (cameras.length === 2) return arrangePair(cameras);
  const placed: { camera: string; place: Place }[] = [];
  const unknown: string[] = [];
  for (const camera of inCarOrder(cameras)) {
    const place = placeOf(camera);
    if (place) placed.push({ camera, place });
    else unknown.push(camera);
  }
  const rowsOf = (...wanted: ((place: Place) => boolean)[]) =>
    wanted.map((want) => inColumns(placed.filter((one) => want(one.place)))).filter((row) => row.length > 0);
  const front = (place: Place) => place.row === "front";
  const side = (place: Place) => place.row === "side";
  const rear = (place: Place) => place.row === "rear";
  const centre = (place: Place) => place.column === "centre";
  const bases = [
    // As the names say.
    rowsOf(front, side, rear),
    // The front camera alone on top, all that look to a side below it.
    rowsOf(
      (place) => front(place) && centre(place),
      (place) => front(place) && !centre(place),
      side,
      (place) => rear(place) && !centre(place),
      (place) => rear(place) && centre(place),
    ),
    // Left, front, right in one line; the rear below.
    rowsOf((place) => front(place) || side(place), rear),
  ];
  const [ahead, sides, behind] = [front, side, rear].map((want) => placed.filter((one) => want(one.place)));
  if (ahead?.length === 1 && behind?.length === 1 && sides?.length === 2) {
    // The usual rig of four, two by two.
    bases.push(rowsOf((place) => front(place) || rear(place), side));
  }
  if (unknown.length === 0) return bases;
  const grids: string[][][] = [];
  for (let columns = 1; columns <= unknown.length; columns += 1) {
    const grid: string[][] = [];
    for (let start = 0; start < unknown.length; start += columns) grid.push(unknown.slice(start, start + columns));
    grids.push(grid);
  }
  return bases.flatMap((base) => grids.map((grid) => [...base, ...grid]));
}

/**
 * Rows as large as the room allows: one common height, but for rows too wide for it; the slack goes to those above.
 *
 * No row is higher than the one above it: what is behind the car is never larger than what is ahead.
 */
function fill(rows: string[][], aspectOf: (camera: string) => number, room: Room): Tile[] {
  const free = room.height - room.gap * (rows.length - 1);
  let above = Number.POSITIVE_INFINITY;
  const caps = rows.map((row) => {
    const aspects = row.reduce((sum, camera) => sum + aspectOf(camera), 0);
    above = Math.min(above, (room.width - room.gap * (row.length - 1)) / aspects);
    return above;
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
