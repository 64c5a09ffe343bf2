import numpy as np
import pytest

from labeler.identity.overlap import boxes_at_same_place, compare_boxes
from labeler.lidar import Boxes3D


def boxes(*places: tuple[float, float, float, float], size_m: tuple[float, float, float] = (4.0, 2.0, 1.5)) -> Boxes3D:
    """Boxes from x, y, z and yaw in degrees."""
    count = len(places)
    place = np.array(places, np.float32).reshape(-1, 4)
    return Boxes3D(
        center_m=place[:, :3],
        size_m=np.tile(np.array(size_m, np.float32), (count, 1)),
        yaw_rad=np.radians(place[:, 3]),
        score=np.ones(count, np.float32),
        class_id=np.zeros(count, np.int16),
        num_points=np.full(count, 10, np.int32),
        detection_index=np.arange(count, dtype=np.int32),
        source=np.zeros(count, np.int8),
        center_std_m=np.full((count, 2), 0.2, np.float32),
        yaw_std_rad=np.full(count, 0.1, np.float32),
        seen_m=np.tile(np.array([-2, -1, 2, 1], np.float32), (count, 1)),
        offset_s=np.zeros(count, np.float32),
    )


@pytest.mark.parametrize(
    ("other", "bev_iou", "similarity"),
    [
        ((10, 0, 0, 0), 1.0, 1.0),  # the very same box
        ((10, 0, 0, 180), 1.0, 1.0),  # front and back exchanged
        ((11, 0, 0, 0), 0.6, 0.6),  # 1 m ahead: shared 6 of 10 square metres; half a width apart would say 0.5
        ((10, 0, 0, 90), 1 / 3, 1.0),  # a quarter turn at the same place: 4 of 12, but no distance
        ((10, 2, 0, 0), 0.0, 0.0),  # beside it
        ((10, 0.5, 0, 0), 0.6, 0.75),  # a quarter of a width to the side
    ],
)
def test_similarity_of_two_boxes(other: tuple[float, float, float, float], bev_iou: float, similarity: float):
    pair = compare_boxes(boxes((10, 0, 0, 0)), 0, boxes(other), 0)
    assert pair.bev_iou == pytest.approx(bev_iou, abs=1e-3)
    assert pair.similarity == pytest.approx(similarity, abs=1e-3)
    assert pair.iou_3d == pytest.approx(bev_iou, abs=1e-3)  # all stand at one height


def places(a: Boxes3D, b: Boxes3D, allowed: np.ndarray | None = None) -> list[tuple[int, int]]:
    allowed = np.ones((len(a), len(b)), np.bool_) if allowed is None else allowed
    return [(pair.a, pair.b) for pair in boxes_at_same_place(a, b, allowed, 0.3)]


def test_each_box_is_in_one_pair_at_most_and_the_best_comes_first():
    a = boxes((10, 0, 0, 0), (20, 0, 0, 0))
    b = boxes((10.6, 0, 0, 0), (10.1, 0, 0, 0), (20.3, 0, 0, 0))
    assert places(a, b) == [(0, 1), (1, 2)]


def test_boxes_that_may_not_be_one_object_are_not_paired():
    one = boxes((10, 0, 0, 0))
    assert places(one, one, np.array([[False]])) == []
    assert places(one, boxes((10, 0, 4, 0))) == []  # on a bridge over it
    assert places(one, boxes((10, 2.5, 0, 0))) == []  # in the next lane
    assert places(one, Boxes3D.empty()) == []
