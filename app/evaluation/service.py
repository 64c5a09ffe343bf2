"""Comparing the labels that the store holds with the truth that lies beside the drive."""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from app.db.session import Session
from app.drives.models import DriveRow
from app.drives.service import open_stored_drive, require_drive
from app.errors import Conflict
from app.evaluation import repository
from app.evaluation.errors import NoTruth
from app.identities.relabelling import propagation_of
from app.settings import Settings
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow
from labeler.drive import Drive
from labeler.evaluation.ceiling import with_true_identities
from labeler.evaluation.evaluate import evaluate_labels
from labeler.evaluation.sources import FRAMES_PER_PART, detections_of_result
from labeler.evaluation.types import BoxRows, EvaluatedLabels, Evaluation, EvaluationConfig, EvaluationError, LabelRows
from labeler.pipeline.plan import frame_times_of


def evaluate_stored_drive(
    session: Session, settings: Settings, drive_id: int, *, config: EvaluationConfig
) -> Evaluation:
    """Evaluate the drive's current labels; NotFound, Conflict before it is labelled, NoTruth."""
    row = require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        raise Conflict(f"Drive {row.name} has no labels to evaluate yet. Label it first.")
    recorded = open_stored_drive(settings, row)
    return evaluate_labelling(session, settings, row, labelling, recorded, config=config)


def evaluate_labelling(
    session: Session,
    settings: Settings,
    row: DriveRow,
    labelling: LabellingRow,
    recorded: Drive,
    *,
    config: EvaluationConfig,
    merge_by_truth: bool = False,
) -> Evaluation:
    """Evaluate one labelling of a drive, or what it would be were its tracks merged by the truth; NoTruth where the
    drive comes without true boxes in its images."""
    cameras = tuple(camera.name for camera in recorded.cameras)
    names = tracks_repository.camera_names(session, row.id)
    gone = sorted(set(names.values()) - set(cameras))
    if gone:
        raise Conflict(
            f"The folder of drive {row.name} has no camera {', '.join(gone)} any more. Put its files back, or register "
            "the drive anew."
        )
    source = EvaluatedLabels(
        cameras=cameras,
        class_names=tuple(labelling.class_names),
        propagation=propagation_of(labelling),
        timestamp_ns=frame_times_of(recorded),
        open_labels=partial(
            _read_labels,
            session,
            labelling.id,
            row.frame_count,
            {camera_id: cameras.index(name) for camera_id, name in names.items()},
        ),
        open_detections=detections_of_result(settings.workspace, labelling.key, cameras),
    )
    truth = recorded.read_truth(recorded.frames)
    if merge_by_truth and truth is not None and truth.boxes_2d is not None:
        source = with_true_identities(source, truth.boxes_2d)
    try:
        return evaluate_labels(source, truth, drive_name=row.name, config=config)
    except EvaluationError as error:
        raise NoTruth(str(error)) from error


def _read_labels(
    session: Session, labelling_id: int, frame_count: int, camera_numbers: dict[int, int]
) -> Iterator[LabelRows]:
    for start in range(0, frame_count, FRAMES_PER_PART):
        columns = repository.labels_between(session, labelling_id, start, start + FRAMES_PER_PART)
        if columns:
            yield _to_label_rows(columns, camera_numbers)


def _to_label_rows(columns: Sequence[Sequence[Any]], camera_numbers: dict[int, int]) -> LabelRows:
    """Columns as :func:`app.evaluation.repository.labels_between` gives them; a score of None becomes NaN."""
    frame_index, camera_id, x1, y1, x2, y2, class_id, score, track_id, identity_id, *label = columns
    label_class_id, label_score, withheld, probability = label
    return LabelRows(
        own=BoxRows(
            frame_index=np.array(frame_index, np.int32),
            camera=np.array([camera_numbers[camera] for camera in camera_id], np.int16),
            xyxy_px=np.array([x1, y1, x2, y2], np.float32).T,
            class_id=np.array(class_id, np.int16),
            score=np.array(score, np.float32),
        ),
        track_id=np.array(track_id, np.int32),
        identity_id=np.array(identity_id, np.int32),
        label_class_id=np.array(label_class_id, np.int16),
        label_score=np.array(label_score, np.float32),
        withheld=np.array([reason is not None for reason in withheld], np.bool_),
        probability=np.array(probability, np.float32),
    )
