import { Alert, Button, Skeleton } from "@mantine/core";
import { IconAlertTriangle, IconArrowBackUp, IconCheck, IconHelp, IconPhoto, IconX } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { messageOf } from "../../api/client";
import { mergeLooksQuery } from "../../api/queries";
import type { Look, Merge, MergeLooks } from "../../api/types";
import { score, sentence } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { Key } from "../keys/Key";
import { useRefusals } from "../merges/useDecisions";
import { useShared } from "../ReviewContext";
import { BirdsEye } from "./BirdsEye";
import { Evidence } from "./Evidence";
import { HandoverStrip } from "./HandoverStrip";
import { LookPicture, type Side } from "./LookPicture";
import classes from "./MergeDetail.module.css";
import { PICTURE_ASPECT, useQueueActions } from "./useQueue";

/** One question: are these two tracks one object? */
export function MergeDetail({ merge, onCameras }: { merge: Merge; onCameras: () => void }) {
  const { driveId, store } = useShared();
  const { data, error, refetch } = useQuery(mergeLooksQuery(driveId, merge.id));
  const refusal = useRefusals((state) => state.byMerge[merge.id]);
  const goTo = (look: Look) => {
    store.getState().seek(look.frame_index);
    onCameras();
  };
  return (
    <article className={classes.detail} aria-label={text.queue.mergeOf(merge.track_a, merge.track_b)}>
      <div className={classes.content}>
        {data && <Looks merge={merge} looks={data} onLook={goTo} />}
        {!data && error && (
          <Notice title={text.queue.looksFailed} onRetry={() => void refetch()} role="alert">
            {messageOf(error)}
          </Notice>
        )}
        {!data && !error && <Skeleton h="100%" />}
      </div>
      {refusal && (
        <Alert
          role="alert"
          variant="outline"
          color="orange"
          p="xs"
          mx="md"
          icon={<IconAlertTriangle size={16} />}
          title={refusal.title}
        >
          {refusal.message}
        </Alert>
      )}
      <Decide merge={merge} onCameras={onCameras} />
    </article>
  );
}

interface LooksProps {
  merge: Merge;
  looks: MergeLooks;
  onLook: (look: Look) => void;
}

function Looks({ merge, looks, onLook }: LooksProps) {
  const [at, setAt] = useState(0);
  const moment = looks.moments[at] ?? looks.moments[0];
  if (!moment) return null;
  const [a, b] = moment.looks;
  const together = a.frame_index === b.frame_index;
  const sideOf = (look: Look): Side => {
    if (looks.sides[0].identity_id !== looks.sides[1].identity_id) {
      return look.identity_id === looks.sides[0].identity_id ? "a" : "b";
    }
    if (look.track_id === merge.track_a) return "a";
    return look.track_id === merge.track_b ? "b" : "other";
  };
  return (
    <>
      <section className={classes.pictures} aria-label={text.queue.pictures}>
        <header className={classes.when}>
          <h2>{together ? text.queue.sameMoment : text.queue.oneAfterOther}</h2>
          {looks.moments.length > 1 && (
            <span className={classes.moments}>
              {looks.moments.map((one, index) => (
                <button
                  key={`${one.looks[0].frame_index}/${one.looks[1].frame_index}`}
                  type="button"
                  aria-pressed={index === at}
                  aria-label={text.queue.momentAt(one.looks[0].frame_index)}
                  onClick={() => setAt(index)}
                >
                  {index + 1}
                </button>
              ))}
            </span>
          )}
        </header>
        <div className={classes.pair}>
          <Shown look={a} side="a" onLook={onLook} large />
          <Shown look={b} side="b" onLook={onLook} large />
        </div>
        <h2>{text.queue.best}</h2>
        <div className={classes.pair}>
          <Shown look={looks.sides[0].best} side="a" onLook={onLook} />
          <Shown look={looks.sides[1].best} side="b" onLook={onLook} />
        </div>
      </section>
      <section className={classes.facts} aria-label={text.queue.evidenceName}>
        <Evidence merge={merge} sides={looks.sides} />
        <BirdsEye looks={looks} frames={[a.frame_index, b.frame_index]} />
      </section>
      <section className={classes.strip} aria-label={text.queue.strip}>
        <h2>{text.queue.strip}</h2>
        <HandoverStrip strip={looks.strip} sideOf={sideOf} onLook={onLook} />
      </section>
    </>
  );
}

interface ShownProps {
  look: Look;
  side: "a" | "b";
  large?: boolean;
  onLook: (look: Look) => void;
}

function Shown({ look, side, large = false, onLook }: ShownProps) {
  const words = text.queue.lookAt(look.camera, look.frame_index);
  return (
    <figure className={classes.shown} data-side={side} data-large={large || undefined}>
      <button type="button" onClick={() => onLook(look)} title={text.queue.showInCameras}>
        <LookPicture
          look={look}
          side={side}
          aspect={PICTURE_ASPECT}
          width={720}
          alt={`${text.queue.sides[side]}: ${words}`}
        />
      </button>
      <figcaption>
        <b>{text.queue.sides[side]}</b>
        <span>
          {look.camera} <span className={classes.quiet}>{text.merges.atFrame(look.frame_index)}</span>
        </span>
        <span className={classes.class}>
          {look.class_name} {look.score === null ? text.cameras.notDetected : score(look.score)}
        </span>
      </figcaption>
    </figure>
  );
}

function Decide({ merge, onCameras }: { merge: Merge; onCameras: () => void }) {
  const { decide } = useQueueActions();
  const byPerson = merge.decided_by === "person";
  return (
    <footer className={classes.decide}>
      <span className={classes.question}>
        <strong>{text.queue.question}</strong>
        <span className={classes.quiet}>
          {merge.state === "proposed" ? sentence(merge.reason) : text.queue.stands(merge.state, byPerson)}
        </span>
      </span>
      <Button
        leftSection={<IconCheck size={17} />}
        rightSection={<Key action="accept" />}
        variant={merge.state === "accepted" ? "light" : "filled"}
        aria-pressed={merge.state === "accepted" && byPerson}
        onClick={() => decide("accept")}
      >
        {text.queue.accept}
      </Button>
      <Button
        leftSection={<IconX size={17} />}
        rightSection={<Key action="reject" />}
        variant={merge.state === "rejected" ? "light" : "default"}
        aria-pressed={merge.state === "rejected" && byPerson}
        onClick={() => decide("reject")}
      >
        {text.queue.reject}
      </Button>
      <Button
        leftSection={<IconHelp size={17} />}
        rightSection={<Key action="unsure" />}
        variant={merge.state === "unsure" ? "light" : "default"}
        aria-pressed={merge.state === "unsure"}
        onClick={() => decide("unsure")}
      >
        {text.queue.unsure}
      </Button>
      <Button
        leftSection={<IconArrowBackUp size={17} />}
        rightSection={<Key action="undo" />}
        variant="subtle"
        color="gray"
        disabled={!byPerson}
        onClick={() => decide("undo")}
      >
        {text.merges.undo}
      </Button>
      <Button
        leftSection={<IconPhoto size={17} />}
        rightSection={<Key action="queue" />}
        variant="subtle"
        color="gray"
        onClick={onCameras}
      >
        {text.queue.toCameras}
      </Button>
    </footer>
  );
}
