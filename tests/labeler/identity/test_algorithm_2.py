"""Tracks 1 to 9 are of camera front, 11 to 19 of left, 21 to 29 of rear. An object is (track, class, x)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest

from labeler.identity import (
    Algorithm2Config,
    CameraView,
    Merges,
    MultiCameraFrame,
)
from labeler.identity.algorithm_2 import merge_at_same_place
from labeler.lidar import Boxes3D
from labeler.tracking.types import NO_DETECTION, Observations

PERSON, CAR, TRUCK = range(3)
CLASS_GROUPS = (0, 1, 1)
CONFIG = Algorithm2Config()
Object = tuple[int, int, float | None]
Frames = Sequence[Mapping[str, Sequence[Object]]]


def view(frame_index: int, objects: Sequence[Object]) -> CameraView:
    """Detections come in reverse order of the tracks, so that rows of the two tables differ. Without x, no 3D box."""
    count = len(objects)
    rows = np.arange(count, dtype=np.int32)
    observations = Observations(
        track_id=np.array([track for track, _, _ in objects], np.int32),
        frame_index=np.full(count, frame_index, np.int32),
        xyxy_px=np.zeros((count, 4), np.float32),
        score=np.full(count, 0.9, np.float32),
        class_id=np.array([class_id for _, class_id, _ in objects], np.int16),
        detection_index=count - 1 - rows,
    )
    solid = [(count - 1 - row, class_id, x) for row, (_, class_id, x) in enumerate(objects) if x is not None]
    boxes_3d = Boxes3D(
        center_m=np.array([[x, 0, 0] for _, _, x in solid], np.float32).reshape(-1, 3),
        size_m=np.tile(np.array([4, 2, 1.5], np.float32), (len(solid), 1)),
        yaw_rad=np.zeros(len(solid), np.float32),
        score=np.ones(len(solid), np.float32),
        class_id=np.array([class_id for _, class_id, _ in solid], np.int16),
        num_points=np.full(len(solid), 10, np.int32),
        detection_index=np.array([detection for detection, _, _ in solid], np.int32),
        source=np.zeros(len(solid), np.int8),
        center_std_m=np.full((len(solid), 2), 0.2, np.float32),
        yaw_std_rad=np.full(len(solid), 0.1, np.float32),
        seen_m=np.tile(np.array([-2, -1, 2, 1], np.float32), (len(solid), 1)),
        offset_s=np.zeros(len(solid), np.float32),
    )
    return CameraView(observations, boxes_3d)


def decide(frames: Frames, config: Algorithm2Config = CONFIG) -> Merges:
    def stream() -> Iterator[MultiCameraFrame]:
        for index, cameras in enumerate(frames):
            yield MultiCameraFrame(index, {name: view(index, objects) for name, objects in cameras.items()})

    return merge_at_same_place(stream(), config, class_groups=CLASS_GROUPS)


def states(merges: Merges) -> list[tuple[int, int, str]]:
    return [(proposal.track_a, proposal.track_b, proposal.state.value) for proposal in merges.proposals]


AGREE = {"front": [(1, CAR, 10.0)], "left": [(11, CAR, 10.2)]}
DISAGREE = {"front": [(1, CAR, 10.0)], "left": [(11, CAR, 30.0)]}


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        ([AGREE] * 3, [(1, 11, "accepted")]),  # always at one place
        ([DISAGREE] * 3, []),  # never
        ([AGREE], [(1, 11, "proposed")]),  # once may be chance: for a person
        ([AGREE] * 2, [(1, 11, "accepted")]),  # twice is enough
        ([AGREE, AGREE, DISAGREE, DISAGREE], [(1, 11, "proposed")]),  # half of the time: for a person
        ([AGREE] + [DISAGREE] * 6, []),  # two objects that met once
        ([DISAGREE] * 6 + [AGREE], []),  # the same the other way round: frames before the first meeting count too
        ([{"front": [(1, CAR, 10.0)], "left": [(11, PERSON, 10.0)]}] * 3, []),  # a person is no car
        ([{"front": [(1, CAR, 10.0)], "left": [(11, TRUCK, 10.0)]}] * 3, [(1, 11, "accepted")]),  # car and truck may be
        ([{"front": [(1, CAR, 10.0), (2, CAR, 10.1)]}] * 3, []),  # one camera alone says nothing
        ([{"front": [(1, CAR, 10.0)], "left": [(11, CAR, None)]}] * 3, []),  # no 3D box, no evidence
        ([], []),  # no frames
    ],
)
def test_what_becomes_of_two_tracks(frames: Frames, expected: list[tuple[int, int, str]]):
    assert states(decide(frames)) == expected


def test_a_track_that_is_a_person_most_of_the_time_is_not_merged_with_a_car_by_a_few_frames():
    car = {"front": [(1, CAR, 10.0)], "left": [(11, CAR, 10.0)]}
    person = {"front": [(1, CAR, 10.0)], "left": [(11, PERSON, 10.0)]}
    assert states(decide([car, car, person, person, person])) == []


def test_a_merge_carries_its_evidence():
    merges = decide([AGREE, DISAGREE, {"front": [(1, CAR, 10.0)], "left": [(11, CAR, 11.0)]}])
    (proposal,) = merges.proposals
    assert (proposal.camera_a, proposal.camera_b) == ("front", "left")
    assert (proposal.shared_frames, proposal.agreeing_frames) == (3, 2)
    # 0.2 m apart: 1 - 0.2 / 2 = 0.9, shared 3.8 of 4.2 m = 0.905; 1 m apart: 3 of 5 m = 0.6.
    assert [frame.frame_index for frame in proposal.best_frames] == [0, 2]
    assert [frame.bev_iou for frame in proposal.best_frames] == pytest.approx([0.905, 0.6], abs=1e-3)
    assert proposal.mean_distance_m == pytest.approx(0.6, abs=1e-3)
    assert proposal.mean_bev_iou == pytest.approx(0.752, abs=1e-3)
    assert proposal.score == pytest.approx((0.905 + 0.6) / 3 * 3 / 3.25, abs=1e-3)
    assert "2 of 3 shared frames" in proposal.reason


def test_only_the_best_frames_are_kept():
    frames: Frames = [{"front": [(1, CAR, 10.0)], "left": [(11, CAR, 10.0 + x)]} for x in (0.5, 0.1, 0.4, 0.2, 0.3)]
    (proposal,) = decide(frames).proposals
    assert [frame.frame_index for frame in proposal.best_frames] == [1, 3, 4]


def test_all_tracks_have_an_identity_and_any_two_cameras_are_compared():
    frames: Frames = [
        {
            "front": [(1, CAR, 10.0), (2, CAR, 50.0)],
            "left": [(11, CAR, 10.0)],
            "rear": [(21, CAR, 10.1), (22, CAR, None)],
        }
    ]
    merges = decide([*frames, *frames])
    assert merges.identity_of == {1: 1, 2: 2, 11: 1, 21: 1, 22: 22}


def test_the_better_merge_wins_and_the_other_says_why_not():
    # 11 lies on 1 in the first frames and on 2, which stands beside 1, in the last one.
    first = {"front": [(1, CAR, 10.0), (2, CAR, 20.0)], "left": [(11, CAR, 10.0)]}
    last = {"front": [(1, CAR, 30.0), (2, CAR, 10.0)], "left": [(11, CAR, 10.0)]}
    merges = decide([first, first, last])
    assert states(merges) == [(1, 11, "accepted"), (2, 11, "rejected")]
    assert merges.proposals[0].score > merges.proposals[1].score
    reason = merges.proposals[1].reason
    assert "tracks 2 and 1 share a frame of front" in reason
    assert "1 with 11 (score 0.62)" in reason
    assert merges.identity_of == {1: 1, 2: 2, 11: 1}


def test_the_rule_holds_by_way_of_a_third_camera():
    # 1 = 11 and 11 = 21 are sure, so 2 = 21 would make 1 and 2 one, which stand side by side.
    together: dict[str, list[Object]] = {
        "front": [(1, CAR, 10.0), (2, CAR, 20.0)], "left": [(11, CAR, 10.0)], "rear": [(21, CAR, None)],
    }  # fmt: skip
    handed_over: dict[str, list[Object]] = {"left": [(11, CAR, 10.0)], "rear": [(21, CAR, 10.1)]}
    wrong: dict[str, list[Object]] = {"front": [(2, CAR, 40.0)], "rear": [(21, CAR, 41.0)]}
    merges = decide([together, together, handed_over, handed_over, wrong])
    assert states(merges) == [(1, 11, "accepted"), (11, 21, "accepted"), (2, 21, "rejected")]
    assert "1 with 11" in merges.proposals[2].reason
    assert "11 with 21" in merges.proposals[2].reason
    assert merges.identity_of == {1: 1, 2: 2, 11: 1, 21: 1}


def test_an_observation_that_the_tracker_filled_in_owns_no_box():
    frame = view(0, [(1, CAR, 10.0)])
    filled = Observations(
        frame.observations.track_id,
        frame.observations.frame_index,
        frame.observations.xyxy_px,
        np.full(1, np.nan, np.float32),
        frame.observations.class_id,
        np.full(1, NO_DETECTION, np.int32),
    )
    views = {"front": CameraView(filled, frame.boxes_3d), "left": view(0, [(11, CAR, 10.0)])}
    merges = merge_at_same_place([MultiCameraFrame(0, views)], CONFIG, class_groups=CLASS_GROUPS)
    assert merges.proposals == ()
    assert merges.identity_of == {1: 1, 11: 11}


def test_a_class_without_a_group_is_an_error():
    with pytest.raises(ValueError, match="class 7"):
        decide([{"front": [(1, 7, 10.0)]}])


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("propose_score", 0.6),  # above accept_score
        ("accept_score", 1.2),  # beyond any score
        ("min_similarity", 0.0),  # everything would be at the same place
        ("best_frames", 0),  # no evidence
    ],
)
def test_settings_out_of_range_are_refused(name: str, value: float):
    with pytest.raises(ValueError, match="Algorithm2Config needs"):
        replace(CONFIG, **{name: value})
