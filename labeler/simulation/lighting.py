"""The light of a drive: where the sun stands, its colour, the sky, haze and clouds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.errors import SimulationError

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Lighting:
    """Colours are linear RGB; those of the sun and the sky are amounts of light, not bounded by 1.

    ``azimuth_rad`` and ``elevation_rad`` say where the sun stands in the world's frame. ``above`` and ``below`` are the
    light that comes from the sky and back from the ground. ``haze_per_m`` is the share of light that a metre of air
    replaces by ``horizon``; ``clouds`` the share of the sky that they cover."""

    name: str
    azimuth_rad: float
    elevation_rad: float
    sun: Rgb
    zenith: Rgb
    horizon: Rgb
    above: Rgb
    below: Rgb
    haze_per_m: float
    clouds: float
    exposure: float

    @property
    def sun_direction(self) -> NDArray[np.float64]:
        """(3,) unit vector to the sun."""
        flat = np.cos(self.elevation_rad)
        return np.array([flat * np.cos(self.azimuth_rad), flat * np.sin(self.azimuth_rad), np.sin(self.elevation_rad)])


@dataclass(frozen=True)
class _Kind:
    elevation_deg: tuple[float, float]
    sun: Rgb
    zenith: Rgb
    horizon: Rgb
    above: Rgb
    below: Rgb
    clouds: tuple[float, float]
    haze_m: tuple[float, float]
    exposure: float


_KINDS: dict[str, _Kind] = {
    "morning": _Kind((24.0, 36.0), (3.2, 2.75, 2.15), (0.20, 0.36, 0.68), (0.74, 0.78, 0.84), (0.46, 0.53, 0.66),
                     (0.21, 0.19, 0.165), (0.2, 0.5), (700.0, 1500.0), 0.82),
    "noon": _Kind((48.0, 64.0), (3.1, 2.9, 2.55), (0.16, 0.33, 0.70), (0.62, 0.74, 0.88), (0.42, 0.50, 0.63),
                  (0.20, 0.18, 0.165), (0.1, 0.45), (1100.0, 2200.0), 0.80),
    "overcast": _Kind((40.0, 60.0), (0.55, 0.55, 0.55), (0.58, 0.62, 0.68), (0.80, 0.82, 0.84), (0.86, 0.90, 0.96),
                      (0.32, 0.31, 0.30), (0.85, 1.0), (400.0, 900.0), 0.84),
    "evening": _Kind((14.0, 22.0), (3.3, 2.15, 1.20), (0.22, 0.32, 0.56), (0.95, 0.74, 0.56), (0.42, 0.44, 0.54),
                     (0.22, 0.18, 0.15), (0.15, 0.6), (600.0, 1300.0), 0.92),
}  # fmt: skip


def lighting_of(seed: int, *, name: str | None = None) -> Lighting:
    """The light that follows from ``seed``: ``morning``, ``noon``, ``overcast`` or ``evening``, or the one called
    ``name``. SimulationError on any other name."""
    rng = np.random.default_rng([seed, 6])
    drawn = str(rng.choice(sorted(_KINDS)))
    if name is not None and name not in _KINDS:
        raise SimulationError(f"there is no light called {name!r}; choose one of {', '.join(sorted(_KINDS))}")
    kind = _KINDS[name or drawn]
    return Lighting(
        name=name or drawn,
        azimuth_rad=float(rng.uniform(-np.pi, np.pi)),
        elevation_rad=float(np.radians(rng.uniform(*kind.elevation_deg))),
        sun=kind.sun,
        zenith=kind.zenith,
        horizon=kind.horizon,
        above=kind.above,
        below=kind.below,
        haze_per_m=1.0 / float(rng.uniform(*kind.haze_m)),
        clouds=float(rng.uniform(*kind.clouds)),
        exposure=kind.exposure,
    )
