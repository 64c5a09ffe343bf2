"""A tiny drive with three cameras, and results of the pipeline for it, made by hand.

Tracks: 1 and 5 in front, 2 and 3 in left, 4 in right. 2 and 3 share frames, so they can never be one object. The
machine has merged 1 with 2; it proposes 1-3 (forbidden by that), 3-4 and 2-4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.feather as feather

from labeler.identity.linking import components
from labeler.identity.types import (
    Feature,
    MergeEvidence,
    MergeKind,
    MergePlot,
    MergeProposal,
    MergeState,
    SharedFrame,
)
from labeler.lidar.types import Boxes3D
from labeler.pipeline.types import LabelledDrive, LabelledFrame, LabelledView, Summary, TrackSummary
from labeler.propagation import PropagationConfig, collect_votes, donor_of, label_observations
from labeler.tracking.types import NO_DETECTION, Observations

CAMERAS = ("front", "left", "right")
CLASS_NAMES = ("car", "truck", "cone")
FRAMES = 6
WIDTH_PX, HEIGHT_PX = 96, 64
START_NS = 1_700_000_000_000_000_000
PERIOD_NS = 100_000_000


def write_three_camera_drive(folder: Path, *, frames: int = FRAMES) -> Path:
    """Write a drive in the Argoverse 2 layout; each image is of one brightness, 10 times frame plus camera number."""
    times_ns = [START_NS + frame * PERIOD_NS for frame in range(frames)]
    for number, camera in enumerate(CAMERAS):
        images = folder / "sensors" / "cameras" / camera
        images.mkdir(parents=True)
        for frame, time_ns in enumerate(times_ns):
            image = np.full((HEIGHT_PX, WIDTH_PX, 3), 10 * (frame + number), np.uint8)
            assert cv2.imwrite(str(images / f"{time_ns}.jpg"), image)
    same = {name: [value] * 3 for name, value in (("qw", 1.0), ("qx", 0.0), ("qy", 0.0), ("qz", 0.0), ("tz_m", 1.5))}
    _write_table(
        folder / "calibration" / "egovehicle_SE3_sensor.feather",
        {"sensor_name": list(CAMERAS), **same, "tx_m": [0.0] * 3, "ty_m": [0.0] * 3},
    )
    _write_table(
        folder / "calibration" / "intrinsics.feather",
        {"sensor_name": list(CAMERAS)}
        | {name: [50.0] * 3 for name in ("fx_px", "fy_px", "cx_px", "cy_px")}
        | {name: [0.0] * 3 for name in ("k1", "k2", "k3")}
        | {"width_px": [WIDTH_PX] * 3, "height_px": [HEIGHT_PX] * 3},
    )
    for time_ns in times_ns:
        points = {axis: np.array([1.0, 2.0], np.float32) for axis in ("x", "y", "z")}
        _write_table(folder / "sensors" / "lidar" / f"{time_ns}.feather", points | {"intensity": np.zeros(2, np.uint8)})
    return folder


@dataclass(frozen=True)
class MadeTrack:
    """A track whose box stands still; ``scores`` by frame, None where the tracker filled the box in. Boxes in the
    frames ``doubtful`` are hardly trusted."""

    track_id: int
    camera: str
    class_id: int
    scores: Mapping[int, float | None]
    x_px: float = 10.0
    box_3d: bool = field(default=False)
    doubtful: tuple[int, ...] = ()

    @property
    def box(self) -> tuple[float, float, float, float]:
        return (self.x_px, 10.0, self.x_px + 8.0, 20.0)

    def summary(self) -> TrackSummary:
        scored = {frame: score for frame, score in self.scores.items() if score is not None}
        best_frame = min(scored, key=lambda frame: (-scored[frame], frame))
        return TrackSummary(
            track_id=self.track_id,
            camera=self.camera,
            first_frame=min(self.scores),
            last_frame=max(self.scores),
            observation_count=len(self.scores),
            best_score=scored[best_frame],
            best_frame=best_frame,
            class_id=self.class_id,
        )


TRACKS = (
    MadeTrack(1, "front", 0, {0: 0.4, 1: 0.5, 2: 0.9, 3: None, 4: 0.6, 5: 0.5}, x_px=10, box_3d=True),
    MadeTrack(2, "left", 1, {1: 0.3, 2: 0.4, 3: 0.6, 4: 0.5}, x_px=20),
    MadeTrack(3, "left", 0, {2: 0.5, 3: 0.6, 4: 0.7, 5: 0.2}, x_px=40),
    MadeTrack(4, "right", 1, {0: 0.4, 1: 0.5, 2: 0.3}, x_px=50),
    MadeTrack(5, "front", 2, {0: 0.3, 1: 0.2}, x_px=70),
)
MERGES = (
    (1, 2, 0.8, MergeState.ACCEPTED),
    (1, 3, 0.5, MergeState.PROPOSED),
    (3, 4, 0.4, MergeState.PROPOSED),
    (2, 4, 0.3, MergeState.PROPOSED),
)


def make_labelled_drive(
    tracks: Sequence[MadeTrack] = TRACKS,
    merges: Sequence[tuple[int, int, float, MergeState]] = MERGES,
    *,
    key: str = "first",
    identity_of: Mapping[int, int] | None = None,
    propagation: PropagationConfig | None = None,
    on_frame: Callable[[int], None] = lambda _frame: None,
) -> LabelledDrive:
    """A result of the pipeline; the labels come from the labeler's own propagation. ``on_frame`` hears each frame."""
    propagation = propagation or PropagationConfig()
    camera_of = {track.track_id: track.camera for track in tracks}
    accepted = [(a, b) for a, b, _, state in merges if state is MergeState.ACCEPTED]
    identity_of = components(camera_of, accepted) if identity_of is None else identity_of
    by_frame = {
        frame: {camera: _observations(tracks, camera, frame) for camera in CAMERAS} for frame in _frames(tracks)
    }
    batches = [(camera, found) for views in by_frame.values() for camera, found in views.items()]
    times_ns = START_NS + PERIOD_NS * np.arange(1 + max(by_frame), dtype=np.int64)
    votes = collect_votes(batches, identity_of, config=propagation, timestamp_ns=times_ns)

    def open_frames() -> Iterator[LabelledFrame]:
        for frame, views in by_frame.items():
            on_frame(frame)
            yield LabelledFrame(
                frame,
                {
                    camera: LabelledView(
                        found,
                        label_observations(found, identity_of, votes, config=propagation, timestamp_ns=times_ns),
                        _boxes_3d(tracks, camera, found),
                    )
                    for camera, found in views.items()
                    if len(found)
                },
            )

    return LabelledDrive(
        key=key,
        class_names=CLASS_NAMES,
        tracks=tuple(track.summary() for track in tracks),
        merges=tuple(_proposal(a, b, camera_of, score, state) for a, b, score, state in merges),
        identity_of=identity_of,
        donors={one: donor for one, its in votes.items() if (donor := donor_of(its, propagation)) is not None},
        propagation=propagation,
        summary=_summary(len(tracks)),
        open_frames=open_frames,
    )


def _frames(tracks: Sequence[MadeTrack]) -> list[int]:
    return sorted({frame for track in tracks for frame in track.scores})


def _observations(tracks: Sequence[MadeTrack], camera: str, frame: int) -> Observations:
    seen = [track for track in tracks if track.camera == camera and frame in track.scores]
    scores = [track.scores[frame] for track in seen]
    return Observations(
        track_id=np.array([track.track_id for track in seen], np.int32),
        frame_index=np.full(len(seen), frame, np.int32),
        xyxy_px=np.array([track.box for track in seen], np.float32).reshape(-1, 4),
        score=np.array([np.nan if score is None else score for score in scores], np.float32),
        class_id=np.array([track.class_id for track in seen], np.int16),
        detection_index=np.array(
            [NO_DETECTION if score is None else row for row, score in enumerate(scores)], np.int32
        ),
        trust=np.array([0.05 if frame in track.doubtful else 0.95 for track in seen], np.float32),
    )


def _boxes_3d(tracks: Sequence[MadeTrack], camera: str, found: Observations) -> Boxes3D:
    """A box 12 m ahead for each track that has one and is detected in this frame, and one that is no track's."""
    with_box = {track.track_id for track in tracks if track.box_3d}
    rows = [row for row, track in enumerate(found.track_id.tolist()) if track in with_box]
    detections = [int(found.detection_index[row]) for row in rows if found.detection_index[row] != NO_DETECTION]
    if not detections:
        return Boxes3D.empty()
    detections.append(99)
    count = len(detections)
    return Boxes3D(
        center_m=np.tile(np.array([[12.0, 0.5, 0.75]], np.float32), (count, 1)),
        size_m=np.tile(np.array([[4.5, 1.8, 1.5]], np.float32), (count, 1)),
        yaw_rad=np.full(count, 0.25, np.float32),
        score=np.full(count, 0.8, np.float32),
        class_id=np.zeros(count, np.int16),
        num_points=np.full(count, 30, np.int32),
        detection_index=np.array(detections, np.int32),
        source=np.zeros(count, np.int8),
        center_std_m=np.full((count, 2), 0.2, np.float32),
        yaw_std_rad=np.full(count, 0.1, np.float32),
        seen_m=np.tile(np.array([-2, -1, 2, 1], np.float32), (count, 1)),
        offset_s=np.zeros(count, np.float32),
    )


def _proposal(a: int, b: int, camera_of: Mapping[int, str], score: float, state: MergeState) -> MergeProposal:
    return MergeProposal(
        track_a=a,
        camera_a=camera_of[a],
        track_b=b,
        camera_b=camera_of[b],
        score=score,
        state=state,
        shared_frames=2,
        agreeing_frames=1,
        mean_distance_m=0.4,
        mean_bev_iou=0.5,
        best_frames=(SharedFrame(frame_index=2, distance_m=0.4, bev_iou=0.5, iou_3d=0.4),),
        reason="at the same place in 1 of 2 shared frames",
        evidence=MergeEvidence(
            MergeKind.OVERLAP,
            calibrated=True,
            features=(Feature("distance_sigmas", 0.8, "sigma", 1.5),),
            bias_log_odds=-0.5,
            plot=MergePlot(2, ((2, 0.0, 0.0, 0.0),), ((2, 12.0, 0.5, 0.2),), (), ((2, 12.0, 0.5, 4.5, 1.8, 0.25),), ()),
        ),
    )


def _summary(tracks: int) -> Summary:
    return Summary(
        drive="made",
        format="argoverse2",
        frames=FRAMES,
        cameras={camera: {"frames": FRAMES, "detections": tracks, "tracks": tracks} for camera in CAMERAS},
        identities=tracks,
        merges={"accepted": 1, "proposed": 3, "rejected": 0},
        labels_propagated=0,
        seconds={"detect": 1.0},
        detector_seconds=0.5,
        peak_memory_mb=100.0,
        warnings=["a sweep was skipped"],
    )


def _write_table(path: Path, columns: Mapping[str, object]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    feather.write_feather(pa.table(dict(columns)), str(path))
