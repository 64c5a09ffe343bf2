import { Kbd } from "@mantine/core";
import type { ReactNode } from "react";
import { keyOf, useBindings } from "./bindings";
import classes from "./Key.module.css";
import type { Action } from "./keyMap";

/** The key of an action, as printed on the keyboard: beside the words of its button. */
export function Key({ action }: { action: Action }) {
  const shown = useBindings(({ bindings }) => keyOf(action, bindings));
  if (!shown) return null;
  return (
    <Kbd size="xs" aria-hidden className={classes.key}>
      {shown}
    </Kbd>
  );
}

/** What a tooltip says of a button without words: what it does, and its key. */
export function withKey(words: string, action: Action): ReactNode {
  return (
    <span className={classes.hint}>
      {words}
      <Key action={action} />
    </span>
  );
}
