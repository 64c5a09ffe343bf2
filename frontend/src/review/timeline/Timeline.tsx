import { ActionIcon, SegmentedControl, Button as TextButton, Tooltip } from "@mantine/core";
import {
  IconPlayerPauseFilled,
  IconPlayerPlayFilled,
  IconPlayerTrackNext,
  IconPlayerTrackPrev,
  IconZoomIn,
  IconZoomOut,
} from "@tabler/icons-react";
import { type ReactNode, useState } from "react";
import { clock } from "../../app/format";
import { Splitter } from "../../app/Splitter";
import { useStoredState } from "../../app/storedState";
import { text } from "../../strings";
import { withKey } from "../keys/Key";
import type { Action } from "../keys/keyMap";
import { useReview, useShared } from "../ReviewContext";
import { Lanes } from "./Lanes";
import { GROUPINGS, type Grouping } from "./lanes";
import classes from "./Timeline.module.css";
import { wholeDrive, zoomTime } from "./timeView";

const SPEEDS = ["0.25", "0.5", "1", "2", "3"];
const HEIGHT = { min: 80, max: 900 };
const ZOOM_STEP = 1.6;

/** The playhead: play, step, scrub; and when each camera sees each identity, once the page is `whole`. */
export function Timeline({ whole }: { whole: boolean }) {
  const { store, drive } = useShared();
  const playing = useReview((state) => state.playing);
  const speed = useReview((state) => state.speed);
  const { seek, setPlaying, setSpeed } = store.getState();
  const [grouping, setGrouping] = useState<Grouping>("class");
  const [view, setView] = useState(() => wholeDrive(drive.frame_count));
  const [height, setHeight] = useStoredState("timelineHeight", Math.round(window.innerHeight * 0.2));
  const zoom = (factor: number) => setView((now) => zoomTime(now, factor, 0.5, drive.frame_count));
  const step = (by: number) => {
    setPlaying(false);
    seek(store.getState().frame + by);
  };
  return (
    <section className={classes.timeline} aria-label={text.timeline.label}>
      <Splitter orientation="horizontal" label={text.timeline.resize} size={height} {...HEIGHT} onChange={setHeight} />
      <div className={classes.transport}>
        <Button label={text.timeline.previous} action="previousFrame" onClick={() => step(-1)}>
          <IconPlayerTrackPrev size={16} />
        </Button>
        <Tooltip label={withKey(playing ? text.timeline.pause : text.timeline.play, "playPause")} openDelay={500}>
          <ActionIcon
            size={34}
            radius="xl"
            variant="filled"
            aria-label={playing ? text.timeline.pause : text.timeline.play}
            onClick={() => setPlaying(!playing)}
          >
            {playing ? <IconPlayerPauseFilled size={17} /> : <IconPlayerPlayFilled size={17} />}
          </ActionIcon>
        </Tooltip>
        <Button label={text.timeline.next} action="nextFrame" onClick={() => step(1)}>
          <IconPlayerTrackNext size={16} />
        </Button>
        <Where />
        <SegmentedControl
          size="xs"
          aria-label={text.timeline.speed}
          value={String(speed)}
          onChange={(value) => setSpeed(Number(value))}
          data={SPEEDS.map((value) => ({ value, label: `${value}×` }))}
        />
        <div className={classes.right}>
          <span className={classes.words} id="lanes-by">
            {text.timeline.groupBy}
          </span>
          <SegmentedControl
            size="xs"
            aria-labelledby="lanes-by"
            value={grouping}
            onChange={(value) => setGrouping(value as Grouping)}
            data={GROUPINGS.map((value) => ({ value, label: text.timeline.groupings[value] }))}
          />
          <Button label={text.timeline.zoomOut} onClick={() => zoom(1 / ZOOM_STEP)}>
            <IconZoomOut size={17} />
          </Button>
          <Button label={text.timeline.zoomIn} onClick={() => zoom(ZOOM_STEP)}>
            <IconZoomIn size={17} />
          </Button>
          <TextButton size="compact-xs" variant="default" onClick={() => setView(wholeDrive(drive.frame_count))}>
            {text.timeline.all}
          </TextButton>
        </div>
      </div>
      {whole ? <Lanes grouping={grouping} view={view} onView={setView} height={height} /> : <div style={{ height }} />}
    </section>
  );
}

function Where() {
  const { drive } = useShared();
  const frame = useReview((state) => state.frame);
  return (
    <div className={classes.where}>
      <strong>{text.review.frame(frame, drive.frame_count)}</strong>
      <span>{clock(drive.frame_times_ms[frame] ?? 0)}</span>
    </div>
  );
}

interface ButtonProps {
  label: string;
  action?: Action;
  onClick: () => void;
  children: ReactNode;
}

function Button({ label, action, onClick, children }: ButtonProps) {
  return (
    <Tooltip label={action ? withKey(label, action) : label} openDelay={500}>
      <ActionIcon size={30} radius="xl" variant="subtle" color="gray" aria-label={label} onClick={onClick}>
        {children}
      </ActionIcon>
    </Tooltip>
  );
}
