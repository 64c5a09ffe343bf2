"""How well a track goes on where another begins: densities of places, and the other choices."""

import numpy as np
import pytest

from labeler.identity.rivals import densities, over_rivals

NONE = float("nan")


@pytest.mark.parametrize(
    ("sigmas", "std_m", "still_m", "expected"),
    [
        (0.0, 1.0, NONE, 0.0),  # in the right place, known to a metre
        (2.0, 1.0, NONE, -4.0),  # two deviations off in both directions
        (0.0, 10.0, NONE, -np.log(100)),  # fits, but so it would within ten metres
        (3.0, 1.0, 0.0, np.log(4)),  # both stand, at one place: the half metre that this is known to counts
        (0.0, 1.0, 2.0, 0.0),  # both stand, two metres apart: moving they would fit better
    ],
)
def test_a_place_that_is_hardly_known_fits_nowhere_well(
    sigmas: float, std_m: float, still_m: float, expected: float
) -> None:
    found = densities(np.array([sigmas]), np.array([std_m**4]), np.array([still_m]))
    np.testing.assert_allclose(found, [expected], atol=1e-9)


TRACKS = (7, 8, 9, 3)
"""Rows 0 to 3."""


@pytest.mark.parametrize(
    ("apart", "expected"),
    [
        # 7 may go on as 8 (density -1) or 9 (-2), and 3 as 9 (-4). 8 and 9 are two objects, and so are 7 and 3:
        # 7 to 8 is better than its rival by 1, 7 to 9 worse by 1, 3 to 9 worse than 7 to 9 by 2.
        ({(8, 9), (3, 7)}, [1, -1, -2]),
        ({(3, 7)}, [5, 2, -2]),  # 8 and 9 may be one object in two cameras: no rivals
        (set[tuple[int, int]](), [5, 5, 5]),  # nobody excludes anybody
    ],
)
def test_only_choices_that_exclude_one_another_are_rivals(apart: set[tuple[int, int]], expected: list[float]) -> None:
    found = over_rivals(
        np.array([-1.0, -2.0, -4.0]),
        np.array([0, 0, 3]),
        np.array([1, 2, 2]),
        TRACKS,
        lambda a, b: (min(a, b), max(a, b)) in apart,
    )
    np.testing.assert_array_equal(found, expected)
