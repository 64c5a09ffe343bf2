import { useEffect } from "react";
import { useReview, useShared } from "../ReviewContext";
import { PlaybackClock } from "./playback";

/** Moves the playhead while playing, never ahead of what is on the screen. */
export function usePlayback(): void {
  const { store, frames, drive } = useShared();
  const playing = useReview((state) => state.playing);
  const times = drive.frame_times_ms;

  useEffect(() => {
    if (!playing) return;
    const { frame, seek, speed } = store.getState();
    const clock = new PlaybackClock(times, speed);
    // Play at the end starts over.
    if (frame >= times.length - 1) seek(0);
    clock.start(store.getState().frame, performance.now());
    let expected = store.getState().frame;
    let request = requestAnimationFrame(function step(now) {
      const state = store.getState();
      clock.setSpeed(state.speed);
      if (state.frame !== expected) {
        // Someone moved the playhead: go on from there.
        expected = state.frame;
        clock.start(expected, now);
      }
      const shown = frames.committed()?.frame ?? null;
      // Nothing moves until the frame that playback starts from is on the screen.
      const next = shown === null ? null : clock.tick(now, shown);
      if (next === "end") {
        state.setPlaying(false);
        return;
      }
      if (next !== null) {
        expected = next;
        state.seek(next);
      }
      request = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(request);
  }, [playing, store, frames, times]);
}
