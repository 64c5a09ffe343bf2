/** The frame nearest to `frame` in which one of the tracks is alive; null if there is no track. */
export function nearestFrame(
  tracks: readonly { first_frame: number; last_frame: number }[],
  frame: number,
): number | null {
  let best: number | null = null;
  for (const track of tracks) {
    const candidate = Math.min(Math.max(frame, track.first_frame), track.last_frame);
    if (best === null || Math.abs(candidate - frame) < Math.abs(best - frame)) best = candidate;
  }
  return best;
}
