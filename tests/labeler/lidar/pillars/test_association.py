"""Boxes and detections find each other in an image of 400 x 200, focal length 100 px."""

import numpy as np
import pytest

from labeler.drive.types import Calibration, Camera
from labeler.geometry.se3 import se3
from labeler.lidar import View
from labeler.lidar.pillars.association import associate, projected

AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
VIEW = View.of(
    Camera("front", 400, 200, Calibration(np.array([[100.0, 0, 200], [0, 100, 100], [0, 0, 1]]), se3(AHEAD, [0, 0, 0])))
)
NEAR, FAR = (11.0, 0.0, 0.0), (21.0, 1.0, 0.0)
SIZE = (2.0, 2.0, 2.0)
# Near faces are 10 and 20 m away: 20 px and 10 px wide and tall around 0 and 1 m to the left.
NEAR_PX, FAR_PX = (190.0, 90.0, 210.0, 110.0), (190.0, 95.0, 200.0, 105.0)


def front_of(center_m: tuple[float, float, float], *, left_half: bool = False) -> np.ndarray:
    y = np.linspace(0.1 if left_half else -0.9, 0.9, 7)
    return np.array([[center_m[0] - 1, center_m[1] + a, b] for a in y for b in (-0.5, 0, 0.5)], np.float32)


def found(
    boxes: list[tuple[float, float, float]], points: list[np.ndarray], detected_px: list[tuple[float, ...]]
) -> list[int]:
    rows, merit = associate(
        np.array(boxes).reshape(-1, 3), np.tile(SIZE, (len(boxes), 1)), np.zeros(len(boxes)), points,
        np.array(detected_px, np.float32).reshape(-1, 4), VIEW,
    )  # fmt: skip
    assert ((merit > 0) == (rows >= 0)).all()
    return rows.tolist()


def test_a_box_is_projected_and_cut_by_the_edge() -> None:
    boxes_px = projected(np.array([NEAR, (11.0, -20.0, 0.0)]), np.tile(SIZE, (2, 1)), np.zeros(2), VIEW)
    np.testing.assert_allclose(boxes_px, [NEAR_PX, (200 + 19 / 12 * 100, 90, 400, 110)], atol=0.01)


@pytest.mark.parametrize(
    ("boxes", "points", "detected_px", "expected"),
    [
        ([NEAR], [front_of(NEAR)], [NEAR_PX], [0]),
        # Two detections, in the other order: each gets its own.
        ([NEAR, FAR], [front_of(NEAR), front_of(FAR)], [FAR_PX, NEAR_PX], [1, 0]),
        # The far one is detected alone, in front of which nothing stands: the near box is not its.
        ([NEAR], [front_of(NEAR)], [FAR_PX], [-1]),
        # Half hidden: the detection is of the visible half, and so are the points.
        ([NEAR], [front_of(NEAR, left_half=True)], [(190.0, 90.0, 200.0, 110.0)], [0]),
        ([NEAR], [front_of(NEAR)], [(300.0, 90.0, 320.0, 110.0)], [-1]),  # elsewhere
        ([NEAR], [np.zeros((0, 3), np.float32)], [NEAR_PX], [-1]),  # no points say that it is there
        ([NEAR], [front_of(NEAR)], [(np.nan, 90.0, 210.0, 110.0)], [-1]),
        ([NEAR], [front_of(NEAR)], [], [-1]),
        ([], [], [NEAR_PX], []),
    ],
)
def test_boxes_find_their_detections(
    boxes: list[tuple[float, float, float]], points: list[np.ndarray], detected_px: list[tuple[float, ...]],
    expected: list[int],
) -> None:  # fmt: skip
    assert found(boxes, points, detected_px) == expected
