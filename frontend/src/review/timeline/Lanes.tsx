import { useQuery } from "@tanstack/react-query";
import { type PointerEvent, useMemo, useRef } from "react";
import { identitiesQuery, tracksQuery } from "../../api/queries";
import { clock } from "../../app/format";
import { text } from "../../strings";
import { inCarOrder } from "../cameras/layout";
import { identityColour } from "../cameras/palette";
import { useMerges } from "../merges/useDecisions";
import { useReview, useShared } from "../ReviewContext";
import classes from "./Lanes.module.css";
import { evidenceFrames, frameAt, segmentsOf } from "./segments";

const LANE_PX = 13;
const PAGE = 10;

/** A lane for each camera with what it sees of the selection, and the playhead across them, which can be dragged. */
export function Lanes({ frameTimesMs }: { frameTimesMs: readonly number[] }) {
  const { driveId, drive, store } = useShared();
  const frame = useReview((state) => state.frame);
  const identityIds = useReview((state) => state.identityIds);
  const mergeId = useReview((state) => state.mergeId);
  const tracks = useQuery(tracksQuery(driveId)).data;
  const identities = useQuery(identitiesQuery(driveId)).data;
  const merges = useMerges();
  const dragging = useRef(false);
  const count = drive.frame_count;
  const cameras = useMemo(() => inCarOrder(drive.camera_names), [drive.camera_names]);

  const segments = useMemo(() => segmentsOf(tracks ?? [], identityIds, count), [tracks, identityIds, count]);
  const donors = (identities ?? []).filter((one) => identityIds.includes(one.id) && one.donor);
  const evidence = evidenceFrames(merges.find((merge) => merge.id === mergeId));
  const middle = (index: number) => `${((index + 0.5) / count) * 100}%`;

  const seekTo = (event: PointerEvent<HTMLElement>) => {
    const bounds = event.currentTarget.getBoundingClientRect();
    store.getState().seek(frameAt((event.clientX - bounds.left) / bounds.width, count));
  };

  const onKeyDown = (event: React.KeyboardEvent) => {
    const to: Record<string, number> = {
      ArrowLeft: frame - 1,
      ArrowDown: frame - 1,
      ArrowRight: frame + 1,
      ArrowUp: frame + 1,
      PageDown: frame - PAGE,
      PageUp: frame + PAGE,
      Home: 0,
      End: count - 1,
    };
    const target = to[event.key];
    if (target === undefined) return;
    event.preventDefault();
    store.getState().setPlaying(false);
    store.getState().seek(target);
  };

  return (
    <div className={classes.lanes}>
      <div className={classes.names} aria-hidden>
        {cameras.map((camera) => (
          <span key={camera} style={{ height: LANE_PX }}>
            {camera}
          </span>
        ))}
      </div>
      <div
        className={classes.track}
        style={{ height: cameras.length * LANE_PX + 4 }}
        role="slider"
        tabIndex={0}
        aria-label={text.timeline.label}
        aria-valuemin={1}
        aria-valuemax={count}
        aria-valuenow={frame + 1}
        aria-valuetext={`${text.review.frame(frame, count)}, ${clock(frameTimesMs[frame] ?? 0)}`}
        onKeyDown={onKeyDown}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          dragging.current = true;
          store.getState().setPlaying(false);
          seekTo(event);
        }}
        onPointerMove={(event) => dragging.current && seekTo(event)}
        onPointerUp={() => {
          dragging.current = false;
        }}
        onPointerCancel={() => {
          dragging.current = false;
        }}
      >
        {cameras.map((camera, index) => (
          <div key={camera} className={classes.lane} style={{ top: index * LANE_PX + 2, height: LANE_PX }} />
        ))}
        {identityIds.length === 0 && <span className={classes.hint}>{text.timeline.hint}</span>}
        {segments.map((segment) => {
          const share = identityIds.indexOf(segment.identityId);
          const height = (LANE_PX - 4) / identityIds.length;
          return (
            <div
              key={segment.trackId}
              className={classes.segment}
              title={text.timeline.seenBy(segment.camera)}
              style={{
                left: `${segment.start * 100}%`,
                width: `${segment.length * 100}%`,
                top: cameras.indexOf(segment.camera) * LANE_PX + 4 + share * height,
                height: Math.max(2, height),
                background: identityColour(segment.identityId),
              }}
            />
          );
        })}
        {evidence.map((index) => (
          <div
            key={index}
            className={classes.evidence}
            style={{ left: middle(index) }}
            title={text.timeline.mergeFrames}
          />
        ))}
        {donors.map(({ id, donor }) => (
          <div
            key={id}
            className={classes.donor}
            title={`${text.timeline.donor}: ${donor.camera}`}
            style={{ left: middle(donor.frame_index), top: cameras.indexOf(donor.camera) * LANE_PX + 2 + LANE_PX / 2 }}
          />
        ))}
        <div className={classes.playhead} style={{ left: middle(frame) }} />
      </div>
    </div>
  );
}
