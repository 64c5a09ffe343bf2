import { Button, Group, Kbd, Modal, Text, UnstyledButton } from "@mantine/core";
import { useEffect, useId, useState } from "react";
import { text } from "../../strings";
import { useBindings } from "./bindings";
import { chordOf, showChord } from "./chord";
import classes from "./KeyHelp.module.css";
import { type Action, conflictOf, KEY_GROUPS, KEY_MAP } from "./keyMap";

/** What is being changed: an action that waits for a key, or has been given one that another action has. */
interface Change {
  action: Action;
  chord: string | null;
}

/** The list of keys. Each can be changed: press its button, then the new key. */
export function KeyHelp({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  const { reset } = useBindings();
  const [change, setChange] = useState<Change | null>(null);
  const close = () => {
    setChange(null);
    onClose();
  };
  return (
    <Modal
      opened={opened}
      onClose={close}
      title={text.keys.title}
      size={1180}
      centered
      closeOnEscape={change === null}
      styles={{ title: { fontWeight: 620 } }}
    >
      <div className={classes.groups}>
        {KEY_GROUPS.map((group) => (
          <section key={group}>
            <h3 className={classes.heading}>{text.keys.groups[group]}</h3>
            <ul className={classes.list}>
              {KEY_MAP.filter((binding) => binding.group === group).map(({ action }) => (
                <Row key={action} action={action} change={change} onChange={setChange} />
              ))}
            </ul>
          </section>
        ))}
      </div>
      <Group justify="space-between" mt="md">
        <Text size="xs" c="var(--muted)">
          {text.keys.changeHint}
        </Text>
        <Button size="compact-xs" variant="subtle" color="gray" onClick={reset}>
          {text.keys.reset}
        </Button>
      </Group>
    </Modal>
  );
}

interface RowProps {
  action: Action;
  change: Change | null;
  onChange: (change: Change | null) => void;
}

function Row({ action, change, onChange }: RowProps) {
  const { bindings, set } = useBindings();
  const waiting = change?.action === action && change.chord === null;
  const taken = change?.action === action ? change.chord : null;

  useEffect(() => {
    if (!waiting) return;
    const onKeyDown = (event: KeyboardEvent) => {
      event.preventDefault();
      event.stopPropagation();
      const chord = chordOf(event);
      if (chord === null) return;
      if (chord === "Escape") onChange(null);
      else if (conflictOf(useBindings.getState().bindings, action, chord)) onChange({ action, chord });
      else {
        useBindings.getState().set(action, chord);
        onChange(null);
      }
    };
    window.addEventListener("keydown", onKeyDown, { capture: true });
    return () => window.removeEventListener("keydown", onKeyDown, { capture: true });
  }, [waiting, action, onChange]);

  const other = taken && conflictOf(bindings, action, taken);
  const [says, keys] = [useId(), useId()];
  return (
    <li className={classes.binding}>
      <span id={says} hidden>
        {text.keys.change(text.keys.actions[action])}
      </span>
      <UnstyledButton
        id={keys}
        className={classes.keys}
        aria-labelledby={`${says} ${keys}`}
        data-waiting={waiting || undefined}
        onClick={() => onChange(waiting ? null : { action, chord: null })}
      >
        {waiting ? (
          <span className={classes.press}>{text.keys.press}</span>
        ) : (
          bindings[action].map((chord) => (
            <Kbd key={chord} size="xs">
              {showChord(chord)}
            </Kbd>
          ))
        )}
      </UnstyledButton>
      <span>
        {text.keys.actions[action]}
        {taken && other && (
          <span className={classes.conflict} role="alert">
            {text.keys.taken(showChord(taken), text.keys.actions[other])}
            <Button
              size="compact-xs"
              variant="light"
              onClick={() => {
                set(action, taken);
                onChange(null);
              }}
            >
              {text.keys.take}
            </Button>
            <Button size="compact-xs" variant="subtle" color="gray" onClick={() => onChange(null)}>
              {text.app.cancel}
            </Button>
          </span>
        )}
      </span>
    </li>
  );
}
