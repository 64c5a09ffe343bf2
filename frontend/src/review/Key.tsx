import { Kbd } from "@mantine/core";
import type { ReactNode } from "react";
import classes from "./Key.module.css";
import { type Action, keyOf } from "./keyMap";

/** The key of an action, as printed on the keyboard: beside the words of its button. */
export function Key({ action }: { action: Action }) {
  return (
    <Kbd size="xs" aria-hidden className={classes.key}>
      {keyOf(action)}
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
