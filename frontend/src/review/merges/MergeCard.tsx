import { Alert, Button, Text, Tooltip } from "@mantine/core";
import { IconAlertTriangle, IconArrowBackUp, IconCheck, IconX } from "@tabler/icons-react";
import type { Merge } from "../../api/types";
import { metres, score, sentence } from "../../app/format";
import { text } from "../../strings";
import { Crop } from "../cameras/Crop";
import { identityColour } from "../cameras/palette";
import { Key } from "../keys/Key";
import { chance, shortChance } from "../queue/evidenceWords";
import { useObservationsAt } from "../useObservationsAt";
import classes from "./MergeCard.module.css";
import { bestFrame } from "./order";
import { type Decision, useRefusals } from "./useDecisions";

interface MergeCardProps {
  merge: Merge;
  open: boolean;
  onOpen: () => void;
  onDecide: (decision: Decision) => void;
  /** Of the panel (px): an open card's crops share it. */
  width: number;
}

const SMALL = { width: 84, height: 63 };
const PANEL_SPACE_PX = 56;

/** One claim that two tracks are one object: both looks side by side, the evidence, and the decision. */
export function MergeCard({ merge, open, onOpen, onDecide, width }: MergeCardProps) {
  const refusal = useRefusals((state) => state.byMerge[merge.id]);
  const large = Math.floor((width - PANEL_SPACE_PX) / 2);
  const size = open ? { width: large, height: Math.round(large * 0.64) } : SMALL;
  return (
    <article className={classes.card} data-open={open || undefined}>
      <button type="button" className={classes.face} onClick={onOpen} aria-expanded={open}>
        <Sides merge={merge} size={size} />
        {!open && (
          <span className={classes.summary}>
            <Side id={merge.identity_a} camera={merge.camera_a} />
            <Side id={merge.identity_b} camera={merge.camera_b} />
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
            <Decide merge={merge} onDecide={onDecide} />
          </div>
        </>
      )}
    </article>
  );
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

function Side({ id, camera }: { id: number; camera: string }) {
  return (
    <span className={classes.side}>
      <span className={classes.swatch} style={{ background: identityColour(id) }} />
      <span className={classes.camera}>{camera}</span>
    </span>
  );
}

function Sides({ merge, size }: { merge: Merge; size: { width: number; height: number } }) {
  const frame = bestFrame(merge);
  const observations = useObservationsAt(frame);
  const sides = [
    { key: "a", track: merge.track_a, camera: merge.camera_a, identity: merge.identity_a },
    { key: "b", track: merge.track_b, camera: merge.camera_b, identity: merge.identity_b },
  ];
  const small = size.width === SMALL.width;
  return (
    <span className={classes.sides}>
      {sides.map(({ key, track, camera, identity }) => (
        <span key={key} className={classes.look} style={{ width: size.width }}>
          <Crop
            frame={frame ?? 0}
            camera={camera}
            box={
              frame === null ? null : observations && (observations.find((one) => one.track_id === track)?.box ?? null)
            }
            identityId={identity}
            width={size.width}
            height={size.height}
            emptyText={text.merges.noCrop}
            alt={`${camera}, ${text.merges.track(track)}`}
          />
          {!small && (
            <span className={classes.under}>
              <Side id={identity} camera={camera} />
              <span className={classes.quiet}>
                #{identity}
                {frame !== null && `, ${text.merges.atFrame(frame)}`}
              </span>
            </span>
          )}
        </span>
      ))}
    </span>
  );
}
