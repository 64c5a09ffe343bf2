import { ActionIcon, Button, NumberInput, Popover, Select, TextInput } from "@mantine/core";
import { IconFilter, IconSearch, IconStar, IconTrash, IconX } from "@tabler/icons-react";
import { useState } from "react";
import { typedNumber } from "../../app/typedNumber";
import { text } from "../../strings";
import { useReview, useShared } from "../ReviewContext";
import classes from "./FilterBar.module.css";
import { type IdentityFilter, NO_FILTER, partsOf, readFilter, writeFilter } from "./filter";
import { useSavedFilters } from "./savedFilters";

const words = text.find;
/** Of what goes from 0 to 1. */
const SHARE = { max: 1, step: 0.05, decimals: 2 };

/** What is looked for: free text, the parts of the filter, and filters that were kept. */
export function FilterBar({ classNames }: { classNames: readonly string[] }) {
  const { store } = useShared();
  const filter = useReview((state) => state.filter);
  const change = (part: Partial<IdentityFilter>) => store.getState().setFilter({ ...filter, ...part });
  const parts = partsOf({ ...filter, text: "" });
  return (
    <div className={classes.bar}>
      <TextInput
        size="xs"
        className={classes.text}
        aria-label={words.text}
        placeholder={words.textHint}
        leftSection={<IconSearch size={14} />}
        value={filter.text}
        onChange={(event) => change({ text: event.currentTarget.value })}
        rightSection={
          partsOf(filter) > 0 && (
            <ActionIcon
              size="sm"
              variant="subtle"
              color="gray"
              aria-label={words.clear}
              onClick={() => store.getState().setFilter(NO_FILTER)}
            >
              <IconX size={14} />
            </ActionIcon>
          )
        }
      />
      <Popover width={360} position="bottom-end" shadow="md" trapFocus>
        <Popover.Target>
          <Button size="xs" variant={parts > 0 ? "light" : "default"} leftSection={<IconFilter size={14} />}>
            {parts > 0 ? words.filterOf(parts) : words.filter}
          </Button>
        </Popover.Target>
        <Popover.Dropdown aria-label={words.filter}>
          <Parts filter={filter} change={change} classNames={classNames} />
          <Saved filter={filter} onChoose={(written) => store.getState().setFilter(readFilter(written))} />
        </Popover.Dropdown>
      </Popover>
    </div>
  );
}

interface PartsProps {
  filter: IdentityFilter;
  change: (part: Partial<IdentityFilter>) => void;
  classNames: readonly string[];
}

function Parts({ filter, change, classNames }: PartsProps) {
  const { drive } = useShared();
  return (
    <div className={classes.parts}>
      <Choice
        label={text.identities.filterLabel}
        placeholder={text.identities.classFilter}
        value={filter.className}
        choices={named(classNames)}
        onChange={(className) => change({ className })}
      />
      <Choice
        label={words.camera}
        value={filter.camera}
        choices={named(drive.camera_names)}
        onChange={(camera) => change({ camera })}
      />
      <Range
        label={words.score}
        least={filter.minScore}
        most={filter.maxScore}
        {...SHARE}
        onChange={(minScore, maxScore) => change({ minScore, maxScore })}
      />
      <Range
        label={words.distance}
        least={filter.minDistance}
        most={filter.maxDistance}
        step={5}
        onChange={(minDistance, maxDistance) => change({ minDistance, maxDistance })}
      />
      <Range
        label={words.length}
        least={filter.minLength}
        most={filter.maxLength}
        step={5}
        onChange={(minLength, maxLength) => change({ minLength, maxLength })}
      />
      <Range
        label={words.purity}
        hint={words.purityHint}
        least={filter.minPurity}
        most={filter.maxPurity}
        {...SHARE}
        onChange={(minPurity, maxPurity) => change({ minPurity, maxPurity })}
      />
      <Choice
        label={words.provenance}
        value={filter.provenance}
        choices={words.provenances}
        onChange={(provenance) => change({ provenance })}
      />
      <Choice
        label={words.reviewed}
        value={filter.reviewed}
        choices={words.reviewedChoices}
        onChange={(reviewed) => change({ reviewed })}
      />
      <Choice
        label={words.fails}
        placeholder={words.anyOrNone}
        value={filter.fails}
        choices={{ any: words.failsAny, ...text.summary.checks }}
        onChange={(fails) => change({ fails })}
      />
    </div>
  );
}

interface ChoiceProps<V extends string> {
  label: string;
  /** What stands there while nothing is chosen. */
  placeholder?: string;
  value: V | null;
  /** What each is called, in their order. */
  choices: Readonly<Record<V, string>>;
  onChange: (value: V | null) => void;
}

function Choice<V extends string>({ label, placeholder = words.any, value, choices, onChange }: ChoiceProps<V>) {
  return (
    <Select
      size="xs"
      clearable
      comboboxProps={{ withinPortal: false }}
      label={label}
      placeholder={placeholder}
      value={value}
      onChange={(chosen) => onChange(chosen as V | null)}
      data={Object.entries<string>(choices).map(([one, name]) => ({ value: one, label: name }))}
    />
  );
}

/** Choices that are called what they are. */
function named(names: readonly string[]): Record<string, string> {
  return Object.fromEntries(names.map((name) => [name, name]));
}

interface RangeProps {
  label: string;
  hint?: string;
  least: number | null;
  most: number | null;
  max?: number;
  step: number;
  decimals?: number;
  onChange: (least: number | null, most: number | null) => void;
}

function Range({ label, hint, least, most, max, step, decimals = 0, onChange }: RangeProps) {
  const shared = { size: "xs", min: 0, step, decimalScale: decimals, hideControls: true, ...(max && { max }) } as const;
  return (
    <fieldset className={classes.range}>
      <legend title={hint}>{label}</legend>
      <NumberInput
        {...shared}
        aria-label={words.least(label)}
        placeholder={words.from}
        value={least ?? ""}
        onChange={(value) => onChange(typedNumber(value), most)}
      />
      <NumberInput
        {...shared}
        aria-label={words.most(label)}
        placeholder={words.to}
        value={most ?? ""}
        onChange={(value) => onChange(least, typedNumber(value))}
      />
    </fieldset>
  );
}

function Saved({ filter, onChoose }: { filter: IdentityFilter; onChoose: (written: string) => void }) {
  const { saved, save, forget } = useSavedFilters();
  const [name, setName] = useState("");
  const written = writeFilter(filter);
  return (
    <div className={classes.saved}>
      <form
        className={classes.keep}
        onSubmit={(event) => {
          event.preventDefault();
          if (!name.trim() || !written) return;
          save({ name: name.trim(), filter: written });
          setName("");
        }}
      >
        <TextInput
          size="xs"
          aria-label={words.saveAs}
          placeholder={words.saveAs}
          value={name}
          onChange={(event) => setName(event.currentTarget.value)}
        />
        <Button
          type="submit"
          size="xs"
          variant="default"
          leftSection={<IconStar size={14} />}
          disabled={!name.trim() || !written}
        >
          {words.save}
        </Button>
      </form>
      {saved.map((one) => (
        <div key={one.name} className={classes.one}>
          <Button
            size="compact-xs"
            variant={one.filter === written ? "light" : "subtle"}
            justify="flex-start"
            onClick={() => onChoose(one.filter)}
          >
            {one.name}
          </Button>
          <ActionIcon
            size="sm"
            variant="subtle"
            color="gray"
            aria-label={words.forget(one.name)}
            onClick={() => forget(one.name)}
          >
            <IconTrash size={14} />
          </ActionIcon>
        </div>
      ))}
    </div>
  );
}
