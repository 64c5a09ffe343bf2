import numpy as np
import pytest

from labeler.carla.visibility import ids_from_depth, ids_from_instances, true_boxes
from labeler.geometry.se3 import se3
from labeler.simulation.rig import View
from labeler.simulation.solids import Solid
from labeler.simulation.truth import Target
from tests.labeler.carla.fake_carla import Image
from tests.labeler.simulation.solid_shapes import box

pytest.importorskip("embreex", reason="needs embreex, of the extras `carla` and `simulation`")

CAR_TAGS = (14, 15)
VIEW = View(
    "front",
    200,
    100,
    np.array([[100.0, 0.0, 100.0], [0.0, 100.0, 50.0], [0.0, 0.0, 1.0]]),
    se3(np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), [0.0, 0.0, 1.0]),
)


def cube(vehicle_id: int, x_m: float, y_m: float = 0.0) -> Target:
    """2 m wide, long and high, standing on the ground. At x = 11 it covers columns 90-110 and rows 40-60."""
    solid = Solid(box((-1.0, -1.0, 0.0), (1.0, 1.0, 2.0)), np.ones(12))
    return Target(vehicle_id, f"uuid {vehicle_id}", "car", solid, (2.0, 2.0, 2.0), se3(np.eye(3), [x_m, y_m, 0.0]))


def image_of(blue_green_red: np.ndarray) -> Image:
    height, width, _ = blue_green_red.shape
    alpha = np.full((height, width, 1), 255)
    data = np.concatenate([blue_green_red, alpha], axis=2).astype(np.uint8).tobytes()
    return Image(width, height, memoryview(data))


def instances(*pixels: tuple[int, int, int]) -> Image:
    """One row of pixels, each tag, low byte, high byte."""
    return image_of(np.array([[(high, low, tag) for tag, low, high in pixels]]))


def test_numbers_are_green_and_256_times_blue() -> None:
    image = instances((14, 44, 1), (14, 7, 0), (15, 44, 1))
    assert ids_from_instances(image, [cube(300, 11.0), cube(7, 20.0)], CAR_TAGS).tolist() == [[300, 7, 300]]


def test_only_targets_with_the_tag_of_a_vehicle_count() -> None:
    """The road may have an actor's number by chance; a walker, the ego car and a parked car are no targets."""
    image = instances((1, 44, 1), (12, 44, 1), (14, 99, 0), (14, 44, 1))
    assert ids_from_instances(image, [cube(300, 11.0)], CAR_TAGS).tolist() == [[0, 0, 0, 300]]


def test_of_a_number_above_two_bytes_the_lower_two_are_shown() -> None:
    image = instances((14, 44, 1))
    assert ids_from_instances(image, [cube(65536 + 300, 11.0)], CAR_TAGS).tolist() == [[65836]]


def depth_image(depth_m: np.ndarray) -> Image:
    steps = np.rint(depth_m / 1000 * (256**3 - 1)).astype(np.int64)
    return image_of(np.stack([steps // 65536, steps // 256 % 256, steps % 256], axis=2))


def test_a_pixel_shows_the_vehicle_whose_box_its_point_is_in() -> None:
    """Two cubes behind each other: columns up to 100 show the near one, those beyond the far one; all else is road."""
    depth_m, tags = np.full((100, 200), 200.0), np.full((100, 200), 1)
    depth_m[45:55, 90:100], tags[45:55, 90:100] = 10.0, 14
    depth_m[45:55, 100:104], tags[45:55, 100:104] = 20.0, 14
    depth_m[45:55, 104:108], tags[45:55, 104:108] = 15.0, 14  # a vehicle that is no target
    depth_m[58:60, 90:110] = 10.0  # the road below the near cube, within its box
    semantics = image_of(np.stack([0 * tags, 0 * tags, tags], axis=2))
    ids = ids_from_depth(VIEW, depth_image(depth_m), semantics, [cube(3, 11.0), cube(7, 21.0)], CAR_TAGS)
    expected = np.zeros((100, 200), dtype=int)
    expected[45:55, 90:100], expected[45:55, 100:104] = 3, 7
    assert ids.tolist() == expected.tolist()


def ids_with(number: int, x1: int, y1: int, x2: int, y2: int) -> np.ndarray:
    ids = np.zeros((100, 200), dtype=np.int32)
    ids[y1:y2, x1:x2] = number
    return ids


def test_a_vehicle_behind_another_has_a_whole_box_only() -> None:
    shown, hidden = true_boxes(VIEW, ids_with(3, 90, 40, 110, 60), [cube(7, 21.0), cube(3, 11.0)], hidden_until_m=80)
    assert (shown.target.vehicle_id, shown.visible_px.tolist(), shown.visible_share) == (3, [90, 40, 110, 60], 1.0)
    assert hidden.target.vehicle_id == 7
    assert hidden.whole_px == pytest.approx([95, 45, 105, 55], abs=1e-3)
    assert np.isnan(hidden.visible_px).all()
    assert (hidden.visible_pixels, hidden.visible_share) == (0, 0.0)


def test_hidden_vehicles_beyond_the_distance_are_left_out_and_visible_ones_are_not() -> None:
    targets = [cube(7, 21.0), cube(3, 21.0, y_m=5.0)]
    boxes = true_boxes(VIEW, ids_with(3, 70, 45, 80, 55), targets, hidden_until_m=20)
    assert [found.target.vehicle_id for found in boxes] == [3]


def test_what_is_behind_the_camera_has_no_box() -> None:
    assert true_boxes(VIEW, ids_with(3, 0, 0, 0, 0), [cube(7, -21.0)], hidden_until_m=80) == []


def test_the_visible_share_is_reckoned_by_what_a_car_fills_of_its_box() -> None:
    """142 of the 400 pixels of its box's silhouette are half of the 71 % that a car in full view covers."""
    ids = ids_with(3, 90, 40, 110, 47)  # 140 pixels
    ids[47, 90:92] = 3
    (found,) = true_boxes(VIEW, ids, [cube(3, 11.0)], hidden_until_m=80)
    assert found.visible_pixels == 142
    assert found.visible_share == pytest.approx(0.5, abs=0.01)
