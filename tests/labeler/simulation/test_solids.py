import numpy as np
import pytest

from labeler.simulation.solids import Solid
from tests.labeler.simulation.solid_shapes import box, plane

pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")


@pytest.mark.parametrize(
    ("origin", "direction", "distance_m", "cos"),
    [
        # straight down on the ground from 2 m
        ((50.0, 0.0, 2.0), (0.0, 0.0, -1.0), 2.0, 1.0),
        # 3-4-5: down 3, along 4
        ((50.0, 0.0, 3.0), (0.8, 0.0, -0.6), 5.0, 0.6),
        # a box's front side at x = 9
        ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 9.0, 1.0),
        # from inside of the box to its far side: both sides of a triangle can be hit
        ((10.0, 0.0, 1.0), (1.0, 0.0, 0.0), 1.0, 1.0),
        # into the sky
        ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), np.inf, 0.0),
    ],
)
def test_cast(
    origin: tuple[float, float, float], direction: tuple[float, float, float], distance_m: float, cos: float
) -> None:
    triangles = np.concatenate([plane(0.0), box((9.0, -1.0, 0.0), (11.0, 1.0, 2.0))])
    hits = Solid(triangles, np.ones(len(triangles))).cast(np.array([origin]), np.array([direction]))
    assert hits.distance_m[0] == pytest.approx(distance_m, abs=1e-4)
    assert hits.cos_incidence[0] == pytest.approx(cos, abs=1e-5)
    assert (hits.triangle[0] >= 0) == np.isfinite(distance_m)


def test_radius_is_that_of_the_farthest_corner() -> None:
    assert Solid(box((-3.0, -4.0, 0.0), (1.0, 1.0, 9.0)), np.ones(12)).radius_m == pytest.approx(5.0)


def test_nothing_can_be_hit() -> None:
    hits = Solid(np.zeros((0, 3, 3)), np.zeros(0)).cast(np.zeros((2, 3)), np.eye(3)[:2])
    assert hits.triangle.tolist() == [-1, -1]
    assert np.isinf(hits.distance_m).all()


def test_reflectance_must_fit() -> None:
    with pytest.raises(ValueError, match=r"must have shape \(5, 3, 3\)"):
        Solid(plane(0.0), np.ones(5))
