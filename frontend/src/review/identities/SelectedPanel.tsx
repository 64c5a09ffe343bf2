import { Button, Menu, Stack, Text } from "@mantine/core";
import { IconBan, IconCrosshair, IconPointer } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { distancesQuery, identitiesQuery, tracksQuery } from "../../api/queries";
import type { Identity, Observation } from "../../api/types";
import { score } from "../../app/format";
import { Notice } from "../../app/Notice";
import { text } from "../../strings";
import { Crop } from "../cameras/Crop";
import { identityColour } from "../cameras/palette";
import { Comments } from "../edits/Comments";
import { EditBar } from "../edits/EditBar";
import { MarkIcon } from "../edits/MarkIcon";
import { useEditActions } from "../edits/useEditActions";
import { Key } from "../keys/Key";
import { useCommitted, useReview, useShared } from "../ReviewContext";
import { useObservationsAt } from "../useObservationsAt";
import { nearestFrame } from "./nearestFrame";
import classes from "./SelectedPanel.module.css";

/** Of many selected objects one looks at the first ones. */
const MOST_IN_DETAIL = 6;
const PANEL_SPACE_PX = 34;

/** The selected identities, each with where its label comes from. */
export function SelectedPanel({ width }: { width: number }) {
  const { driveId } = useShared();
  const identityIds = useReview((state) => state.identityIds);
  const { data } = useQuery(identitiesQuery(driveId));
  if (identityIds.length === 0) {
    return (
      <Notice icon={<IconPointer size={28} stroke={1.4} />} title={text.identities.nothingSelected}>
        {text.identities.nothingSelectedHint}
      </Notice>
    );
  }
  if (!data) return null;
  return (
    <div className={classes.scroller}>
      <EditBar />
      {identityIds.slice(0, MOST_IN_DETAIL).map((id) => {
        const identity = data.find((one) => one.id === id);
        return identity ? (
          <IdentityDetail key={id} identity={identity} width={width} />
        ) : (
          <Text key={id} p="md" c="var(--muted)" size="sm">
            #{id}: {text.identities.gone}
          </Text>
        );
      })}
    </div>
  );
}

function IdentityDetail({ identity, width }: { identity: Identity; width: number }) {
  const { driveId, store } = useShared();
  const committed = useCommitted();
  const tracks = useQuery(tracksQuery(driveId)).data?.filter((track) => track.identity_id === identity.id) ?? [];
  const own = identity.observation_count - identity.propagated_count;
  const seen = committed?.observations.filter((one) => one.identity_id === identity.id) ?? [];
  // Where the donor itself is in this frame, what another camera received from it says more.
  const here = largest(seen.filter((one) => one.label.source === "propagated")) ?? largest(seen);
  const nearest = here ? null : nearestFrame(tracks, committed?.frame ?? 0);
  return (
    <section className={classes.identity} aria-label={`#${identity.id} ${identity.class_name}`}>
      <header className={classes.head}>
        <span className={classes.swatch} style={{ background: identityColour(identity.id) }} />
        <h2 className={classes.title}>
          #{identity.id} {identity.class_name}
          <MarkIcon identity={identity} />
        </h2>
        <span className={classes.score}>{score(identity.score)}</span>
      </header>
      <Text size="xs" c="var(--muted)">
        {identity.class_by_person ? text.edits.classByPerson : text.identities.labels(own, identity.propagated_count)}
      </Text>
      <Comments identityId={identity.id} />

      <h3 className={classes.heading}>{text.identities.labelFrom}</h3>
      <Lineage identity={identity} here={here} width={width} />
      {nearest !== null && (
        <Button size="compact-xs" variant="default" onClick={() => store.getState().seek(nearest)}>
          {text.identities.goToFrame}
        </Button>
      )}

      <h3 className={classes.heading}>{text.identities.tracks}</h3>
      <Stack gap={2} component="ul" className={classes.tracks}>
        {tracks.map((track) => (
          <li key={track.id}>
            <button
              type="button"
              className={classes.track}
              title={text.identities.goToTrack(track.id)}
              onClick={() => store.getState().seek(track.best_frame ?? track.first_frame)}
            >
              <span>{track.camera}</span>
              <span className={classes.quiet}>{text.identities.trackFrames(track.first_frame, track.last_frame)}</span>
              <span className={classes.quiet}>
                {track.class_name} {score(track.best_score)}
              </span>
            </button>
          </li>
        ))}
      </Stack>
    </section>
  );
}

/** The donor's crop beside the crop of now: the near look that labels the far one. */
function Lineage({ identity, here, width }: { identity: Identity; here: Observation | null; width: number }) {
  const { driveId, store } = useShared();
  const committed = useCommitted();
  const donor = identity.donor;
  const atDonor = useObservationsAt(donor.frame_index);
  const donorBox = atDonor && (atDonor.find((one) => one.id === donor.observation_id)?.box ?? null);
  const playing = useReview((state) => state.playing);
  const shown = [donor.observation_id, ...(here && here.id !== donor.observation_id ? [here.id] : [])];
  const distances = useQuery({ ...distancesQuery(driveId, shown), enabled: !playing }).data;
  const size = Math.floor((width - PANEL_SPACE_PX - 30) / 2);
  const height = Math.round(Math.min(size * 0.75, 280));
  return (
    <div className={classes.lineage}>
      <figure className={classes.look}>
        <Crop
          frame={donor.frame_index}
          camera={donor.camera}
          box={donorBox}
          identityId={identity.id}
          width={size}
          height={height}
          emptyText={text.merges.noCrop}
          alt={text.identities.donor}
        />
        <figcaption>
          <b>{text.identities.donor}</b>
          <span className={classes.quiet}>
            {donor.camera}, {text.merges.atFrame(donor.frame_index)}
          </span>
          <Measured
            name={text.identities.atThatTime}
            score={donor.score}
            distance={distances?.get(donor.observation_id)}
          />
          <Button
            size="compact-xs"
            mt={4}
            variant="light"
            leftSection={<IconCrosshair size={13} />}
            rightSection={<Key action="goToDonor" />}
            onClick={() => store.getState().seek(donor.frame_index)}
          >
            {text.identities.goToDonor}
          </Button>
          {!identity.class_by_person && <RejectDonor identity={identity} />}
        </figcaption>
      </figure>
      <span className={classes.arrow} aria-hidden>
        →
      </span>
      <figure className={classes.look}>
        <Crop
          frame={committed?.frame ?? 0}
          camera={here?.camera ?? ""}
          box={here?.box ?? null}
          identityId={identity.id}
          width={size}
          height={height}
          emptyText={text.identities.notInFrame}
          alt={text.identities.now}
        />
        <figcaption>
          <b>{text.identities.now}</b>
          {here && (
            <>
              <span className={classes.quiet}>
                {here.camera}, {nowSays(here)}
              </span>
              <Measured name={text.identities.nowShort} score={here.score} distance={distances?.get(here.id)} />
            </>
          )}
        </figcaption>
      </figure>
    </div>
  );
}

/** Score and distance of a look: what the near look had, and what the far one has. */
function Measured({ name, score: value, distance }: { name: string; score: number | null; distance?: number | null }) {
  return (
    <span className={classes.measured}>
      {text.identities.measured(
        name,
        value === null ? text.cameras.notDetected : score(value),
        distance == null ? text.identities.noDistance : text.queue.metres(distance),
      )}
    </span>
  );
}

/** The label is wrong because this look is: take it from another one. */
function RejectDonor({ identity }: { identity: Identity }) {
  const { store } = useShared();
  const { rejectDonor } = useEditActions();
  const reject = (wholeTrack: boolean) => {
    store.getState().select([identity.id]);
    rejectDonor(wholeTrack);
  };
  return (
    <Menu position="bottom-start" shadow="md">
      <Menu.Target>
        <Button size="compact-xs" mt={4} variant="default" leftSection={<IconBan size={13} />}>
          {text.identities.rejectDonor}
        </Button>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>{text.identities.rejectDonorHint}</Menu.Label>
        <Menu.Item rightSection={<Key action="rejectDonor" />} onClick={() => reject(false)}>
          {text.identities.rejectLook}
        </Menu.Item>
        <Menu.Item onClick={() => reject(true)}>{text.identities.rejectTrack}</Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}

function nowSays(here: Observation): string {
  if (here.label.source !== "propagated") return text.identities.ownLabel;
  return here.score === null ? text.cameras.notDetected : text.cameras.detectorSaid(here.class_name, score(here.score));
}

function largest(observations: readonly Observation[]): Observation | null {
  const area = ([x1 = 0, y1 = 0, x2 = 0, y2 = 0]: readonly number[]) => (x2 - x1) * (y2 - y1);
  return observations.reduce<Observation | null>(
    (best, one) => (!best || area(one.box) > area(best.box) ? one : best),
    null,
  );
}
