import { useEffect, useState } from "react";
import type { Observation } from "../api/types";
import { useCommitted, useShared } from "./ReviewContext";

/** The observations of any frame, for crops; undefined while they load, empty if they cannot be had. */
export function useObservationsAt(frame: number | null): readonly Observation[] | undefined {
  const { observations } = useShared();
  // New labels arrive with a commit: look again then.
  const committed = useCommitted()?.observations;
  const [state, setState] = useState<{ frame: number | null; list: readonly Observation[] }>();

  // biome-ignore lint/correctness/useExhaustiveDependencies: `committed` says when to look again.
  useEffect(() => {
    if (frame === null) return;
    let stale = false;
    observations.ensure(frame).then(
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
  }, [observations, frame, committed]);

  if (frame === null) return undefined;
  return state?.frame === frame ? state.list : observations.get(frame);
}
