"""Two cameras on one car: front looks along x, left along y; a car is a box 4 x 2 m at a place in the city."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.drive.types import Calibration, Camera
from labeler.geometry.se3 import se3
from labeler.identity import (
    CameraView,
    Decisions,
    IdentityConfig,
    MergeKind,
    MergeProposal,
    Merges,
    MergeState,
    MultiCameraFrame,
    Rig,
    TrackAnchor,
    find_merges,
)
from labeler.lidar.types import Boxes3D, Positions3D
from labeler.tracking.types import Observations

WIDTH, FOCAL = 800, 300.0
AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
LEFT = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
INTRINSICS = np.array([[FOCAL, 0, WIDTH / 2], [0, FOCAL, 200], [0, 0, 1]])
CAMERAS = {
    "front": Camera("front", WIDTH, 400, Calibration(INTRINSICS, se3(AXES, [0, 0, 1.5]))),
    "left": Camera("left", WIDTH, 400, Calibration(INTRINSICS, se3(LEFT @ AXES, [0, 0, 1.5]))),
}
CONFIG = IdentityConfig(method="assignment")
Seen = tuple[int, float, float]  # track, x and y in the ego frame


def view(camera: str, frame: int, seen: list[Seen]) -> CameraView:
    """Boxes of 40 pixels around where each car appears, and exact 3D boxes."""
    count = len(seen)
    x_px = [(-y / x if camera == "front" else x / y) * FOCAL + WIDTH / 2 for _, x, y in seen]
    center_m = np.array([[x, y, 0.8] for _, x, y in seen], np.float32).reshape(-1, 3)
    return CameraView(
        Observations(
            np.array([track for track, _, _ in seen], np.int32),
            np.full(count, frame, np.int32),
            np.array([[x - 20, 180, x + 20, 220] for x in x_px], np.float32).reshape(-1, 4),
            np.full(count, 0.8, np.float32),
            np.zeros(count, np.int16),
            np.arange(count, dtype=np.int32),
        ),
        Boxes3D(
            center_m=center_m,
            size_m=np.tile(np.array([4, 2, 1.6], np.float32), (count, 1)),
            yaw_rad=np.zeros(count, np.float32),
            score=np.ones(count, np.float32),
            class_id=np.zeros(count, np.int16),
            num_points=np.full(count, 50, np.int32),
            detection_index=np.arange(count, dtype=np.int32),
            source=np.zeros(count, np.int8),
            center_std_m=np.full((count, 2), 0.3, np.float32),
            yaw_std_rad=np.full(count, 0.1, np.float32),
            seen_m=np.zeros((count, 4), np.float32),
            offset_s=np.zeros(count, np.float32),
        ),
        Positions3D(
            detection_index=np.arange(count, dtype=np.int32),
            position_m=center_m,
            position_cov_m2=np.tile(np.array([0.09, 0, 0.09], np.float32), (count, 1)),
            position_source=np.zeros(count, np.int8),
            position_offset_s=np.zeros(count, np.float32),
        ),
    )


def merge(
    frames: list[dict[str, list[Seen]]],
    *,
    poses: NDArray[np.float64] | None = None,
    decisions: Decisions | None = None,
    config: IdentityConfig = CONFIG,
) -> Merges:
    stream = [
        MultiCameraFrame(index, {camera: view(camera, index, seen) for camera, seen in views.items()})
        for index, views in enumerate(frames)
    ]
    times_ns = np.arange(len(frames)) * 100_000_000
    poses = np.tile(np.eye(4), (len(frames), 1, 1)) if poses is None else poses
    rig = Rig(CAMERAS, times_ns, poses)
    return find_merges(stream, config, class_groups=(0,), rig=rig, decisions=decisions)


def proposal_of(merges: Merges, a: int, b: int) -> MergeProposal:
    return next(proposal for proposal in merges.proposals if (proposal.track_a, proposal.track_b) == (a, b))


TOGETHER: list[dict[str, list[Seen]]] = [
    {"front": [(1, 10.0, 9.0), (2, 20.0, 0.0)], "left": [(11, 10.0, 9.2), (12, 0.0, 15.0)]} for _ in range(12)
]


def test_two_cameras_at_one_place_are_one_object():
    merges = merge(TOGETHER)
    assert merges.identity_of == {1: 1, 2: 2, 11: 1, 12: 12}
    found = proposal_of(merges, 1, 11)
    assert found.state is MergeState.ACCEPTED
    assert found.evidence.kind is MergeKind.OVERLAP
    assert (found.shared_frames, found.agreeing_frames) == (12, 12)
    assert found.mean_distance_m == pytest.approx(0.2, abs=1e-5)
    # 4 x 2 m boxes 0.2 m apart across: shared 4 * 1.8 = 7.2 of 8.8 square metres.
    assert found.mean_bev_iou == pytest.approx(7.2 / 8.8, abs=1e-3)


def test_the_score_is_what_the_features_add_up_to():
    evidence = proposal_of(merge(TOGETHER), 1, 11)
    total = evidence.evidence.bias_log_odds + sum(feature.log_odds for feature in evidence.evidence.features)
    assert evidence.score == pytest.approx(1 / (1 + np.exp(-min(total, 9.0))), abs=1e-3)
    by_name = {feature.name: feature.value for feature in evidence.evidence.features}
    assert by_name["distance_m"] == pytest.approx(0.2, abs=1e-4)
    assert by_name["rival_share"] == 0
    assert by_name["outside_box"] == 0


def test_the_plot_shows_both_in_the_frame_of_the_car():
    # The car has driven 100 m and turned left by a quarter: what it sees stays where it is in its own frame.
    pose = se3(LEFT, [100.0, 50.0, 0.0])
    plot = proposal_of(merge(TOGETHER, poses=np.tile(pose, (12, 1, 1))), 1, 11).evidence.plot
    assert plot is not None
    assert plot.track_a[0][1:3] == pytest.approx((10, 9), abs=0.02)
    assert plot.track_b[-1][1:3] == pytest.approx((10, 9.2), abs=0.02)
    assert plot.boxes_b[0][1:] == pytest.approx((10, 9.2, 4, 2, 0), abs=0.01)
    assert plot.ego[0][1:] == pytest.approx((0, 0, 0), abs=1e-6)


def handed_over(gap: int) -> list[dict[str, list[Seen]]]:
    """A car passes at 10 m/s from ahead to the left side, out of sight for ``gap`` frames between the cameras."""
    frames: list[dict[str, list[Seen]]] = []
    for frame in range(20 + gap + 20):
        x_m = 30.0 - frame
        seen_ahead, seen_aside = frame < 20, frame >= 20 + gap
        frames.append(
            {
                "front": [(1, x_m, 4.0)] if seen_ahead else [],
                "left": [(11, x_m, 4.0)] if seen_aside else [],
            }
        )
    return frames


def test_front_gap_left_is_one_object():
    merges = merge(handed_over(6))
    assert merges.identity_of == {1: 1, 11: 1}
    found = proposal_of(merges, 1, 11)
    assert found.evidence.kind is MergeKind.HANDOVER
    assert found.evidence.gap_s == pytest.approx(0.7)
    assert found.evidence.gap_frames == (19, 26)
    assert (found.shared_frames, found.mean_distance_m, found.mean_bev_iou) == (0, None, None)
    assert "lost in front and seen again in left 0.7 s later" in found.reason


def test_without_poses_nothing_is_merged_over_time():
    stream = [
        MultiCameraFrame(index, {camera: view(camera, index, seen) for camera, seen in views.items()})
        for index, views in enumerate(handed_over(6))
    ]
    rig = Rig(CAMERAS, np.arange(len(stream)) * 100_000_000, None)
    merges = find_merges(stream, CONFIG, class_groups=(0,), rig=rig)
    assert merges.proposals == ()


def test_a_track_lost_and_found_in_one_camera_is_one_object():
    frames: list[dict[str, list[Seen]]] = [
        {"front": [(1 if frame < 15 else 2, 20.0 + 0.5 * frame, 2.0)] if not 15 <= frame < 20 else []}
        for frame in range(40)
    ]
    merges = merge(frames)
    assert merges.identity_of == {1: 1, 2: 1}
    assert proposal_of(merges, 1, 2).evidence.kind is MergeKind.FRAGMENT


def test_two_tracks_of_one_image_never_become_one():
    # Both 1 and 2 of the front camera lie on 11 of the left one.
    frames: list[dict[str, list[Seen]]] = [
        {"front": [(1, 10.0, 9.0), (2, 10.0, 9.6)], "left": [(11, 10.0, 9.0)]} for _ in range(12)
    ]
    merges = merge(frames)
    assert merges.identity_of[1] != merges.identity_of[2]
    assert merges.identity_of[11] == merges.identity_of[1]


def anchors(*tracks: tuple[str, float, float]) -> list[TrackAnchor]:
    found: list[TrackAnchor] = []
    for camera, x, y in tracks:
        x_px = (-y / x if camera == "front" else x / y) * FOCAL + WIDTH / 2
        found.append(TrackAnchor(camera, (3, 7), ((x_px - 20, 180, x_px + 20, 220),) * 2))
    return found


def test_a_person_wins_over_the_machine():
    one, other, far, aside = anchors(("front", 10, 9), ("left", 10, 9.2), ("front", 20, 0), ("left", 0, 15))
    apart = merge(TOGETHER, decisions=Decisions(different=((one, other),)))
    assert apart.identity_of == {1: 1, 2: 2, 11: 11, 12: 12}
    assert proposal_of(apart, 1, 11).state is MergeState.ACCEPTED  # the machine's own word, should it be taken back
    joined = merge(TOGETHER, decisions=Decisions(same=((far, aside),)))
    assert joined.identity_of == {1: 1, 2: 2, 11: 1, 12: 2}


def test_the_paper_s_method_is_there_by_name():
    merges = merge(TOGETHER, config=CONFIG.with_method("baseline"))
    assert merges.identity_of == {1: 1, 2: 2, 11: 1, 12: 12}
    assert not proposal_of(merges, 1, 11).evidence.calibrated


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("method", "magic", "no identity method 'magic'"),
        ("accept_probability", 0.2, "accept_probability"),  # below the one for proposals
        ("accept_probability", 1.0, "accept_probability"),  # nothing is that sure
        ("max_gap_s", 99.0, "max_still_gap_s"),  # what moves is lost sooner than what stands
    ],
)
def test_settings_out_of_range_are_refused(name: str, value: object, message: str):
    with pytest.raises(ValueError, match=message):
        partial(replace, CONFIG)(**{name: value})
