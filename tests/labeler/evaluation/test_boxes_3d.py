from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, Frame, SweepFile
from labeler.drive.types import Calibration, Camera, ImageFile, Sweep, Truth, TruthBoxes2D, TruthBoxes3D
from labeler.evaluation.boxes_3d import BoxReport
from labeler.evaluation.boxes_3d_cases import Seen, judge_makers
from labeler.evaluation.types import EvaluationError
from labeler.geometry.se3 import se3
from labeler.lidar import Boxes3D, BoxSource

CAR_M = (4.0, 2.0, 1.5)
CALIBRATION = Calibration(np.array([[100.0, 0, 200], [0, 100, 100], [0, 0, 1]]), se3(np.eye(3), [0, 0, 0]))
PLACES_M = {"near": (10.0, 0.0), "cut": (20.0, 5.0), "far": (60.0, 0.0)}
BOXES_PX = {"near": (180, 80, 220, 120), "cut": (0, 80, 40, 120), "far": (190, 90, 200, 95)}


def points_of(name: str, count: int) -> np.ndarray:
    x, y = PLACES_M[name]
    return np.stack([np.linspace(x - 1.9, x + 1.9, count), np.full(count, y), np.full(count, 0.5)], axis=1)


def drive(*, truth: bool = True) -> Drive:
    """One frame, one camera, three cars: with 30, 25 and 50 LiDAR points."""
    frame = Frame(0, 0, {"front": ImageFile("front", 0, Path("none"))}, SweepFile(0, Path("none")))
    xyz_m = np.concatenate([points_of("near", 30), points_of("cut", 25), points_of("far", 50)]).astype(np.float32)
    names = tuple(PLACES_M)
    known = Truth(
        TruthBoxes2D(
            frame_index=np.zeros(3, np.int32),
            camera=("front",) * 3,
            track_uuid=names,
            category=("REGULAR_VEHICLE",) * 3,
            xyxy_px=np.array([BOXES_PX[name] for name in names], np.float32),
        ),
        TruthBoxes3D(
            frame_index=np.zeros(3, np.int32),
            track_uuid=names,
            category=("REGULAR_VEHICLE",) * 3,
            center_m=np.array([[*PLACES_M[name], 0.75] for name in names]),
            size_m=np.tile(np.array(CAR_M), (3, 1)),
            yaw_rad=np.zeros(3),
        ),
    )
    return Drive(
        name="made", format="made", root=Path("made"), cameras=(Camera("front", 400, 200, CALIBRATION),),
        frames=(frame,), poses=None, read_sweep=lambda file: Sweep(0, xyz_m, np.zeros(len(xyz_m), np.float32)),
        read_truth=lambda frames: known if truth else None,
    )  # fmt: skip


def boxes(*rows: tuple[int, float, float, float]) -> Boxes3D:
    """Boxes of a car's size from (detection, x, y, yaw in degrees), the first the surest."""
    count = len(rows)
    return Boxes3D(
        center_m=np.array([[x, y, 0.75] for _, x, y, _ in rows], np.float32),
        size_m=np.tile(np.array(CAR_M, np.float32), (count, 1)),
        yaw_rad=np.radians([yaw for *_, yaw in rows]).astype(np.float32),
        score=np.linspace(0.9, 0.5, count).astype(np.float32),
        class_id=np.zeros(count, np.int16),
        num_points=np.full(count, 30, np.int32),
        detection_index=np.array([detection for detection, *_ in rows], np.int32),
        source=np.full(count, BoxSource.CLUSTER, np.int8),
        center_std_m=np.full((count, 2), 0.2, np.float32),
        yaw_std_rad=np.full(count, 0.1, np.float32),
        seen_m=np.zeros((count, 4), np.float32),
        offset_s=np.zeros(count, np.float32),
    )


def judged(found: Boxes3D) -> BoxReport:
    return judge_makers(drive(), {"told": lambda *_: {"front": found}}, Seen())["told"]


def test_each_true_object_is_judged_by_the_box_of_its_own_detection():
    # The first is off by 0.3 m along its length and turned by 180 degrees: an IoU of 3.7 / 4.3. The second has no box.
    report = judged(boxes((0, 10.3, 0, 180), (2, 61.0, 0, 0)))
    assert (report.overall.cases, report.overall.boxed, report.overall.good) == (2, 0.5, 0.5)
    assert report.overall.median_error_m == pytest.approx(0.3, abs=1e-3)
    assert report.overall.median_yaw_off_deg == pytest.approx(0, abs=1e-3)
    groups = {group.group: group for group in report.groups}
    assert (groups["inside of the image"].cases, groups["cut by the border"].cases) == (1, 1)
    assert groups["cut by the border"].median_error_m is None
    assert groups["60-80 m, any points"].median_error_m == pytest.approx(1.0, abs=1e-3)


def test_a_box_at_the_place_of_another_object_is_no_hit_for_its_detection_but_one_for_the_average_precision():
    report = judged(boxes((0, 20.0, 5.0, 0)))
    assert report.overall.good == 0
    assert report.average_precision == pytest.approx(51 / 101)  # one of two found, precision 1 up to recall .5


def test_a_drive_without_truth_is_refused_with_what_to_do():
    with pytest.raises(EvaluationError, match="hindsight simulate"):
        judge_makers(drive(truth=False), {"none": lambda *_: {}}, Seen())
