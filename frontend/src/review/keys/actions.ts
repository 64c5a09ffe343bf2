/** Who carries out an action: the part of the page that is about it says so for as long as it is there. */

import { useEffect, useRef } from "react";
import type { Action } from "./keyMap";

export type Handlers = Partial<Record<Action, () => void>>;

const stack: { current: Handlers }[] = [];

/** Carries out actions while the component is mounted. Of two that know an action, the one mounted last has it. */
export function useActions(handlers: Handlers): void {
  const latest = useRef(handlers);
  latest.current = handlers;
  useEffect(() => {
    stack.push(latest);
    return () => {
      stack.splice(stack.indexOf(latest), 1);
    };
  }, []);
}

/** Carries out an action; false if nobody does now. */
export function perform(action: Action): boolean {
  const handler = stack.findLast((one) => one.current[action])?.current[action];
  handler?.();
  return handler !== undefined;
}
