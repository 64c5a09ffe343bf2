"""Labels as they would be under perfect merging, on a drive laid out by hand."""

from collections.abc import Iterator

import numpy as np
import pytest

from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.ceiling import with_true_identities
from labeler.evaluation.evaluate import evaluate_labels
from labeler.evaluation.types import BoxRows, EvaluatedLabels, LabelRows
from labeler.propagation import PropagationConfig

CAMERAS = ("front", "left")
PLACE_PX = {"a": 0.0, "b": 100.0}
# (frame, camera, track, object that it lies on, score); the run has merged nothing.
SEEN = [(0, 0, 1, "a", 0.95), (1, 0, 1, "a", 0.9), (1, 1, 7, "a", 0.4), (2, 1, 7, "a", 0.5), (2, 1, 8, "b", 0.6)]


def boxes_px(names: list[str]) -> np.ndarray:
    return np.array([[PLACE_PX[name], 0, PLACE_PX[name] + 40, 40] for name in names], np.float32)


def label_parts() -> Iterator[LabelRows]:
    frame, camera, track, name, score = (list(column) for column in zip(*SEEN, strict=True))
    own = BoxRows(
        frame_index=np.array(frame, np.int32),
        camera=np.array(camera, np.int16),
        xyxy_px=boxes_px(name),
        class_id=np.zeros(len(SEEN), np.int16),
        score=np.array(score, np.float32),
    )
    best = {1: 0.95, 7: 0.5, 8: 0.6}
    yield LabelRows(
        own=own,
        track_id=np.array(track, np.int32),
        identity_id=np.array(track, np.int32),
        label_class_id=np.zeros(len(SEEN), np.int16),
        label_score=np.array([best[one] for one in track], np.float32),
        withheld=np.zeros(len(SEEN), np.bool_),
        probability=np.full(len(SEEN), np.nan, np.float32),
    )


SOURCE = EvaluatedLabels(
    cameras=CAMERAS,
    class_names=("car",),
    propagation=PropagationConfig(),
    timestamp_ns=np.arange(3, dtype=np.int64) * 100_000_000,
    open_labels=label_parts,
    open_detections=None,
)
TRUE_BOXES = TruthBoxes2D(
    frame_index=np.array([row[0] for row in SEEN], np.int32),
    camera=tuple(CAMERAS[row[1]] for row in SEEN),
    track_uuid=tuple(row[3] for row in SEEN),
    category=("CAR",) * len(SEEN),
    xyxy_px=boxes_px([row[3] for row in SEEN]),
)


def test_all_tracks_of_an_object_get_the_label_of_its_best_box():
    (part,) = with_true_identities(SOURCE, TRUE_BOXES).open_labels()
    assert part.identity_id.tolist() == [1, 1, 1, 1, 8]
    assert part.label_score.tolist() == pytest.approx([0.95, 0.95, 0.95, 0.95, 0.6])


@pytest.mark.parametrize(("source", "found"), [(SOURCE, 2), (with_true_identities(SOURCE, TRUE_BOXES), 4)])
def test_the_multi_camera_row_is_the_ceiling(source: EvaluatedLabels, found: int):
    rows = evaluate_labels(source, Truth(TRUE_BOXES, None), drive_name="made")["rows"]
    tp = {row["method"]: row["tp"] for row in rows if (row["cameras"], row["iou"]) == ("all", 0.5)}
    assert (tp["single-camera"], tp["multi-camera"]) == (2, found)
