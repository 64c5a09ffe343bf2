import type { Merge, Track } from "../../api/types";

export interface Segment {
  trackId: number;
  identityId: number;
  camera: string;
  /** Start and length as parts of the whole drive, 0 to 1. A track of one frame has the length of a frame. */
  start: number;
  length: number;
}

/** When each camera sees the given identities. */
export function segmentsOf(tracks: readonly Track[], identityIds: readonly number[], frameCount: number): Segment[] {
  return tracks
    .filter((track) => identityIds.includes(track.identity_id))
    .map((track) => ({
      trackId: track.id,
      identityId: track.identity_id,
      camera: track.camera,
      start: track.first_frame / frameCount,
      length: (track.last_frame - track.first_frame + 1) / frameCount,
    }));
}

/** The frames that speak most for a merge. */
export function evidenceFrames(merge: Merge | undefined): number[] {
  return merge ? merge.best_frames.map((one) => one.frame_index).sort((a, b) => a - b) : [];
}

/** The frame under a point of the lanes; `part` is 0 at their left and 1 at their right end. */
export function frameAt(part: number, frameCount: number): number {
  return Math.max(0, Math.min(frameCount - 1, Math.floor(part * frameCount)));
}
