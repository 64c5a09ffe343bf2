"""Which of several boxes of one object is taken. Cars are 4 x 2 m."""

import numpy as np
import pytest

from labeler.lidar import Boxes3D, BoxSource
from labeler.lidar.pillars.joining import filled, seen_by_several

NETWORK, CLUSTER = BoxSource.PILLARS, BoxSource.CLUSTER


def boxes(source: BoxSource, *rows: tuple[int, float, float]) -> Boxes3D:
    """A box for each (detection, x, score), at y = 0, class 1 of the network and 0 otherwise."""
    count = len(rows)
    return Boxes3D(
        center_m=np.array([(x, 0, 1) for _, x, _ in rows], np.float32).reshape(-1, 3),
        size_m=np.tile(np.array([4, 2, 1.5], np.float32), (count, 1)),
        yaw_rad=np.zeros(count, np.float32),
        score=np.array([score for _, _, score in rows], np.float32),
        class_id=np.full(count, int(source is NETWORK), np.int16),
        num_points=np.full(count, 50, np.int32),
        detection_index=np.array([detection for detection, _, _ in rows], np.int32),
        source=np.full(count, source, np.int8),
        center_std_m=np.full((count, 2), 0.2, np.float32),
        yaw_std_rad=np.full(count, 0.1, np.float32),
        seen_m=np.zeros((count, 4), np.float32),
        offset_s=np.zeros(count, np.float32),
    )


@pytest.mark.parametrize(
    ("found", "fitted", "expected"),
    [
        # Of one detection: the network's.
        ([(0, 10.0, 0.9)], [(0, 11.0, 0.6)], [(0, 10.0, 0.9, NETWORK)]),
        # At one place, but of different detections: each keeps its own, the network's doubt halves the other's score.
        ([(1, 10.0, 0.9)], [(0, 10.0, 0.6)], [(0, 10.0, 0.3, CLUSTER), (1, 10.0, 0.9, NETWORK)]),
        ([(2, 10.0, 0.9), (3, 30.0, 0.8)], [], [(2, 10.0, 0.9, NETWORK), (3, 30.0, 0.8, NETWORK)]),
        ([], [(2, 10.0, 0.6)], [(2, 10.0, 0.3, CLUSTER)]),
        ([], [], []),
    ],
)
def test_one_box_for_a_detection(
    found: list[tuple[int, float, float]], fitted: list[tuple[int, float, float]],
    expected: list[tuple[int, float, float, BoxSource]],
) -> None:  # fmt: skip
    result = filled(boxes(NETWORK, *found), boxes(CLUSTER, *fitted))
    assert result.detection_index.tolist() == [row[0] for row in expected]
    np.testing.assert_allclose(result.center_m[:, 0], [row[1] for row in expected])
    np.testing.assert_allclose(result.score, [row[2] for row in expected])
    assert result.source.tolist() == [row[3] for row in expected]
    assert result.class_id.tolist() == [int(row[3] is not CLUSTER) for row in expected]


@pytest.mark.parametrize(
    ("front", "left", "expected_front", "expected_left"),
    [
        # A metre apart, IoU 3/5: one object, at the surer one's place.
        ([(0, 10.0, 0.9)], [(5, 11.0, 0.7)], [10.0], [10.0]),
        ([(0, 10.0, 0.5)], [(5, 11.0, 0.7)], [11.0], [11.0]),
        # Three metres apart, IoU 1/7: two objects.
        ([(0, 10.0, 0.9)], [(5, 13.0, 0.7)], [10.0], [13.0]),
        # Two of one camera never become one; the surer of the two is what the other camera sees.
        ([(0, 10.0, 0.9), (1, 10.5, 0.8)], [(5, 10.2, 0.7)], [10.0, 10.5], [10.0]),
        ([], [(5, 11.0, 0.7)], [], [11.0]),
        ([], [], [], []),
    ],
)
def test_cameras_agree_where_an_object_is(
    front: list[tuple[int, float, float]], left: list[tuple[int, float, float]],
    expected_front: list[float], expected_left: list[float],
) -> None:  # fmt: skip
    result = seen_by_several({"front": boxes(NETWORK, *front), "left": boxes(CLUSTER, *left)})
    np.testing.assert_allclose(result["front"].center_m[:, 0], expected_front)
    np.testing.assert_allclose(result["left"].center_m[:, 0], expected_left)
    for found, given, class_id in ((result["front"], front, 1), (result["left"], left, 0)):
        assert found.detection_index.tolist() == [row[0] for row in given]
        np.testing.assert_allclose(found.score, [row[2] for row in given])
        assert found.class_id.tolist() == [class_id] * len(given)
