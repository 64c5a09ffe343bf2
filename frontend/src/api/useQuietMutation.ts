/** Mutations of which no part of the page shows that they run: nothing is made anew when they begin and end. */

import { type MutationOptions, useQueryClient } from "@tanstack/react-query";
import { useCallback, useRef } from "react";

/** As `useMutation(options).mutateAsync`, without the state. */
export function useQuietMutation<T, V>(options: MutationOptions<T, Error, V>): (variables: V) => Promise<T> {
  const client = useQueryClient();
  const latest = useRef(options);
  latest.current = options;
  return useCallback(
    (variables: V) =>
      client.getMutationCache().build(client, client.defaultMutationOptions(latest.current)).execute(variables),
    [client],
  );
}
