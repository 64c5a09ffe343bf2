import { useEffect, useState, useSyncExternalStore } from "react";
import type { Observation } from "../api/types";
import { useShared } from "./ReviewContext";

/** The observations of any frame, for crops; undefined while they load, empty if they cannot be had. */
export function useObservationsAt(frame: number | null): readonly Observation[] | undefined {
  const { observations } = useShared();
  const version = useSyncExternalStore(observations.subscribe, observations.currentVersion);
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
