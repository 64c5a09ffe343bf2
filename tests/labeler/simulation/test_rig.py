import numpy as np
import pytest

from labeler.geometry.projection import project_points
from labeler.simulation.rig import Rig

RIG = Rig.on_roof(rear_axle_m=-1.3, height_m=1.5, width_px=720, height_px=360)


@pytest.mark.parametrize(
    ("camera", "seen_m"),
    [
        # 1.3 m ahead of the rear axle, 0.45 m towards where it looks, 0.3 m above the roof; then 10 m along its axis
        ("front", (1.3 + 0.45 + 10.0, 0.0, 1.8)),
        ("left", (1.3, 0.45 + 10.0, 1.8)),
        ("right", (1.3, -0.45 - 10.0, 1.8)),
        ("rear", (1.3 - 0.45 - 10.0, 0.0, 1.8)),
    ],
)
def test_each_camera_sees_what_lies_along_its_axis_in_the_middle(
    camera: str, seen_m: tuple[float, float, float]
) -> None:
    view = next(view for view in RIG.views if view.camera == camera)
    pixels, depth_m = project_points(np.array([seen_m]), view.ego_SE3_camera, view.intrinsics)
    assert pixels[0] == pytest.approx([360.0, 180.0])
    assert depth_m[0] == pytest.approx(10.0)


def test_up_is_up_and_left_is_left() -> None:
    view = RIG.views[0]
    pixels, _ = project_points(np.array([[20.0, 1.0, 3.0]]), view.ego_SE3_camera, view.intrinsics)
    assert pixels[0, 0] < 360
    assert pixels[0, 1] < 180


def test_a_hundred_degrees_fit_in_the_width() -> None:
    """Half of 720 pixels at 50 degrees: 360 / tan 50 = 302.07."""
    assert RIG.views[0].intrinsics[0, 0] == pytest.approx(302.0759, abs=1e-3)
    assert RIG.views[0].intrinsics[1, 1] == RIG.views[0].intrinsics[0, 0]


def test_neighbouring_cameras_both_see_what_lies_between_them() -> None:
    """At 45 degrees, 14 m away: in front and in left."""
    for view in RIG.views[:2]:
        pixels, _ = project_points(np.array([[11.3, 10.0, 1.0]]), view.ego_SE3_camera, view.intrinsics)
        assert 0 < pixels[0, 0] < 720


def test_the_ego_frame_lies_below_the_rear_axle() -> None:
    assert RIG.body_SE3_ego[:3, 3].tolist() == [-1.3, 0.0, 0.0]
    assert RIG.lidar_m == pytest.approx((1.3, 0.0, 2.1))
