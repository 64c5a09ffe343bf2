/**
 * Asks for what the page of a drive shows first, before the page's own code is here.
 *
 * In the build this module is a script of its own, ahead of the page's. What it asked for is handed, once, to who asks
 * for the same address within the next seconds; an answer that is older is nobody's.
 */

import { imageUrl } from "./api/imageUrl";
import type { DriveDetail } from "./api/types";
import { reviewedDrive } from "./app/driveAddress";
import { firstWidths } from "./review/cameras/firstWidths";

const KEPT_MS = 5_000;

const answers = new Map<string, Promise<Response>>();

/** The answer that is on its way already; undefined where there is none. */
export function takeEarly(input: RequestInfo | URL): Promise<Response> | undefined {
  if (answers.size === 0 || (input instanceof Request && input.method !== "GET")) return undefined;
  const { origin, pathname, search } = new URL(input instanceof Request ? input.url : input, window.location.href);
  if (origin !== window.location.origin) return undefined;
  const answer = answers.get(pathname + search);
  answers.delete(pathname + search);
  return answer;
}

function ask(address: string): Promise<Response> {
  const answer = fetch(address);
  answers.set(address, answer);
  answer.catch(() => undefined); // a failure is told by whoever needs it
  return answer;
}

async function askForFrame(driveId: number, frame: number): Promise<void> {
  const address = `/api/drives/${driveId}`;
  const asked = ask(address);
  ask(`${address}/observations?start=${frame}&stop=${frame + 1}`);
  const answer = await asked;
  if (!answer.ok) return;
  const drive: DriveDetail = await answer.clone().json();
  if (frame >= drive.frame_count) return;
  for (const [camera, width] of firstWidths(drive)) ask(imageUrl(driveId, frame, camera, width));
}

function begin({ pathname, search }: Location): void {
  const driveId = reviewedDrive(pathname);
  if (driveId === undefined) return;
  const frame = Number(/[?&]frame=(\d{1,9})(?:&|$)/.exec(search)?.[1] ?? 0);
  askForFrame(driveId, frame).catch(() => undefined);
  setTimeout(() => answers.clear(), KEPT_MS);
}

if (typeof window !== "undefined") begin(window.location); // unit tests have no window
