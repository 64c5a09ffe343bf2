"""The measures of the cars, vans and pickups: one row a body style, varied a little from car to car."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

Body = Literal["three-box", "two-box", "van", "pickup"]


@dataclass(frozen=True)
class CarShape:
    """A car seen from the side and from above.

    Lengths in metres. The four fractions say where along the car, from 0 at its nose to 1 at its tail, the hood ends,
    the roof starts and ends, and the rear window has come down. ``width_m`` is that of the body without mirrors.
    ``belt_m`` is the height of the side windows' lower edge, ``deck_m`` that of the boot's lid, ``sill_m`` the ground
    clearance. ``doors`` are the fractions at which doors begin and end."""

    style: str
    category: str
    body: Body
    length_m: float
    width_m: float
    height_m: float
    wheelbase_m: float
    wheel_radius_m: float
    hood_end: float
    roof_start: float
    roof_end: float
    deck_start: float
    hood_m: float
    belt_m: float
    deck_m: float
    sill_m: float
    doors: tuple[float, ...]
    pillars: tuple[float, ...]

    @property
    def front_axle_m(self) -> float:
        """x of the front axle; the body's middle is x = 0."""
        return self.length_m / 2 - (self.length_m - self.wheelbase_m) * 0.46

    @property
    def rear_axle_m(self) -> float:
        return self.front_axle_m - self.wheelbase_m

    @property
    def steep_tail(self) -> bool:
        """Whether the tail falls straight from the roof, without a boot's lid or a bed."""
        return self.deck_start >= 0.93

    @property
    def tail_m(self) -> float:
        """Height of the tail's upper edge."""
        return self.belt_m if self.steep_tail else self.deck_m

    def x_at(self, fraction: float) -> float:
        """x in metres at a fraction of the length from the nose."""
        return self.length_m * (0.5 - fraction)

    def varied(self, rng: np.random.Generator) -> "CarShape":
        """Another car of the same style: a few percent longer, wider, higher."""
        long, wide, high = 1 + rng.uniform(-1, 1, size=3) * (0.03, 0.015, 0.025)
        return replace(
            self,
            length_m=self.length_m * long,
            width_m=self.width_m * wide,
            height_m=self.height_m * high,
            wheelbase_m=self.wheelbase_m * long,
            hood_m=self.hood_m * high,
            belt_m=self.belt_m * high,
            deck_m=self.deck_m * high,
        )


CAR_SHAPES: tuple[CarShape, ...] = (
    CarShape("sedan", "car", "three-box", 4.70, 1.82, 1.45, 2.75, 0.33, 0.27, 0.41, 0.72, 0.86,
             0.92, 0.93, 1.02, 0.20, (0.34, 0.56, 0.76), (0.57,)),
    CarShape("hatchback", "car", "two-box", 4.10, 1.77, 1.50, 2.55, 0.32, 0.23, 0.38, 0.86, 0.97,
             0.94, 0.96, 0.98, 0.20, (0.31, 0.60, 0.82), (0.61,)),
    CarShape("suv", "car", "two-box", 4.65, 1.90, 1.70, 2.70, 0.37, 0.25, 0.38, 0.88, 0.98,
             1.10, 1.12, 1.12, 0.27, (0.32, 0.56, 0.79), (0.57, 0.82)),
    CarShape("wagon", "car", "two-box", 4.75, 1.83, 1.48, 2.78, 0.33, 0.26, 0.40, 0.90, 0.985,
             0.92, 0.94, 0.96, 0.20, (0.33, 0.56, 0.78), (0.57, 0.81)),
    CarShape("coupe", "car", "three-box", 4.45, 1.84, 1.34, 2.60, 0.34, 0.31, 0.46, 0.66, 0.88,
             0.88, 0.88, 0.98, 0.18, (0.37, 0.68), ()),
    CarShape("minivan", "car", "two-box", 4.80, 1.88, 1.74, 2.90, 0.34, 0.17, 0.34, 0.93, 0.985,
             1.02, 1.00, 1.02, 0.22, (0.29, 0.52, 0.75), (0.53, 0.76)),
    CarShape("van", "car", "van", 5.30, 2.00, 2.15, 3.30, 0.36, 0.13, 0.26, 0.985, 0.995,
             1.22, 1.15, 1.15, 0.22, (0.20, 0.41, 0.68), ()),
    CarShape("pickup", "truck", "pickup", 5.40, 1.98, 1.82, 3.40, 0.40, 0.25, 0.36, 0.58, 0.62,
             1.15, 1.16, 1.16, 0.30, (0.31, 0.46, 0.61), (0.47,)),
)  # fmt: skip


@dataclass(frozen=True)
class Profile:
    """A body's outline at each of its N stations along the length, nose to tail; (N,) each, metres.

    ``roof`` is the height on the middle line, ``belt`` that of the shoulder, ``floor`` the lower edge, ``half_width``
    the half width at the shoulder, ``roof_half_width`` that of the roof's edge."""

    x_m: NDArray[np.float64]
    roof_m: NDArray[np.float64]
    belt_m: NDArray[np.float64]
    floor_m: NDArray[np.float64]
    half_width_m: NDArray[np.float64]
    roof_half_width_m: NDArray[np.float64]
    cabin: NDArray[np.float64]
    """From 0 on hood and deck to 1 where the cabin stands on the shoulder."""


def profile_of(shape: CarShape, stations: int) -> Profile:
    """The outline at about ``stations`` even stations, and at each corner of the body whatever their number."""
    s, nose_m = shape, shape.hood_m * 0.80
    middle = (s.roof_start + s.roof_end) / 2
    corners = [0, 0.006, 0.02, 0.05, s.hood_end, s.roof_start, middle, s.roof_end, s.deck_start, 0.97, 0.99, 1]
    at = np.unique(np.concatenate([np.linspace(0, 1, stations), corners]))
    van = s.body == "van"
    tail = (
        [(s.deck_start, s.belt_m + 0.02), (1.0 + 1e-6, s.belt_m * 0.91)]
        if s.steep_tail
        else [(s.deck_start, s.deck_m + 0.02), (0.99, s.deck_m - 0.03), (1.0 + 1e-6, s.deck_m - 0.10)]
    )
    roof_end = s.height_m * (0.985 if van or s.style in ("suv", "wagon", "minivan") else 0.965)
    roof = _curve(at, [
        (0, nose_m * 0.82), (0.012, nose_m * 0.93), (0.05, s.hood_m * 0.90), (s.hood_end * 0.6, s.hood_m * 0.985),
        (s.hood_end, s.hood_m + 0.02), ((s.hood_end + s.roof_start) / 2, (s.hood_m + s.height_m) / 2 + 0.04),
        (s.roof_start, s.height_m * 0.975), (middle, s.height_m), (s.roof_end, roof_end), *tail,
    ])  # fmt: skip
    belt = _curve(at, [
        (0, nose_m * 0.75), (0.03, s.hood_m * 0.82), (s.hood_end, s.belt_m * 0.97), (0.6, s.belt_m),
        (0.9, s.belt_m * 1.01), (1, s.belt_m * 0.90),
    ])  # fmt: skip
    belt = np.minimum(belt, roof - 0.01)
    cabin = np.clip((roof - belt - 0.06) / 0.25, 0, 1)
    half = s.width_m / 2 * _curve(at, [
        (0, 0.78), (0.012, 0.86), (0.05, 0.94), (0.14, 0.985), (0.3, 1), (0.7, 1), (0.9, 0.975), (0.97, 0.93),
        (0.99, 0.87), (1, 0.80),
    ])  # fmt: skip
    floor = _curve(at, [
        (0, s.sill_m + 0.14), (0.02, s.sill_m + 0.05), (0.08, s.sill_m), (0.9, s.sill_m), (0.98, s.sill_m + 0.08),
        (1, s.sill_m + 0.20),
    ])  # fmt: skip
    lean = (
        [(0, 0.95), (s.hood_end, 0.93), (s.roof_start, 0.88), (1, 0.90)]
        if van
        else [(0, 0.95), (s.hood_end, 0.93), (s.roof_start, 0.80), (s.roof_end, 0.78), (s.deck_start, 0.86), (1, 0.93)]
    )
    roof_half = half * (_curve(at, lean) * cabin + 0.93 * (1 - cabin))
    return Profile(s.length_m * (0.5 - at), roof, belt, floor, half, roof_half, cabin)


def _curve(at: NDArray[np.float64], knots: list[tuple[float, float]]) -> NDArray[np.float64]:
    """A smooth curve through knots that does not overshoot them."""
    places, values = np.array(knots, dtype=np.float64).T
    if np.any(np.diff(places) <= 0):
        kept = np.concatenate([[True], np.diff(places) > 0])
        places, values = places[kept], values[kept]
    return np.asarray(PchipInterpolator(places, values)(np.clip(at, places[0], places[-1])), dtype=np.float64)
