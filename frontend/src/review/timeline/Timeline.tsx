import { ActionIcon, SegmentedControl, Tooltip } from "@mantine/core";
import {
  IconPlayerPauseFilled,
  IconPlayerPlayFilled,
  IconPlayerTrackNext,
  IconPlayerTrackPrev,
} from "@tabler/icons-react";
import type { ReactNode } from "react";
import { clock } from "../../app/format";
import { text } from "../../strings";
import { Legend } from "../cameras/Legend";
import { withKey } from "../keys/Key";
import type { Action } from "../keys/keyMap";
import { useReview, useShared } from "../ReviewContext";
import { Lanes } from "./Lanes";
import classes from "./Timeline.module.css";

const SPEEDS = ["0.25", "0.5", "1", "2"];

/** The playhead: play, step, scrub; and when the cameras see what is selected. */
export function Timeline() {
  const { store, drive } = useShared();
  const playing = useReview((state) => state.playing);
  const speed = useReview((state) => state.speed);
  const { seek, setPlaying, setSpeed } = store.getState();
  const step = (by: number) => {
    setPlaying(false);
    seek(store.getState().frame + by);
  };
  return (
    <section className={classes.timeline} aria-label={text.timeline.label}>
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
        <div className={classes.legend}>
          <Legend />
        </div>
      </div>
      <Lanes frameTimesMs={drive.frame_times_ms} />
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
  action: Action;
  onClick: () => void;
  children: ReactNode;
}

function Button({ label, action, onClick, children }: ButtonProps) {
  return (
    <Tooltip label={withKey(label, action)} openDelay={500}>
      <ActionIcon size={30} radius="xl" variant="subtle" color="gray" aria-label={label} onClick={onClick}>
        {children}
      </ActionIcon>
    </Tooltip>
  );
}
