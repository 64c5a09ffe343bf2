import { Alert, Button, Text, Tooltip } from "@mantine/core";
import { IconAlertTriangle, IconArrowBackUp, IconCheck, IconX } from "@tabler/icons-react";
import { memo } from "react";
import type { Merge } from "../../api/types";
import { metres, score, sentence } from "../../app/format";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import { chance, measures, shortChance } from "../queue/evidenceWords";
import classes from "./MergeCard.module.css";
import { MergeSides, SideName } from "./MergeSides";
import { sharedFrame } from "./order";
import { type Decision, useRefusals } from "./useDecisions";

interface MergeCardProps {
  merge: Merge;
  open: boolean;
  onOpen: (merge: Merge) => void;
  onDecide: (merge: Merge, decision: Decision) => void;
  /** Of the panel (px): an open card's crops share it. */
  width: number;
}

const SMALL = { width: 84, height: 63 };
const PANEL_SPACE_PX = 56;
const MOST_MEASURES = 3;
/** For one object, against it, or neither. */
const MARKS = { 1: "+ ", [-1]: "− ", 0: "" };

/** One claim that two tracks are one object: both looks side by side, the evidence, and the decision. */
export const MergeCard = memo(function MergeCard({ merge, open, onOpen, onDecide, width }: MergeCardProps) {
  const refusal = useRefusals((state) => state.byMerge[merge.id]);
  const large = Math.floor((width - PANEL_SPACE_PX) / 2);
  const size = open ? { width: large, height: Math.round(large * 0.64) } : SMALL;
  return (
    <article className={classes.card} data-open={open || undefined}>
      <button type="button" className={classes.face} onClick={() => onOpen(merge)} aria-expanded={open}>
        <MergeSides merge={merge} size={size} open={open} />
        {!open && (
          <span className={classes.summary}>
            <SideName id={merge.identity_a} camera={merge.camera_a} />
            <SideName id={merge.identity_b} camera={merge.camera_b} />
            <span className={classes.quiet}>
              {chance(merge).value} · {text.merges.labels(merge.label_count)}
            </span>
          </span>
        )}
      </button>
      {open && (
        <>
          <dl className={classes.evidence}>
            {merge.probability === null ? (
              <Fact name={text.merges.score} value={score(merge.score)} hint={text.merges.scoreHint} />
            ) : (
              <Fact name={text.merges.chance} value={shortChance(merge)} hint={text.merges.chanceHint} />
            )}
            {sharedFrame(merge) === null ? <ApartFacts merge={merge} /> : <TogetherFacts merge={merge} />}
          </dl>
          <Text size="sm">
            {sentence(merge.reason)}{" "}
            <Text span size="sm" c="var(--muted)">
              {text.merges.changesIfAccepted(merge.label_count)}
            </Text>
          </Text>
          {refusal && (
            <Alert
              role="alert"
              variant="outline"
              color="orange"
              p="xs"
              className={classes.refusal}
              icon={<IconAlertTriangle size={16} />}
              title={refusal.title}
            >
              {refusal.message}
            </Alert>
          )}
          <div className={classes.decide}>
            <Decide merge={merge} onDecide={(decision) => onDecide(merge, decision)} />
          </div>
        </>
      )}
    </article>
  );
});

/** What was measured of tracks that are seen at the same time. */
function TogetherFacts({ merge }: { merge: Merge }) {
  return (
    <>
      <Fact
        name={text.merges.agreeing}
        value={`${merge.agreeing_frames} / ${merge.shared_frames}`}
        hint={text.merges.agreeingHint}
      />
      <Fact name={text.merges.distance} value={metres(merge.mean_distance_m)} hint={text.merges.distanceHint} />
      <Fact
        name={text.merges.overlap}
        value={merge.mean_bev_iou == null ? text.merges.noEvidence : score(merge.mean_bev_iou)}
        hint={text.merges.overlapHint}
      />
    </>
  );
}

/** What says most of tracks that are never seen at the same time. */
function ApartFacts({ merge }: { merge: Merge }) {
  return measures(merge)
    .slice(0, MOST_MEASURES)
    .map(({ name, value, meaning, speaks }) => (
      <Fact key={name} name={`${MARKS[speaks]}${name.toLowerCase()}`} value={value} hint={meaning} />
    ));
}

function Decide({ merge, onDecide }: { merge: Merge; onDecide: (decision: Decision) => void }) {
  const proposed = merge.state === "proposed";
  return (
    <>
      {merge.state !== "accepted" && (
        <Button
          size="xs"
          px={10}
          leftSection={<IconCheck size={15} />}
          rightSection={<Key action="accept" />}
          onClick={() => onDecide("accept")}
          variant={proposed ? "filled" : "default"}
        >
          {text.merges.accept}
        </Button>
      )}
      {merge.state !== "rejected" && (
        <Button
          size="xs"
          px={10}
          leftSection={<IconX size={15} />}
          rightSection={<Key action="reject" />}
          onClick={() => onDecide("reject")}
          variant="default"
        >
          {text.merges.reject}
        </Button>
      )}
      {merge.decided_by === "person" && !proposed && (
        <Button
          size="xs"
          px={10}
          leftSection={<IconArrowBackUp size={15} />}
          rightSection={<Key action="undo" />}
          onClick={() => onDecide("undo")}
          variant="default"
        >
          {text.merges.undo}
        </Button>
      )}
      {!proposed && (
        <span className={classes.quiet}>
          {merge.decided_by === "person" ? text.merges.byPerson : text.merges.byMachine}
        </span>
      )}
    </>
  );
}

function Fact({ name, value, hint }: { name: string; value: string; hint: string }) {
  return (
    <Tooltip label={hint} multiline maw={260} openDelay={300}>
      <div className={classes.fact}>
        <dt>{name}</dt>
        <dd>{value}</dd>
      </div>
    </Tooltip>
  );
}
