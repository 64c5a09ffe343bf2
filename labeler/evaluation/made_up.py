"""A long drive with truth and labels, made up from a seed, to measure how long evaluation takes. It has no images.

Cars stand around a car that turns, so that each wanders through the images of all cameras; some are seen, some missed,
and some labels lie on nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.feather as pyarrow_feather
from numpy.typing import NDArray

from labeler.lidar.types import Boxes3D
from labeler.pipeline.types import LabelledDrive, LabelledFrame, LabelledView, MergeSummary, Summary, TrackSummary
from labeler.propagation.config import PropagationConfig
from labeler.propagation.types import Labels
from labeler.tracking.types import Observations

pa: Any = pyarrow  # its types are partial
feather: Any = pyarrow_feather

WIDTH_PX, HEIGHT_PX = 720, 360
CLASS_NAMES = ("car", "truck")
_START_NS, _PERIOD_NS = 1_700_000_000_000_000_000, 100_000_000
_TRACK_FRAMES = 50
_NO_IMAGE = b"-"


@dataclass(frozen=True)
class MadeUp:
    """How large the drive is; ``objects`` is how many stand in each image."""

    frames: int = 1000
    cameras: int = 4
    objects: int = 15
    seed: int = 0

    @property
    def camera_names(self) -> tuple[str, ...]:
        return ("front", *(f"camera_{number}" for number in range(1, self.cameras)))

    def truth_px(self, frame: int) -> NDArray[np.float32]:
        """(cameras, objects, 4) float32 boxes in one frame."""
        place = np.arange(self.cameras * self.objects).reshape(self.cameras, self.objects)
        x = (place * 97.0 + frame * 3.0) % (WIDTH_PX - 60)
        y = (place * 61.0) % (HEIGHT_PX - 40)
        return np.stack([x, y, x + 60, y + 40], axis=-1).astype(np.float32)


def write_made_up_drive(folder: Path, size: MadeUp) -> Path:
    """Write the drive in the native layout, with files of one byte for images and true boxes beside them."""
    times_ns = [_START_NS + frame * _PERIOD_NS for frame in range(size.frames)]
    for camera in size.camera_names:
        images = folder / "sensors" / "cameras" / camera
        images.mkdir(parents=True)
        for time_ns in times_ns:
            (images / f"{time_ns}.jpg").write_bytes(_NO_IMAGE)
    _write_intrinsics(folder / "calibration", size)
    boxes_px = np.stack([size.truth_px(frame) for frame in range(size.frames)]).reshape(-1, 4)
    in_frame = size.cameras * size.objects
    columns: dict[str, object] = {
        "timestamp_ns": np.repeat(np.array(times_ns), in_frame),
        "camera": np.tile(np.repeat(np.array(size.camera_names), size.objects), size.frames),
        "track_uuid": np.tile(np.array([f"object-{number}" for number in range(in_frame)]), size.frames),
        "category": np.tile(np.where(np.arange(in_frame) % 5 == 0, "truck", "car"), size.frames),
        "distance_m": np.tile(np.linspace(5, 100, in_frame), size.frames),
    }
    columns |= {name: boxes_px[:, number] for number, name in enumerate(("x1_px", "y1_px", "x2_px", "y2_px"))}
    columns |= {f"visible_{name}": columns[name] for name in ("x1_px", "y1_px", "x2_px", "y2_px")}
    feather.write_feather(pa.table(columns), str(folder / "annotations_2d.feather"))
    return folder


def made_up_labels(size: MadeUp) -> LabelledDrive:
    """Labels of the drive: each object has a new track every few seconds, and one identity over all of them."""
    pieces = -(-size.frames // _TRACK_FRAMES)
    objects = size.cameras * size.objects
    tracks = [
        TrackSummary(
            track_id=_track_id(number, piece, objects),
            camera=size.camera_names[number // size.objects],
            first_frame=piece * _TRACK_FRAMES,
            last_frame=min((piece + 1) * _TRACK_FRAMES, size.frames) - 1,
            observation_count=min((piece + 1) * _TRACK_FRAMES, size.frames) - piece * _TRACK_FRAMES,
            best_score=0.85,
            best_frame=piece * _TRACK_FRAMES,
            class_id=0,
        )
        for piece in range(pieces)
        for number in range(objects)
    ]
    return LabelledDrive(
        key=f"made up {size}",
        class_names=CLASS_NAMES,
        tracks=tuple(tracks),
        merges=(),
        identity_of={track.track_id: 1 + (track.track_id - 1) % objects for track in tracks},
        donors={},
        propagation=PropagationConfig(),
        summary=Summary(
            drive="made up",
            format="argoverse2",
            frames=size.frames,
            cameras={},
            identities=objects,
            merges=MergeSummary(accepted=0, proposed=0, rejected=0),
            labels_propagated=0,
            seconds={},
            detector_seconds=0.0,
            peak_memory_mb=0.0,
            warnings=[],
        ),
        open_frames=partial(_labelled_frames, size),
    )


def _labelled_frames(size: MadeUp) -> Iterator[LabelledFrame]:
    random = np.random.default_rng(size.seed)
    for frame in range(size.frames):
        boxes_px = size.truth_px(frame)
        views = {
            name: _view(size, frame, camera, boxes_px[camera], random) for camera, name in enumerate(size.camera_names)
        }
        yield LabelledFrame(frame, views)


def _view(
    size: MadeUp, frame: int, camera: int, boxes_px: NDArray[np.float32], random: np.random.Generator
) -> LabelledView:
    count, objects = size.objects, size.cameras * size.objects
    number = np.arange(camera * count, (camera + 1) * count)
    track_id = _track_id(number, frame // _TRACK_FRAMES, objects).astype(np.int32)
    frame_index = np.full(count, frame, np.int32)
    observations = Observations(
        track_id=track_id,
        frame_index=frame_index,
        xyxy_px=(boxes_px + random.normal(0, 6, (count, 4))).astype(np.float32),
        score=random.uniform(0.1, 0.95, count).astype(np.float32),
        class_id=np.zeros(count, np.int16),
        detection_index=np.arange(count, dtype=np.int32),
    )
    labels = Labels(
        track_id=track_id,
        frame_index=frame_index,
        identity_id=(1 + number).astype(np.int32),
        class_id=np.zeros(count, np.int16),
        score=np.full(count, 0.9, np.float32),
        donor_track_id=track_id,
        donor_frame_index=frame_index,
        propagated=np.ones(count, np.bool_),
    )
    return LabelledView(observations, labels, Boxes3D.empty())


def _track_id(number: Any, piece: int, objects: int) -> Any:
    return 1 + number + piece * objects


def _write_intrinsics(folder: Path, size: MadeUp) -> None:
    folder.mkdir(parents=True)
    same = {
        "fx_px": 300.0,
        "fy_px": 300.0,
        "cx_px": 360.0,
        "cy_px": 180.0,
        "width_px": WIDTH_PX,
        "height_px": HEIGHT_PX,
    }
    pose = {"qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0, "tx_m": 0.0, "ty_m": 0.0, "tz_m": 1.5}
    for name, values in (("intrinsics", same), ("egovehicle_SE3_sensor", pose)):
        columns = {column: [value] * size.cameras for column, value in values.items()}
        table = pa.table({"sensor_name": list(size.camera_names)} | columns)
        feather.write_feather(table, str(folder / f"{name}.feather"))
