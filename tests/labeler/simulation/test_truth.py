import numpy as np
import pytest

from labeler.geometry.se3 import se3
from labeler.simulation.rig import View
from labeler.simulation.solids import Solid
from labeler.simulation.truth import Target, boxes_in_image, points_inside
from tests.labeler.simulation.solid_shapes import box

pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")

VIEW = View(
    "front",
    200,
    100,
    np.array([[100.0, 0.0, 100.0], [0.0, 100.0, 50.0], [0.0, 0.0, 1.0]]),
    se3(np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), [0.0, 0.0, 1.0]),
)


def cube(vehicle_id: int, x_m: float, y_m: float = 0.0, yaw_rad: float = 0.0) -> Target:
    """2 m wide, long and high, standing on the ground. At x = 11 it covers columns 90-110 and rows 40-60."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    solid = Solid(box((-1.0, -1.0, 0.0), (1.0, 1.0, 2.0)), np.ones(12))
    return Target(vehicle_id, f"uuid {vehicle_id}", "car", solid, (2.0, 2.0, 2.0), se3(turn, [x_m, y_m, 0.0]))


def ids_with(**parts: tuple[int, int, int, int]) -> np.ndarray:
    """An image of ids in which each ``v<id>`` fills columns x1..x2 and rows y1..y2; later ones lie in front."""
    ids = np.zeros((100, 200), dtype=np.uint32)
    for name, (x1, y1, x2, y2) in parts.items():
        ids[y1:y2, x1:x2] = int(name[1:])
    return ids


def test_an_object_in_full_view() -> None:
    (found,) = boxes_in_image(VIEW, ids_with(v3=(90, 40, 110, 60)), [cube(3, 11.0)])
    assert found.whole_px == pytest.approx([90, 40, 110, 60], abs=1e-3)
    assert found.visible_px.tolist() == [90, 40, 110, 60]
    assert found.visible_pixels == 400
    assert found.visible_share == 1.0
    assert found.target.distance_m == pytest.approx(11.0)


def test_a_half_hidden_object_keeps_its_whole_box() -> None:
    ids = ids_with(v3=(90, 40, 110, 60), v7=(100, 30, 150, 80))
    (found,) = boxes_in_image(VIEW, ids, [cube(3, 11.0)])
    assert found.whole_px == pytest.approx([90, 40, 110, 60], abs=1e-3)
    assert found.visible_px.tolist() == [90, 40, 100, 60]
    assert found.visible_pixels == 200
    assert found.visible_share == pytest.approx(0.5)


def test_an_object_hidden_in_its_middle_counts_both_parts() -> None:
    ids = ids_with(v3=(90, 40, 110, 60), v7=(95, 30, 105, 80))
    (found,) = boxes_in_image(VIEW, ids, [cube(3, 11.0)])
    assert found.visible_px.tolist() == [90, 40, 110, 60]
    assert (found.visible_pixels, found.visible_share) == (200, 0.5)


def test_an_object_of_which_nothing_shows_is_not_listed() -> None:
    targets = [cube(3, 11.0), cube(7, 9.0), cube(900, 40.0)]
    found = boxes_in_image(VIEW, ids_with(v3=(90, 40, 110, 60), v7=(80, 30, 120, 80)), targets)
    assert [one.target.vehicle_id for one in found] == [7]


def test_whole_box_is_never_smaller_than_the_visible_one() -> None:
    """The renderer draws far objects with fewer triangles, which may reach out by a pixel."""
    (found,) = boxes_in_image(VIEW, ids_with(v3=(89, 40, 110, 60)), [cube(3, 11.0)])
    assert found.whole_px == pytest.approx([89, 40, 110, 60], abs=1e-3)


def test_ids_must_be_of_the_camera_s_size() -> None:
    with pytest.raises(ValueError, match=r"must have shape \(100, 200\)"):
        boxes_in_image(VIEW, np.zeros((200, 100), dtype=np.uint32), [])


def test_points_inside() -> None:
    target = cube(1, 10.0, 5.0, yaw_rad=np.pi / 4)
    points_m = np.array(
        [
            [10.0, 5.0, 0.0],  # the middle of its foot
            [10.0, 5.0, 2.1],  # just above
            [10.0, 5.0 + 1.4, 1.0],  # along the diagonal, which is 1.414 long
            [10.0, 5.0 + 1.45, 1.0],
            [11.0, 6.0, 1.0],  # a corner only if it were not turned
        ]
    )
    assert points_inside(target, points_m).tolist() == [True, False, True, False, False]
    assert points_inside(target, points_m, margin_m=0.15).tolist() == [True, True, True, True, False]
