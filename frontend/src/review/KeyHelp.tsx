import { Kbd, Modal } from "@mantine/core";
import { text } from "../strings";
import classes from "./KeyHelp.module.css";
import { KEY_MAP, type KeyBinding } from "./keyMap";

const GROUPS: KeyBinding["group"][] = ["move", "decide", "view"];

/** The list of keys. */
export function KeyHelp({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  return (
    <Modal opened={opened} onClose={onClose} title={text.keys.title} size={760} centered>
      <div className={classes.groups}>
        {GROUPS.map((group) => (
          <section key={group}>
            <h3 className={classes.heading}>{text.keys.groups[group]}</h3>
            <dl className={classes.list}>
              {KEY_MAP.filter((binding) => binding.group === group).map((binding) => (
                <div key={binding.action} className={classes.binding}>
                  <dt>
                    {binding.shown.map((key) => (
                      <Kbd key={key} size="xs">
                        {key}
                      </Kbd>
                    ))}
                  </dt>
                  <dd>{text.keys.actions[binding.action]}</dd>
                </div>
              ))}
            </dl>
          </section>
        ))}
      </div>
    </Modal>
  );
}
