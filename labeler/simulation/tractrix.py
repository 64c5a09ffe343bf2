"""How a vehicle's body follows its front: the rear axle trails the front bumper on a tractrix.

A traffic simulator moves the front bumper along lanes and turns its heading with the lane, so that bodies would slide
sideways at each bend. A real rear axle never slides: it always moves straight towards the front. While the front moves
straight ahead by ``s``, the angle ``a`` between its motion and the body obeys ``tan(a / 2) = tan(a0 / 2) exp(-s / d)``,
where ``d`` is the distance from the front to the rear axle (https://en.wikipedia.org/wiki/Tractrix). A path is taken as
a chain of such straight moves, so the result does not depend on how finely it is cut.
"""

import numpy as np
from numpy.typing import NDArray

_LONGEST_MOVE_M = 10.0


def trail(
    front_before_m: NDArray[np.float64],
    front_after_m: NDArray[np.float64],
    yaw_before_rad: NDArray[np.float64],
    rear_axle_m: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(V,) yaws in radians, from -pi to pi, of V bodies whose fronts have moved straight from ``front_before_m`` (V, 2)
    to ``front_after_m`` (V, 2), given their yaws before (V,) and how far each rear axle lies behind the front (V,)."""
    moved_m = front_after_m - front_before_m
    way_m = np.hypot(moved_m[:, 0], moved_m[:, 1])
    ahead_rad = np.arctan2(moved_m[:, 1], moved_m[:, 0])
    off_rad = wrapped(yaw_before_rad - ahead_rad)
    trailing_rad = 2 * np.arctan(np.tan(off_rad / 2) * np.exp(-way_m / rear_axle_m))
    return np.where(way_m > 1e-9, wrapped(ahead_rad + trailing_rad), yaw_before_rad)


def jumped(front_before_m: NDArray[np.float64], front_after_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(V,) whether a front (V, 2) has moved farther in one step than a vehicle can drive."""
    return np.linalg.norm(front_after_m - front_before_m, axis=1) > _LONGEST_MOVE_M


def center_of(
    front_m: NDArray[np.float64], yaw_rad: NDArray[np.float64], length_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(V, 2) centres of V bodies from the middles of their front bumpers (V, 2), their yaws (V,) and lengths (V,)."""
    return front_m - np.stack([np.cos(yaw_rad), np.sin(yaw_rad)], axis=1) * (length_m / 2)[:, None]


def wrapped(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles in radians, brought into -pi to pi (pi left out)."""
    return (angle_rad + np.pi) % (2 * np.pi) - np.pi
