import { Button } from "@mantine/core";
import { IconHandFinger } from "@tabler/icons-react";
import { useStoredState } from "../app/storedState";
import { text } from "../strings";
import classes from "./Coach.module.css";
import { Key } from "./keys/Key";
import type { Action } from "./keys/keyMap";

const FIRST_KEYS: readonly Action[] = ["nextMerge", "accept", "reject", "undo", "playPause", "help"];

/** The few keys and gestures that one begins with: one line, until it is no longer wanted. */
export function Coach() {
  const [done, setDone] = useStoredState("coachDone", false as boolean);
  if (done) return null;
  return (
    <div className={classes.coach} role="note" aria-label={text.coach.name}>
      <IconHandFinger size={16} aria-hidden />
      <strong>{text.coach.title}</strong>
      <ul className={classes.list}>
        {FIRST_KEYS.map((action) => (
          <li key={action}>
            <Key action={action} /> {text.coach.keys[action as keyof typeof text.coach.keys]}
          </li>
        ))}
        <li>{text.coach.pictures}</li>
        <li>{text.coach.lanes}</li>
      </ul>
      <Button size="compact-xs" variant="default" onClick={() => setDone(true)}>
        {text.coach.done}
      </Button>
    </div>
  );
}
