"""Where the labels to evaluate come from: a result of the pipeline, and the detections that it was made from."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np

from labeler.drive import Drive
from labeler.evaluation.types import BoxRows, EvaluatedLabels, LabelRows
from labeler.pipeline.plan import frame_times_of
from labeler.pipeline.results import find_detections
from labeler.pipeline.types import LabelledDrive, LabelledFrame
from labeler.propagation import Withheld
from labeler.tracking import DetectedFrame, Observations

FRAMES_PER_PART = 64


def labels_of_run(labelled: LabelledDrive, drive: Drive, *, workspace: Path | None = None) -> EvaluatedLabels:
    """The labels of a run over ``drive``. ``workspace`` is where it kept its detections."""
    cameras = tuple(camera.name for camera in drive.cameras)
    return EvaluatedLabels(
        cameras=cameras,
        class_names=labelled.class_names,
        propagation=labelled.propagation,
        timestamp_ns=frame_times_of(drive),
        open_labels=partial(_label_parts, labelled, cameras),
        open_detections=None if workspace is None else detections_of_result(workspace, labelled.key, cameras),
    )


def detections_of_result(workspace: Path, key: str, cameras: Sequence[str]) -> Callable[[], Iterator[BoxRows]] | None:
    """A pass over the detections of the result of that key, camera by camera; None where they are not kept."""
    found = find_detections(workspace, key)
    return None if found is None else partial(_detection_parts, found, tuple(cameras))


def _detection_parts(
    detections: Mapping[str, Callable[[], Iterable[DetectedFrame]]], cameras: tuple[str, ...]
) -> Iterator[BoxRows]:
    for camera, open_frames in detections.items():
        frames = iter(open_frames())
        while some := list(islice(frames, FRAMES_PER_PART)):
            counts = [len(frame.detections) for frame in some]
            yield BoxRows(
                frame_index=np.repeat(np.array([frame.frame_index for frame in some], np.int32), counts),
                camera=np.full(sum(counts), cameras.index(camera), np.int16),
                xyxy_px=np.concatenate([frame.detections.xyxy_px for frame in some]),
                class_id=np.concatenate([frame.detections.class_id for frame in some]),
                score=np.concatenate([frame.detections.score for frame in some]),
            )


def _label_parts(labelled: LabelledDrive, cameras: tuple[str, ...]) -> Iterator[LabelRows]:
    frames = labelled.frames()
    while some := list(islice(frames, FRAMES_PER_PART)):
        yield _label_rows(some, cameras)


def _label_rows(frames: Sequence[LabelledFrame], cameras: tuple[str, ...]) -> LabelRows:
    views = [(cameras.index(camera), view) for frame in frames for camera, view in frame.views.items()]
    observations = [Observations.empty(), *(view.observations for _, view in views)]
    labels = [view.labels for _, view in views]
    own = BoxRows(
        frame_index=np.concatenate([part.frame_index for part in observations]),
        camera=np.repeat(np.array([camera for camera, _ in views], np.int16), [len(part) for part in labels]),
        xyxy_px=np.concatenate([part.xyxy_px for part in observations]),
        class_id=np.concatenate([part.class_id for part in observations]),
        score=np.concatenate([part.score for part in observations]),
    )
    return LabelRows(
        own=own,
        track_id=np.concatenate([part.track_id for part in observations]),
        identity_id=np.concatenate([np.zeros(0, np.int32), *(part.identity_id for part in labels)]),
        label_class_id=np.concatenate([np.zeros(0, np.int16), *(part.class_id for part in labels)]),
        label_score=np.concatenate([np.zeros(0, np.float32), *(part.score for part in labels)]),
        withheld=np.concatenate([np.zeros(0, np.bool_), *(part.withheld != Withheld.NO for part in labels)]),
        probability=np.concatenate([np.zeros(0, np.float32), *(part.probability for part in labels)]),
    )
