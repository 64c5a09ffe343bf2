from dataclasses import replace

import numpy as np
import pytest

from labeler.drive.types import TruthBoxes2D
from labeler.evaluation.merges import MergeScore, is_vehicle, score_merges
from labeler.tracking.types import NO_DETECTION, Observations

# Each object has its own place in every image, so that a box at its place matches it.
PLACE = {"a": 0.0, "b": 100.0, "c": 200.0, "walker": 300.0, "nothing": 400.0}


def box(name: str, shift_px: float = 0.0) -> list[float]:
    x = PLACE[name] + shift_px
    return [x, 0, x + 40, 40]


def truth(*rows: tuple[int, str, str]) -> TruthBoxes2D:
    """Rows of frame, camera and object."""
    return TruthBoxes2D(
        frame_index=np.array([frame for frame, _, _ in rows], np.int32),
        camera=tuple(camera for _, camera, _ in rows),
        track_uuid=tuple(name for _, _, name in rows),
        category=tuple("PEDESTRIAN" if name == "walker" else "CAR" for _, _, name in rows),
        xyxy_px=np.array([box(name) for _, _, name in rows], np.float32).reshape(-1, 4),
    )


def observations(*rows: tuple[int, int, str]) -> Observations:
    """Rows of track, frame and the object that the track's box lies on."""
    count = len(rows)
    return Observations(
        track_id=np.array([track for track, _, _ in rows], np.int32),
        frame_index=np.array([frame for _, frame, _ in rows], np.int32),
        xyxy_px=np.array([box(name, 5) for _, _, name in rows], np.float32).reshape(-1, 4),
        score=np.full(count, 0.9, np.float32),
        class_id=np.zeros(count, np.int16),
        detection_index=np.full(count, NO_DETECTION, np.int32),
    )


BOTH = truth(*[(0, camera, name) for camera in ("front", "left") for name in ("a", "b", "walker")], (0, "left", "c"))
FRONT = observations((1, 0, "a"), (2, 0, "b"), (3, 0, "walker"))
LEFT = observations((11, 0, "a"), (12, 0, "b"), (13, 0, "walker"), (14, 0, "c"))


@pytest.mark.parametrize(
    ("identity_of", "expected"),
    [
        ({11: 1, 12: 2}, MergeScore(2, 2, 0, 0, 0)),  # both cars found; the walker and c, in one camera, don't count
        ({11: 1}, MergeScore(2, 1, 1, 0, 0)),  # b was tracked in both cameras and yet missed
        ({}, MergeScore(2, 0, 2, 0, 0)),  # a track that is not named is its own
        ({12: 1}, MergeScore(2, 0, 2, 0, 1)),  # a with b
        ({11: 1, 12: 1}, MergeScore(2, 1, 1, 0, 1)),  # a rightly found, b drawn into it
        ({13: 3}, MergeScore(2, 0, 2, 0, 0)),  # a walker rightly merged is neither found nor wrong
        ({13: 1}, MergeScore(2, 0, 2, 0, 1)),  # a walker with a car is wrong
        ({14: 2}, MergeScore(2, 0, 2, 0, 1)),  # so is a car that stands in one camera only
    ],
)
def test_found_missed_and_wrong(identity_of: dict[int, int], expected: MergeScore):
    assert score_merges(BOTH, {"front": [FRONT], "left": [LEFT]}, identity_of) == expected


def test_a_vehicle_without_a_track_in_two_cameras_could_not_be_found():
    score = score_merges(BOTH, {"front": [FRONT], "left": [observations((11, 0, "a"))]}, {11: 1})
    assert score == MergeScore(vehicles=2, found=1, missed=1, not_tracked=1, wrong_merges=0)
    assert score.sentence() == (
        "Of 2 vehicles that stand in two or more cameras 1 were found, 1 missed "
        "(1 of them not tracked in two cameras); 0 wrongly merged."
    )


def test_a_track_is_what_most_of_its_boxes_lie_on():
    true = truth(*[(frame, camera, name) for frame in range(3) for camera in ("front", "left") for name in ("a", "b")])
    mixed = observations((1, 0, "a"), (1, 1, "b"), (1, 2, "b"))
    left = (observations((11, frame, "b")) for frame in range(3))  # one part a frame, read once
    assert score_merges(true, {"front": [mixed], "left": left}, {11: 1}).found == 1


def test_a_track_on_nothing_makes_no_merge_wrong():
    left = observations((11, 0, "a"), (15, 0, "nothing"))
    assert score_merges(BOTH, {"front": [FRONT], "left": [left]}, {11: 1, 15: 1}).wrong_merges == 0


def test_two_parts_of_one_track_in_one_camera_are_not_two_cameras():
    front = observations((1, 0, "a"), (4, 1, "a"))
    true = truth((0, "front", "a"), (1, "front", "a"), (0, "left", "a"))
    assert score_merges(true, {"front": [front], "left": []}, {4: 1}) == MergeScore(1, 0, 1, 1, 0)


def test_no_truth_and_no_tracks_are_no_error():
    assert score_merges(truth(), {"front": []}, {}) == MergeScore(0, 0, 0, 0, 0)


@pytest.mark.parametrize(
    ("category", "vehicle"),
    [
        ("CAR", True),  # our drives
        ("BUS_RV_CARAVAN", True),
        ("REGULAR_VEHICLE", True),  # Argoverse 2
        ("MOTORCYCLE", True),
        ("PEDESTRIAN", False),
        ("BICYCLIST", False),
        ("CONSTRUCTION_CONE", False),
        ("vehicle.car", True),  # nuScenes
        ("human.pedestrian.adult", False),
        ("movable_object.barrier", False),
        ("Van", True),  # KITTI
        ("Person_sitting", False),
        ("Cyclist", False),
        ("DontCare", False),
    ],
)
def test_which_categories_are_vehicles(category: str, vehicle: bool):
    assert is_vehicle(category) is vehicle


def test_what_hardly_shows_is_not_seen():
    """Two pixels of car b show in the left image: a box there is of whatever hides it."""
    views = zip(BOTH.camera, BOTH.track_uuid, strict=True)
    hidden = replace(BOTH, visible_pixels=np.array([2 if view == ("left", "b") else 500 for view in views], np.int32))

    assert score_merges(hidden, {"front": [FRONT], "left": [LEFT]}, {11: 1, 12: 2}) == MergeScore(1, 1, 0, 0, 0)
