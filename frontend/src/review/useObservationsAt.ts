import { useCallback, useEffect, useState, useSyncExternalStore } from "react";
import type { Observation } from "../api/types";
import { afterPaint } from "../app/afterPaint";
import { useShared } from "./ReviewContext";

/** The observations of any frame, for crops; undefined while they load, empty if they cannot be had. */
export function useObservationsAt(frame: number | null): readonly Observation[] | undefined {
  const { observations } = useShared();
  // What is large comes first: crops follow once the new labels are on the screen.
  const subscribe = useCallback(
    (listener: () => void) => observations.subscribe(() => afterPaint(listener)),
    [observations],
  );
  const version = useSyncExternalStore(subscribe, observations.currentVersion);
  const [state, setState] = useState<{ frame: number | null; list: readonly Observation[] }>();

  // biome-ignore lint/correctness/useExhaustiveDependencies: `version` says when to look again.
  useEffect(() => {
    if (frame === null) return;
    let stale = false;
    observations.ensureAlone(frame).then(
      (list) => {
        if (!stale) setState({ frame, list });
      },
      () => {
        if (!stale) setState({ frame, list: [] });
      },
    );
    return () => {
      stale = true;
    };
  }, [observations, frame, version]);

  if (frame === null) return undefined;
  return state?.frame === frame ? state.list : observations.get(frame);
}
