from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labeler.drive import open_drive
from labeler.drive.types import Truth, TruthBoxes2D, TruthBoxes3D
from labeler.evaluation.truth import TruthTable, front_cameras, prepare_truth
from labeler.evaluation.types import EvaluationConfig

BOX = (0.0, 0.0, 10.0, 20.0)
NOTHING = (np.nan,) * 4


def truth_2d(**columns: Any) -> TruthBoxes2D:
    """Cars of 10 by 20 px, one in each frame of camera "front", with some columns put in their place."""
    count = max((len(column) for column in columns.values()), default=1)
    given: dict[str, Any] = {
        "frame_index": np.arange(count, dtype=np.int32),
        "camera": ("front",) * count,
        "track_uuid": tuple(f"car {row}" for row in range(count)),
        "category": ("CAR",) * count,
        "xyxy_px": np.tile(np.array([BOX], np.float32), (count, 1)),
    }
    return TruthBoxes2D(**(given | columns))


def prepared(boxes: TruthBoxes2D, boxes_3d: TruthBoxes3D | None = None, **config: Any) -> TruthTable:
    table = prepare_truth(Truth(boxes, boxes_3d), ("front", "left"), EvaluationConfig(**config))
    assert table is not None
    return table


def floats(*values: float) -> np.ndarray:
    return np.array(values, np.float32)


@pytest.mark.parametrize(
    ("columns", "counted"),
    [
        ({"distance_m": floats(79.9, 80, 80.1)}, [True, True, False]),  # too far to be hit or missed
        ({"distance_m": floats(np.nan)}, [True]),  # an unknown distance counts
        ({"category": ("CAR", "DontCare", "Misc")}, [True, False, False]),
        ({"visible_pixels": np.array([29, 30], np.int32)}, [False, True]),  # hardly a pixel to see
        # nothing to see: no visible box, or one without area
        ({"visible_xyxy_px": np.array([BOX, NOTHING, (3, 3, 3, 9)], np.float32)}, [True, False, False]),
    ],
)
def test_what_is_counted(columns: dict[str, Any], counted: list[bool]):
    assert prepared(truth_2d(**columns)).counted.tolist() == counted


def test_the_limits_are_settings():
    boxes = truth_2d(distance_m=floats(5, 15), visible_pixels=np.array([100, 100], np.int32))
    assert prepared(boxes, max_distance_m=10).counted.tolist() == [True, False]
    assert prepared(boxes, min_visible_pixels=101).counted.tolist() == [False, False]


def test_people_other_cameras_and_boxes_without_area_are_left_out():
    boxes = truth_2d(
        category=("CAR", "PERSON", "CAR", "CAR"),
        camera=("front", "front", "rear", "front"),
        xyxy_px=np.array([BOX, BOX, BOX, (5, 5, 5, 9)], np.float32),
    )
    assert prepared(boxes).image.tolist() == [0]


def test_rows_are_in_order_of_images():
    boxes = truth_2d(
        frame_index=np.array([1, 0, 0], np.int32), camera=("front", "left", "front"), track_uuid=("a", "a", "b")
    )
    table = prepared(boxes)
    assert table.image.tolist() == [0, 1, 2]  # frame 0 front, frame 0 left, frame 1 front
    assert table.camera.tolist() == [0, 1, 0]
    assert table.object_id.tolist() == [1, 0, 0]  # a has one number in all images


def test_the_distance_comes_from_the_3d_box_where_the_2d_box_has_none():
    boxes_3d = TruthBoxes3D(
        frame_index=np.array([0], np.int32),
        track_uuid=("car 0",),
        category=("CAR",),
        center_m=np.array([[3.0, 4.0, 12.0]]),
        size_m=np.ones((1, 3)),
        yaw_rad=np.zeros(1),
    )
    distance_m = prepared(truth_2d(track_uuid=("car 0", "car 1")), boxes_3d).distance_m
    assert distance_m[0] == 5.0  # on the ground: the height does not matter
    assert np.isnan(distance_m[1])


def test_the_visible_share():
    half = np.array([(0, 0, 10, 10), NOTHING], np.float32)
    share = prepared(truth_2d(visible_xyxy_px=half)).visible_share
    assert share is not None
    assert share.tolist() == [0.5, 0.0]  # of the box
    share = prepared(truth_2d(visible_xyxy_px=half, visible_share=floats(0.25, 0))).visible_share
    assert share is not None
    assert share.tolist() == [0.25, 0.0]  # as recorded
    assert prepared(truth_2d()).visible_share is None


def test_boxes_of_visible_parts():
    table = prepared(truth_2d(visible_xyxy_px=np.array([(1, 2, 3, 4), NOTHING], np.float32)))
    assert table.boxes_px("whole").tolist() == [list(BOX), list(BOX)]
    assert table.boxes_px("visible").tolist() == [[1, 2, 3, 4], list(BOX)]  # what is hidden absorbs with all of it
    with pytest.raises(ValueError, match="no boxes of visible parts"):
        prepared(truth_2d()).boxes_px("visible")


def test_without_boxes_in_images_there_is_no_table():
    assert prepare_truth(Truth(None, None), ("front",), EvaluationConfig()) is None


@pytest.mark.real_drive
def test_the_truth_of_a_real_drive(tri_scene_01: Path):
    drive = open_drive(tri_scene_01)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    table = prepare_truth(truth, [camera.name for camera in drive.cameras], EvaluationConfig())
    assert table is not None
    assert len(table) == 152 + 3  # cars and buses; four persons are left out
    # its 2D boxes have no distance, its 3D boxes do: each object stands in both
    assert np.isfinite(table.distance_m).all()
    assert int(table.counted.sum()) == int((table.distance_m <= 80).sum()) == 122


@pytest.mark.parametrize(
    ("cameras", "front"),
    [
        (("front", "left", "rear"), (0,)),
        (("CAM_BACK", "CAM_FRONT", "CAM_FRONT_LEFT"), (1,)),
        (("ring_front_center", "ring_front_right", "stereo_front_left"), (0,)),
        (("image_02",), (0,)),  # the only one
        (("east", "west"), ()),
    ],
)
def test_front_cameras(cameras: tuple[str, ...], front: tuple[int, ...]):
    assert front_cameras(cameras) == front
