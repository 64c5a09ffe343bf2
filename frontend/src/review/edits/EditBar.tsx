import { Button, Menu, Textarea, Tooltip } from "@mantine/core";
import {
  IconArrowsExchange,
  IconArrowsJoin,
  IconArrowsSplit2,
  IconCheck,
  IconEyeOff,
  IconMessage,
  IconPencil,
  IconTag,
  IconTrash,
} from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { type ReactNode, useEffect, useRef, useState } from "react";
import { identitiesQuery, tracksQuery } from "../../api/queries";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import type { Action } from "../keys/keyMap";
import { useReview, useShared } from "../ReviewContext";
import { classChoices, keyedClasses } from "./classKeys";
import classes from "./EditBar.module.css";
import { useDrawing } from "./useBoxTool";
import { useCommenting } from "./useCommenting";
import { splittable, useEditActions } from "./useEditActions";

/** What can be done with the selected objects, one or many. */
export function EditBar() {
  const { driveId, drive } = useShared();
  const identityIds = useReview((state) => state.identityIds);
  const frame = useReview((state) => state.frame);
  const identities = useQuery(identitiesQuery(driveId)).data ?? [];
  const tracks = useQuery(tracksQuery(driveId)).data ?? [];
  const actions = useEditActions();
  const drawing = useDrawing((state) => state.on);
  const commenting = useCommenting((state) => state.open);
  const selected = identities.filter((one) => identityIds.includes(one.id));
  const all = (mark: string) => selected.length > 0 && selected.every((one) => one.mark === mark);
  const canSplit = splittable(tracks, identityIds, frame).length > 0;
  const keyed = keyedClasses(drive.class_names);

  return (
    <section className={classes.bar} aria-label={text.edits.bar}>
      {identityIds.length > 1 && <p className={classes.count}>{text.edits.selected(identityIds.length)}</p>}
      <div className={classes.buttons}>
        <Menu position="bottom-start" shadow="md">
          <Menu.Target>
            <Button
              size="compact-xs"
              variant="default"
              leftSection={<IconTag size={14} />}
              rightSection={<kbd>1–9</kbd>}
            >
              {text.edits.class}
            </Button>
          </Menu.Target>
          <Menu.Dropdown className={classes.menu}>
            {classChoices(drive.class_names).map((name) => (
              <Menu.Item
                key={name}
                onClick={() => actions.setClass(name)}
                rightSection={keyed.includes(name) ? <kbd>{keyed.indexOf(name) + 1}</kbd> : undefined}
              >
                {name}
              </Menu.Item>
            ))}
          </Menu.Dropdown>
        </Menu>
        <EditButton
          action="split"
          icon={<IconArrowsSplit2 size={14} />}
          hint={canSplit ? text.edits.splitHint(frame + 1) : text.edits.nothingToSplit}
          disabled={!canSplit}
          onClick={actions.split}
        />
        <EditButton
          action="join"
          icon={<IconArrowsJoin size={14} />}
          hint={text.edits.joinHint}
          disabled={identityIds.length < 2}
          onClick={actions.join}
        />
        <EditButton
          action="swap"
          icon={<IconArrowsExchange size={14} />}
          hint={text.edits.swapHint(frame + 1)}
          disabled={identityIds.length !== 2}
          onClick={actions.swap}
        />
        <EditButton
          action="draw"
          icon={<IconPencil size={14} />}
          hint={text.edits.drawHint}
          pressed={drawing}
          onClick={actions.toggleDrawing}
        />
        <EditButton
          action="markReviewed"
          icon={<IconCheck size={14} />}
          hint={text.edits.reviewedHint}
          pressed={all("reviewed")}
          onClick={() => actions.mark(all("reviewed") ? "open" : "reviewed")}
        />
        <EditButton
          action="markIgnored"
          icon={<IconEyeOff size={14} />}
          hint={text.edits.ignoredHint}
          pressed={all("ignored")}
          onClick={() => actions.mark(all("ignored") ? "open" : "ignored")}
        />
        <EditButton
          action="comment"
          icon={<IconMessage size={14} />}
          hint={text.edits.commentHint}
          pressed={commenting}
          onClick={() => useCommenting.getState().set(!commenting)}
        />
        <Menu position="bottom-end" shadow="md">
          <Menu.Target>
            <Button size="compact-xs" variant="default" leftSection={<IconTrash size={14} />}>
              {text.edits.delete}
            </Button>
          </Menu.Target>
          <Menu.Dropdown>
            <Menu.Item rightSection={<Key action="deleteBox" />} onClick={actions.deleteBoxesHere}>
              {text.edits.deleteBox}
            </Menu.Item>
            <Menu.Item onClick={actions.deleteTracksHere}>{text.edits.deleteTrack}</Menu.Item>
            <Menu.Item
              rightSection={<Key action="deleteObject" />}
              color="var(--danger, red)"
              onClick={actions.deleteObjects}
            >
              {text.edits.deleteObject(identityIds.length)}
            </Menu.Item>
          </Menu.Dropdown>
        </Menu>
      </div>
      {commenting && <CommentForm onSave={actions.comment} />}
    </section>
  );
}

interface EditButtonProps {
  action: Extract<Action, "split" | "join" | "swap" | "draw" | "markReviewed" | "markIgnored" | "comment">;
  icon: ReactNode;
  hint: string;
  disabled?: boolean;
  pressed?: boolean;
  onClick: () => void;
}

function EditButton({ action, icon, hint, disabled = false, pressed, onClick }: EditButtonProps) {
  return (
    <Tooltip label={hint} openDelay={400} multiline maw={280}>
      <Button
        size="compact-xs"
        variant={pressed ? "light" : "default"}
        aria-pressed={pressed}
        leftSection={icon}
        rightSection={<Key action={action} />}
        data-disabled={disabled || undefined}
        aria-disabled={disabled || undefined}
        onClick={onClick}
      >
        {text.edits.buttons[action]}
      </Button>
    </Tooltip>
  );
}

function CommentForm({ onSave }: { onSave: (words: string) => Promise<boolean> }) {
  const [words, setWords] = useState("");
  const field = useRef<HTMLTextAreaElement>(null);
  const close = () => useCommenting.getState().set(false);
  const save = async () => {
    if (words.trim() && (await onSave(words.trim()))) close();
  };
  useEffect(() => field.current?.focus(), []);
  return (
    <form
      className={classes.comment}
      onSubmit={(event) => {
        event.preventDefault();
        void save();
      }}
    >
      <Textarea
        ref={field}
        size="xs"
        autosize
        minRows={2}
        maxRows={6}
        maxLength={4000}
        aria-label={text.edits.commentLabel}
        placeholder={text.edits.commentPlaceholder}
        value={words}
        onChange={(event) => setWords(event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key === "Escape") close();
          if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) void save();
        }}
      />
      <div className={classes.commentButtons}>
        <Button size="compact-xs" variant="subtle" color="gray" onClick={close}>
          {text.app.cancel}
        </Button>
        <Button size="compact-xs" type="submit" disabled={!words.trim()}>
          {text.edits.commentSave}
        </Button>
      </div>
    </form>
  );
}
