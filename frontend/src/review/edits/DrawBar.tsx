import { Button, Select } from "@mantine/core";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import { useReview, useShared } from "../ReviewContext";
import { classChoices } from "./classKeys";
import classes from "./DrawBar.module.css";
import { useBoxTool, useDrawing } from "./useBoxTool";
import { useEditActions } from "./useEditActions";

/** What drawing does now, above the pictures for as long as it is on. */
export function DrawBar() {
  const { drive } = useShared();
  const { on, className, set, setClass } = useDrawing();
  const identityIds = useReview((state) => state.identityIds);
  const { interpolate } = useEditActions();
  useBoxTool();
  if (!on) return null;
  const choices = classChoices(drive.class_names);
  return (
    <section className={classes.bar} aria-label={text.edits.drawing}>
      <span className={classes.words}>
        {identityIds.length === 1 ? text.edits.drawOf(identityIds[0] ?? 0) : text.edits.drawNew}
      </span>
      {identityIds.length !== 1 && (
        <Select
          size="xs"
          w={150}
          searchable={choices.length > 9}
          aria-label={text.edits.drawClass}
          allowDeselect={false}
          value={className ?? drive.class_names[0] ?? null}
          onChange={setClass}
          data={[...choices]}
        />
      )}
      {identityIds.length === 1 && (
        <Button
          size="compact-xs"
          variant="default"
          title={text.edits.interpolateHint}
          rightSection={<Key action="interpolate" />}
          onClick={() => void interpolate()}
        >
          {text.edits.interpolate}
        </Button>
      )}
      <Button size="compact-xs" variant="light" rightSection={<Key action="draw" />} onClick={() => set(false)}>
        {text.edits.drawEnd}
      </Button>
    </section>
  );
}
