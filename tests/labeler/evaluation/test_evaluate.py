"""The three methods over a drive of two cameras, by hand.

One car passes from camera "left" to camera "front"; it is seen in both in frame 1. The detector is sure of it only
once, in front. So without tracking one of its four boxes is found, with tracks inside each camera two, over all cameras
four.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.evaluate import evaluate_labels
from labeler.evaluation.types import (
    BoxRows,
    EvaluatedLabels,
    Evaluation,
    EvaluationConfig,
    EvaluationError,
    LabelRows,
)
from labeler.propagation import PropagationConfig

CAMERAS = ("front", "left")
CLASS_NAMES = ("car", "truck", "person")
BOX = (100.0, 100.0, 140.0, 120.0)
VISIBLE = (100.0, 100.0, 110.0, 120.0)

# frame, camera, track, identity, class and score of the detector, class and score of the label
SEEN = (
    (0, 1, 11, 1, 1, 0.4, 0, 0.9),
    (1, 1, 11, 1, 0, 0.5, 0, 0.9),
    (1, 0, 1, 1, 0, 0.6, 0, 0.9),
    (2, 0, 1, 1, 0, 0.9, 0, 0.9),
)


def boxes(rows: list[tuple[int, int]], class_id: list[int], score: list[float]) -> BoxRows:
    return BoxRows(
        frame_index=np.array([frame for frame, _ in rows], np.int32),
        camera=np.array([camera for _, camera in rows], np.int16),
        xyxy_px=np.tile(np.array([BOX], np.float32), (len(rows), 1)),
        class_id=np.array(class_id, np.int16),
        score=np.array(score, np.float32),
    )


def label_parts(withheld: tuple[tuple[int, int, int], ...] = ()) -> Iterator[LabelRows]:
    """Frame by frame; labels of the rows (frame, camera, track) ``withheld`` are said to be."""
    for frame in range(3):
        seen = [row for row in SEEN if row[0] == frame]
        yield LabelRows(
            own=boxes([row[:2] for row in seen], [row[4] for row in seen], [row[5] for row in seen]),
            track_id=np.array([row[2] for row in seen], np.int32),
            identity_id=np.array([row[3] for row in seen], np.int32),
            label_class_id=np.array([row[6] for row in seen], np.int16),
            label_score=np.array([row[7] for row in seen], np.float32),
            withheld=np.array([row[:3] in withheld for row in seen], np.bool_),
            probability=np.full(len(seen), np.nan, np.float32),
        )


def detection_parts() -> Iterator[BoxRows]:
    """Camera by camera: what was seen, and in frame 0 in front a sure box on nothing that no track took."""
    yield boxes([(0, 0), (1, 0), (2, 0)], [0, 0, 0], [0.95, 0.6, 0.9])
    yield boxes([(0, 1), (1, 1)], [1, 0], [0.4, 0.5])


def source(**given: Any) -> EvaluatedLabels:
    return EvaluatedLabels(
        **{
            "cameras": CAMERAS,
            "class_names": CLASS_NAMES,
            "propagation": PropagationConfig(),
            "timestamp_ns": np.arange(3, dtype=np.int64) * 1_000_000_000,
            "open_labels": label_parts,
            "open_detections": detection_parts,
        }
        | given
    )


def truth(**given: Any) -> Truth:
    columns = {
        "frame_index": np.array([2, 0, 1, 1], np.int32),
        "camera": ("front", "left", "front", "left"),
        "track_uuid": ("car",) * 4,
        "category": ("CAR",) * 4,
        "xyxy_px": np.tile(np.array([BOX], np.float32), (4, 1)),
        "distance_m": np.array([8, 30, 10, 20], np.float32),
    }
    return Truth(TruthBoxes2D(**(columns | given)), None)


def evaluated(
    config: EvaluationConfig | None = None, *, labels: EvaluatedLabels | None = None, **given: Any
) -> Evaluation:
    return evaluate_labels(labels or source(), truth(**given), drive_name="made", config=config)


def counts(found: Evaluation, *, cameras: str = "all", truth: str = "whole", iou: float = 0.5) -> dict[str, tuple]:
    return {
        row["method"]: (row["tp"], row["fp"], row["fn"])
        for row in found["rows"]
        if (row["cameras"], row["truth"], row["iou"]) == (cameras, truth, iou)
    }


def test_what_labels_say_of_themselves_is_set_against_the_truth():
    """All four labels say .9 and hit; their probability is not known. Without the last car, .25 of them does not."""
    found = evaluated()["calibration"]
    assert (found["iou"], found["probability"]["labels"], found["confidence"]["labels"]) == (0.5, 0, 4)
    assert found["confidence"]["expected_error"] == pytest.approx(0.1)
    parked = evaluated(xyxy_px=np.array([BOX, BOX, BOX, (300, 10, 340, 30)], np.float32))["calibration"]
    assert parked["confidence"]["expected_error"] == pytest.approx(0.9 - 0.75)


def test_a_withheld_label_is_the_detectors_own_in_the_single_camera_row_too():
    """Track 1 has the score .9 in frame 2 only; its box in frame 1 keeps its own .6."""
    labels = source(open_labels=lambda: label_parts(withheld=((1, 0, 1),)))
    assert counts(evaluated(labels=labels))["single-camera"] == (1, 0, 3)


@pytest.mark.parametrize(
    ("propagation", "expected"),
    [
        # front: the box of .9 speaks for both; left: the one of .5 does, which is not sure
        (PropagationConfig(), (2, 0, 2)),
        (PropagationConfig(rule="top-k", top_k=2), (2, 0, 2)),
        # one second lies between the boxes in front: within half a second the sure one speaks for itself only
        (PropagationConfig(window_s=0.5), (1, 0, 3)),
        (PropagationConfig(window_s=2.0), (2, 0, 2)),
        # only what has .95 may speak for others, which nothing has
        (PropagationConfig(min_donor_score=0.95), (1, 0, 3)),
    ],
)
def test_tracks_get_labels_by_the_settings_of_the_run(propagation: PropagationConfig, expected: tuple[int, int, int]):
    assert counts(evaluated(labels=source(propagation=propagation)))["single-camera"] == expected


def test_in_tracks_too_the_surest_vote_where_that_is_the_rule():
    """Track 1 is called a truck with .9 once, and a car with .6 and .5: three vote for the car, which is never sure."""

    def parts() -> Iterator[LabelRows]:
        for frame, class_id, score in ((0, 0, 0.5), (1, 0, 0.6), (2, 1, 0.9)):
            yield LabelRows(
                own=boxes([(frame, 0)], [class_id], [score]),
                track_id=np.array([1], np.int32),
                identity_id=np.array([1], np.int32),
                label_class_id=np.array([0], np.int16),
                label_score=np.array([0.9], np.float32),
                withheld=np.zeros(1, np.bool_),
                probability=np.full(1, np.nan, np.float32),
            )

    three = truth(
        frame_index=np.arange(3, dtype=np.int32),
        camera=("front",) * 3,
        track_uuid=("car",) * 3,
        category=("CAR",) * 3,
        xyxy_px=np.tile(np.array([BOX], np.float32), (3, 1)),
        distance_m=np.full(3, 10, np.float32),
    )
    config = EvaluationConfig(confidence=0.55)
    for propagation, expected in ((PropagationConfig(), (0, 3, 3)), (PropagationConfig("top-k", 3), (3, 0, 0))):
        labels = source(open_labels=parts, open_detections=None, propagation=propagation)
        found = evaluate_labels(labels, three, drive_name="made", config=config)
        assert counts(found)["single-camera"] == expected


def test_the_table():
    found = evaluated()
    # the box on nothing in front counts without tracking only: no track has it
    assert counts(found) == {"without-tracking": (1, 1, 3), "single-camera": (2, 0, 2), "multi-camera": (4, 0, 0)}
    assert counts(found, cameras="front") == {
        "without-tracking": (1, 1, 1),
        "single-camera": (2, 0, 0),
        "multi-camera": (2, 0, 0),
    }
    assert found["rows"][0] == {
        "method": "without-tracking",
        "cameras": "all",
        "truth": "whole",
        "iou": 0.25,
        "precision": 0.5,
        "recall": 0.25,
        "tp": 1,
        "fp": 1,
        "fn": 3,
    }
    assert len(found["rows"]) == 3 * 2 * 2  # methods, cameras, IoUs; there are no visible boxes
    assert (found["truth_count"], found["dont_care_count"]) == (4, 0)


def test_where_detections_are_not_kept_the_observations_stand_for_them():
    found = evaluated(labels=source(open_detections=None))
    assert counts(found)["without-tracking"] == (1, 0, 3)
    assert found["without_tracking_from"] == "observations"


def test_a_smaller_confidence_takes_weaker_labels():
    assert counts(evaluated(EvaluationConfig(confidence=0.5))) == {
        "without-tracking": (3, 1, 1),  # all but the one of .4
        "single-camera": (4, 0, 0),
        "multi-camera": (4, 0, 0),
    }
    aware, agnostic = (
        counts(evaluated(EvaluationConfig(confidence=0.4, classes=classes)))["without-tracking"]
        for classes in ("aware", "agnostic")
    )
    assert aware == (3, 2, 1)  # that of .4 says truck
    assert agnostic == (4, 1, 0)


def test_truth_that_is_far_is_neither_hit_nor_miss():
    found = evaluated(EvaluationConfig(max_distance_m=15))
    assert counts(found)["multi-camera"] == (2, 0, 0)
    assert (found["truth_count"], found["dont_care_count"]) == (2, 2)
    assert found["by_distance"][-1]["stop"] == 15


def test_recall_by_distance():
    found = evaluated()
    recall = {
        (row["method"], row["start"], row["stop"]): (row["tp"], row["fn"], row["recall"])
        for row in found["by_distance"]
        if row["iou"] == 0.5
    }
    assert recall["single-camera", 0, 10] == (1, 0, 1.0)
    assert recall["single-camera", 10, 20] == (1, 0, 1.0)  # 10 m is here, 20 m is not
    assert recall["single-camera", 20, 40] == (0, 2, 0.0)
    assert recall["multi-camera", 20, 40] == (2, 0, 1.0)
    assert recall["without-tracking", 60, 80] == (0, 0, None)


def test_visible_boxes():
    visible = np.tile(np.array([VISIBLE], np.float32), (4, 1))
    found = evaluated(visible_xyxy_px=visible)
    # a whole box has an IoU of 1/4 with the visible quarter
    assert counts(found, truth="visible", iou=0.25)["multi-camera"] == (4, 0, 0)
    assert counts(found, truth="visible", iou=0.5)["multi-camera"] == (0, 4, 4)
    assert counts(found)["multi-camera"] == (4, 0, 0)
    shares = [row for row in found["by_visible_share"] if row["method"] == "multi-camera" and row["iou"] == 0.5]
    assert [(row["start"], row["tp"]) for row in shares] == [(0, 0), (0.25, 4), (0.5, 0), (0.75, 0)]


def test_identities_over_all_cameras():
    found = evaluated()
    assert found["tracking"] == pytest.approx({"hota": 1, "deta": 1, "assa": 1, "idf1": 1, "mota": 1, "id_switches": 0})
    assert found["merges"] == {"right": 1, "wrong": 0, "missed": 0}

    def apart() -> Iterator[LabelRows]:
        for part in label_parts():
            part.identity_id[:] = part.track_id
            yield part

    found = evaluated(labels=source(open_labels=apart))
    assert found["merges"] == {"right": 0, "wrong": 0, "missed": 1}
    # left, then front and left, then front: 11 -> 1 -> 11 -> 1
    assert (found["tracking"]["id_switches"], found["tracking"]["idf1"]) == (3, 0.5)


def test_curves_fall_with_the_threshold():
    (curve,) = (c for c in evaluated()["curves"] if (c["method"], c["iou"]) == ("without-tracking", 0.5))
    at = dict(zip(curve["threshold"], zip(curve["precision"], curve["recall"], strict=True), strict=True))
    assert at[0.97] == (1.0, 0.0)
    assert at[0.92] == (0.0, 0.0)  # the box on nothing comes first
    assert at[0.8] == (0.5, 0.25)
    # hits of .9, .6 and .5 come second, third and fourth: precision 1/2, 2/3, 3/4, best from there on 3/4 up to
    # recall 3/4 (recalls 0 to .75 are 76 of the 101)
    assert curve["average_precision"] == pytest.approx(76 * 0.75 / 101)


def test_a_drive_without_labels_has_no_precision():
    found = evaluated(labels=source(open_labels=lambda: iter(()), open_detections=lambda: iter(())))
    row = found["rows"][-1]
    assert (row["precision"], row["recall"], row["fn"]) == (None, 0.0, 2)
    assert found["tracking"]["hota"] == 0.0


@pytest.mark.parametrize("without", [None, Truth(None, None)])
def test_a_drive_without_truth_is_refused(without: Truth | None):
    with pytest.raises(
        EvaluationError, match=r"made has no true boxes in its images.*Evaluate a drive that comes with"
    ):
        evaluate_labels(source(), without, drive_name="made")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"confidence": 1.5}, "from 0 to 1, got 1.5"),
        ({"confidence": float("nan")}, "from 0 to 1"),
        ({"max_distance_m": 0}, "above 0 m"),
        ({"classes": "both"}, 'not "both"'),
    ],
)
def test_settings_that_make_no_sense(wrong: dict[str, Any], message: str):
    with pytest.raises(EvaluationError, match=message):
        EvaluationConfig(**wrong)
