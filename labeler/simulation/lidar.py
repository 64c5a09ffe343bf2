"""A spinning LiDAR on the ego car's roof, by ray casting.

The sensor turns clockwise once around each sweep's time: it starts and ends facing backwards, and faces ahead at the
sweep's own time. The ego car and the other vehicles go on moving meanwhile, each ray at its own time. As in Argoverse
2, points are then given in the ego frame at the sweep's time with the ego car's motion compensated, and theirs is not:
a moving vehicle's points lie where it was when the ray met it, at most half a turn before or after. Each vehicle is
searched in its own frame, so a moving vehicle needs no new search tree.

A return's strength falls with the square of the distance, with a slanting surface and with the material; a weak one is
lost more often. ``intensity`` is reflectance and slant alone, as sensors that correct for range report it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import transform_points
from labeler.simulation.errors import SimulationError
from labeler.simulation.solids import Solid

_ELEVATION_SHARES = np.array([0.0, 0.14, 0.72, 1.0])
_ELEVATION_DEG = np.array([12.0, 2.0, -7.0, -25.0])
_STRENGTH = 100.0
_STRENGTH_RANGE_M = 60.0
_SIGMAS = 3.0


@dataclass(frozen=True)
class LidarConfig:
    """``channels`` beams from 12 to -25 degrees, most of them near the horizon where far vehicles are; ``columns``
    readings a turn. ``noise_m`` is the standard deviation of a range (cut at three times that), ``dropout`` the share
    of returns lost whatever their strength."""

    channels: int = 64
    columns: int = 1800
    range_m: float = 100.0
    nearest_m: float = 1.0
    turn_s: float = 0.1
    noise_m: float = 0.02
    dropout: float = 0.03

    def __post_init__(self) -> None:
        if self.channels < 32 or self.columns < 90:
            raise SimulationError(
                f"The LiDAR needs at least 32 channels and 90 columns, not {self.channels} and {self.columns}."
            )

    def elevations_rad(self) -> NDArray[np.float64]:
        """(channels,) from the highest beam to the lowest."""
        shares = np.linspace(0.0, 1.0, self.channels)
        return np.radians(np.interp(shares, _ELEVATION_SHARES, _ELEVATION_DEG))


@dataclass(frozen=True)
class Motion:
    """How a frame moves over the ground: where its origin is in the world, its yaw, and how these change."""

    x_m: float
    y_m: float
    yaw_rad: float
    velocity_mps: tuple[float, float] = (0.0, 0.0)
    yaw_rate_radps: float = 0.0

    def at(self, time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(N, 2) origins and (N,) yaws at times (N,) in seconds from now."""
        origin_m = np.array([self.x_m, self.y_m]) + np.asarray(self.velocity_mps) * time_s[:, None]
        return origin_m, self.yaw_rad + self.yaw_rate_radps * time_s


@dataclass(frozen=True, eq=False)
class MovingSolid:
    """A vehicle: its number, its shape in its own frame, and how that frame moves."""

    vehicle_id: int
    solid: Solid
    motion: Motion


@dataclass(frozen=True, eq=False)
class Scan:
    """One sweep of N points: ``xyz_m`` (N, 3) float64 in the ego frame at the sweep's time; ``intensity`` (N,) uint8;
    ``laser_number`` (N,) uint8, 0 the highest; ``offset_ns`` (N,) int32 from the sweep's time; ``vehicle_id`` (N,)
    int32, 0 for the town."""

    xyz_m: NDArray[np.float64]
    intensity: NDArray[np.uint8]
    laser_number: NDArray[np.uint8]
    offset_ns: NDArray[np.int32]
    vehicle_id: NDArray[np.int32]

    def moved(self, new_SE3_old: NDArray[np.float64]) -> "Scan":
        """The same points in another frame that is fixed to the ego car."""
        return replace(self, xyz_m=transform_points(new_SE3_old, self.xyz_m))


def scan(
    config: LidarConfig,
    *,
    ego: Motion,
    sensor_m: tuple[float, float, float],
    town: Solid,
    vehicles: Iterable[MovingSolid],
    rng: np.random.Generator,
) -> Scan:
    """One turn of the sensor, which stands at ``sensor_m`` in the ego frame, looking along with it."""
    elevation_rad = config.elevations_rad()
    share = (np.arange(config.columns) + 0.5) / config.columns
    column_s = (share - 0.5) * config.turn_s
    azimuth_rad = np.pi - 2 * np.pi * share

    time_s = np.repeat(column_s, config.channels)
    directions_ego = np.stack(
        [
            np.outer(np.cos(azimuth_rad), np.cos(elevation_rad)).ravel(),
            np.outer(np.sin(azimuth_rad), np.cos(elevation_rad)).ravel(),
            np.tile(np.sin(elevation_rad), config.columns),
        ],
        axis=1,
    )
    ego_m, ego_yaw_rad = ego.at(time_s)
    origins_m = _turned(np.broadcast_to(np.array(sensor_m), (len(time_s), 3)), ego_yaw_rad)
    origins_m[:, :2] += ego_m
    directions = _turned(directions_ego, ego_yaw_rad)

    met = town.cast(origins_m, directions)
    distance_m, cos = met.distance_m.copy(), met.cos_incidence.copy()
    reflectance = np.where(met.triangle >= 0, _of(town.reflectance, met.triangle), 0.0)
    vehicle_id = np.zeros(len(time_s), dtype=np.int32)
    for vehicle in vehicles:
        columns = _columns_towards(config, ego, sensor_m, vehicle)
        if not len(columns):
            continue
        rays = (columns[:, None] * config.channels + np.arange(config.channels)).ravel()
        body_m, body_yaw_rad = vehicle.motion.at(time_s[rays])
        from_m = origins_m[rays].copy()
        from_m[:, :2] -= body_m
        hits = vehicle.solid.cast(_turned(from_m, -body_yaw_rad), _turned(directions[rays], -body_yaw_rad))
        nearer = hits.distance_m < distance_m[rays]
        distance_m[rays[nearer]] = hits.distance_m[nearer]
        cos[rays[nearer]] = hits.cos_incidence[nearer]
        reflectance[rays[nearer]] = vehicle.solid.reflectance[hits.triangle[nearer]]
        vehicle_id[rays[nearer]] = vehicle.vehicle_id

    kept = _returned(config, distance_m, reflectance * cos, rng)
    noise_m = np.clip(rng.normal(0.0, 1.0, len(kept)), -_SIGMAS, _SIGMAS) * config.noise_m
    points_m = origins_m[kept] + directions[kept] * (distance_m[kept] + noise_m)[:, None]
    points_m[:, :2] -= np.array([ego.x_m, ego.y_m])
    shine = reflectance[kept] * (0.3 + 0.7 * cos[kept]) * rng.uniform(0.9, 1.1, len(kept))
    return Scan(
        xyz_m=_turned(points_m, np.full(len(kept), -ego.yaw_rad)),
        intensity=np.clip(np.rint(shine * 255), 0, 255).astype(np.uint8),
        laser_number=(kept % config.channels).astype(np.uint8),
        offset_ns=np.rint(time_s[kept] * 1e9).astype(np.int32),
        vehicle_id=vehicle_id[kept],
    )


def _returned(
    config: LidarConfig, distance_m: NDArray[np.float64], strength: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.int64]:
    """Which rays come back."""
    reached = (distance_m >= config.nearest_m) & (distance_m <= config.range_m)
    safe_m = np.where(reached, distance_m, config.range_m)
    seen = 1.0 - np.exp(-_STRENGTH * strength * (_STRENGTH_RANGE_M / safe_m) ** 2)
    return np.flatnonzero(reached & (rng.random(len(distance_m)) < seen * (1.0 - config.dropout)))


def _columns_towards(
    config: LidarConfig, ego: Motion, sensor_m: tuple[float, float, float], vehicle: MovingSolid
) -> NDArray[np.int64]:
    """The columns in which a vehicle can be met, with room for how it and the ego car move during a turn."""
    cos, sin = np.cos(ego.yaw_rad), np.sin(ego.yaw_rad)
    x_m = vehicle.motion.x_m - ego.x_m - (cos * sensor_m[0] - sin * sensor_m[1])
    y_m = vehicle.motion.y_m - ego.y_m - (sin * sensor_m[0] + cos * sensor_m[1])
    away_m = float(np.hypot(x_m, y_m))
    moved_m = (np.hypot(*vehicle.motion.velocity_mps) + np.hypot(*ego.velocity_mps)) * config.turn_s / 2
    reach_m = vehicle.solid.radius_m + moved_m
    if away_m - reach_m > config.range_m:
        return np.zeros(0, dtype=np.int64)
    if away_m <= reach_m:
        return np.arange(config.columns)
    half_rad = np.arcsin(reach_m / away_m) + abs(ego.yaw_rate_radps) * config.turn_s / 2
    bearing_rad = np.arctan2(y_m, x_m) - ego.yaw_rad
    per_rad = config.columns / (2 * np.pi)
    first = int(np.floor((np.pi - bearing_rad - half_rad) * per_rad)) - 1
    last = int(np.ceil((np.pi - bearing_rad + half_rad) * per_rad)) + 1
    return np.unique(np.arange(first, last + 1) % config.columns)


def _turned(vectors: NDArray[np.float64], yaw_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) vectors, each turned about z by its angle (N,)."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y, vectors[:, 2]], axis=1)


def _of(reflectance: NDArray[np.float64], triangle: NDArray[np.int64]) -> NDArray[np.float64]:
    """(R,) reflectances of the triangles that were hit; anything where none was."""
    return reflectance[np.maximum(triangle, 0)] if len(reflectance) else np.zeros(len(triangle))
