/** Loads and decodes pictures of the server. */

import { errorFromBody, trackedFetch } from "../../api/client";
import { imageUrl } from "../../api/imageUrl";
import type { Window } from "./cropWindow";
import { LeastRecentlyUsed } from "./lru";

const CROPS_KEPT = 300;
const CROPS_AT_ONCE = 2;

async function fetchPicture(url: string): Promise<Blob | null> {
  const response = await trackedFetch(url);
  if (response.status === 404) return null;
  if (!response.ok) throw errorFromBody(response.status, null);
  return response.blob();
}

/** The decoded picture of a camera in a frame, or null where the drive has none. Decoding happens off the main thread. */
export async function loadPicture(
  driveId: number,
  frame: number,
  camera: string,
  maxWidth?: number,
): Promise<ImageBitmap | null> {
  const blob = await fetchPicture(imageUrl(driveId, frame, camera, maxWidth));
  return blob && createImageBitmap(blob);
}

/** Cut-outs of original pictures, a few at a time: what is asked for at once in its order, the newest of that first. */
export class CropStore {
  /** Who waits for one that is dropped draws it before it is closed. */
  private readonly crops = new LeastRecentlyUsed<string, Promise<ImageBitmap | null>>(CROPS_KEPT, (crop) => {
    crop.then(
      (picture) => picture?.close(),
      () => undefined,
    );
  });
  private readonly first: (() => Promise<void>)[] = [];
  private readonly waiting: (() => Promise<void>)[][] = [];
  /** What is being asked for at once. */
  private together: (() => Promise<void>)[] | null = null;
  private running = 0;

  constructor(private readonly driveId: number) {}

  /** `first`: before all others. */
  get(frame: number, camera: string, window: Window, first = false): Promise<ImageBitmap | null> {
    const rect = [window.x, window.y, window.width, window.height].map(Math.round) as [number, number, number, number];
    const key = `${frame}/${camera}/${rect.join()}`;
    const known = this.crops.get(key);
    if (known) return known;
    const crop = new Promise<ImageBitmap | null>((resolve, reject) => {
      const job = async () => {
        try {
          const blob = await fetchPicture(imageUrl(this.driveId, frame, camera));
          resolve(blob && (await createImageBitmap(blob, ...rect)));
        } catch (cause) {
          reject(cause);
        }
      };
      if (first) this.first.push(job);
      else this.enqueue(job);
    });
    this.crops.set(key, crop);
    crop.catch(() => this.crops.clear());
    this.pump();
    return crop;
  }

  private enqueue(job: () => Promise<void>): void {
    if (this.together === null || this.waiting.at(-1) !== this.together) {
      this.together = [];
      this.waiting.push(this.together);
      queueMicrotask(() => {
        this.together = null;
      });
    }
    this.together.push(job);
  }

  private pump(): void {
    while (this.running < CROPS_AT_ONCE) {
      while (this.waiting.length > 0 && this.waiting.at(-1)?.length === 0) this.waiting.pop();
      const job = this.first.shift() ?? this.waiting.at(-1)?.shift();
      if (!job) return;
      this.running += 1;
      void job().finally(() => {
        this.running -= 1;
        this.pump();
      });
    }
  }
}
