import { useCallback, useState } from "react";

/** State that outlives the page (sizes and choices of the layout), kept in this browser under `hindsight.<key>`. */
export function useStoredState<T extends number | boolean>(key: string, initial: T): [T, (value: T) => void] {
  const name = `hindsight.${key}`;
  const [value, setValue] = useState<T>(() => {
    try {
      const stored: unknown = JSON.parse(localStorage.getItem(name) ?? "null");
      return typeof stored === typeof initial ? (stored as T) : initial;
    } catch {
      return initial;
    }
  });
  const store = useCallback(
    (next: T) => {
      setValue(next);
      try {
        localStorage.setItem(name, JSON.stringify(next));
      } catch {
        // A browser that keeps nothing still has the value until the page is left.
      }
    },
    [name],
  );
  return [value, store];
}
