import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from labeler.geometry.se3 import se3
from labeler.simulation.rig import View
from labeler.simulation.silhouettes import covered_pixels, whole_box
from labeler.simulation.solids import Solid
from tests.labeler.simulation.solid_shapes import box

VIEW = View(
    "front",
    200,
    100,
    np.array([[100.0, 0.0, 100.0], [0.0, 100.0, 50.0], [0.0, 0.0, 1.0]]),
    se3(np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), [0.0, 0.0, 0.0]),
)
"""Looks along x; 45 degrees to each side fill the width of 200 pixels."""
CUBE = box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))


def at(x_m: float, y_m: float = 0.0, z_m: float = 0.0) -> np.ndarray:
    return se3(np.eye(3), [x_m, y_m, z_m])


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        # 2 m cube 10 m ahead of its near side: 100 px / 10 m = 10 px a metre on each side of the middle
        ((11.0, 0.0, 0.0), [90, 40, 110, 60]),
        # 5 m to the left: near side at 10 m: y 4..6 is x 40..60; far side at 12 m: y 4 is x 66.67
        ((11.0, 5.0, 0.0), [40, 40, 66.6667, 60]),
        # 1 m up: top at 2 m
        ((11.0, 0.0, 1.0), [90, 30, 110, 50]),
        # half out of the image: near side spans y 9..11 at 10 m, from -10 to 10 px; far side at 12 m starts at 25 px
        ((11.0, 10.0, 0.0), [0, 40, 25, 60]),
        # around the camera: it fills the image
        ((0.5, 0.0, 0.0), [0, 0, 200, 100]),
    ],
)
def test_box_of_a_cube(place: tuple[float, float, float], expected: list[float]) -> None:
    found = whole_box(VIEW, at(*place), CUBE)
    assert found is not None
    assert found == pytest.approx(expected, abs=1e-3)


def test_box_of_a_part_is_that_of_the_part() -> None:
    """A wedge whose tall end lies out of the image must not make the box of its low end taller."""
    wedge = np.array([[[10.0, 0.0, 0.0], [10.0, 20.0, 4.0], [10.0, 20.0, -4.0]]])
    found = whole_box(VIEW, at(0.0), wedge)
    assert found is not None
    # at the image's left edge, y = 10, the wedge is from -2 to 2 m high: 20 px to each side of row 50
    assert found == pytest.approx([0, 30, 100, 70], abs=1e-6)


@pytest.mark.parametrize(
    "place",
    [
        (-11.0, 0.0, 0.0),  # behind
        (11.0, 30.0, 0.0),  # to the left of the image
        (11.0, 0.0, -20.0),  # below it
    ],
)
def test_what_lies_out_of_the_image_has_no_box(place: tuple[float, float, float]) -> None:
    assert whole_box(VIEW, at(*place), CUBE) is None


@settings(max_examples=60, deadline=None)
@given(st.floats(-3.0, 30.0), st.floats(-20.0, 20.0), st.floats(-6.0, 6.0))
def test_box_holds_every_covered_pixel_and_no_edge_row_without_one(x_m: float, y_m: float, z_m: float) -> None:
    """Against a ray through every pixel's centre: the box reaches at most one pixel beyond those that are covered."""
    pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")
    assume(max(abs(x_m), abs(y_m), abs(z_m)) > 1.2)  # the camera is outside
    found = whole_box(VIEW, at(x_m, y_m, z_m), CUBE)
    everything = np.array([0.0, 0.0, 200.0, 100.0])
    covered = covered_pixels(VIEW, at(x_m, y_m, z_m), Solid(CUBE, np.ones(12)), everything, at_most=10**6)
    if len(covered) == 0:
        assert found is None or min(found[2] - found[0], found[3] - found[1]) <= 1
        return
    assert found is not None
    around = np.concatenate([covered.min(axis=0), covered.max(axis=0) + 1])
    assert (found[:2] <= around[:2] + 0.5 + 1e-3).all()
    assert (found[2:] >= around[2:] - 0.5 - 1e-3).all()
    if abs(y_m) + 1 < x_m - 1.2:  # wholly ahead: no thin sliver that falls between pixel centres
        assert np.abs(found - around).max() <= 1.0


def test_covered_pixels_are_counted_or_sampled() -> None:
    pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")
    solid, square = Solid(CUBE, np.ones(12)), np.array([80.0, 30.0, 120.0, 70.0])
    every = covered_pixels(VIEW, at(11.0), solid, square, at_most=10_000)
    assert len(every) == 20 * 20
    assert every.min(axis=0).tolist() == [90, 40]
    assert every.max(axis=0).tolist() == [109, 59]
    some = covered_pixels(VIEW, at(11.0), solid, square, at_most=400)
    assert len(some) == 10 * 10  # every second column and row
