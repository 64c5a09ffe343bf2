"""Examples for the pillar network: windows of painted clouds, changed so that they stand for many.

A window is turned about the camera, mirrored and stretched; beams and points are left out, as of sensors with fewer;
and the paint is spoilt in the ways that segmentations and calibrations spoil it: an object that is not found, paint on
what is no vehicle, paint that lies beside the object, none at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from labeler.lidar.pillars.direction import SEEN_COLUMN
from labeler.lidar.pillars.grouping import DIRECTION_GRID, Grid
from labeler.training.clouds import MIN_POINTS, DirectionSweep, points_inside
from labeler.training.errors import TrainingError

_TURN_RAD = float(np.radians(30.0))
_STRETCH = 0.05
_HEIGHT_STD_M = 0.05
_SENSOR_HEIGHT_M = 2.2
_BEAM_RAD = np.radians(0.6)
_FEWER_BEAMS, _FEWER_POINTS, _SPOILT, _BESIDE, _UNPAINTED = 0.3, 0.3, 0.3, 0.1, 0.02
_BESIDE_RAD = np.radians(0.7)
_FALSE_PAINT_M = 1.5


@dataclass(frozen=True, eq=False)
class CloudExample:
    """``cloud`` (N, D) in a window ``grid``; ``truth`` (T, 7), ``classes`` (T,) and ``asked`` (T,) as
    :class:`labeler.training.clouds.DirectionSweep` has them; ``reach_rad`` (2,) how far the image reaches."""

    cloud: NDArray[np.float32]
    grid: Grid
    truth: NDArray[np.float32]
    classes: NDArray[np.int8]
    asked: NDArray[np.bool_]
    reach_rad: NDArray[np.float32]


class CloudSampler:
    """Draws windows of ``rows`` by ``columns`` cells, most of them around a vehicle."""

    def __init__(
        self, sweeps: Sequence[DirectionSweep], *, rows: int, columns: int, around_objects: float = 0.85
    ) -> None:
        """TrainingError when there is no vehicle to learn from. Rare classes are drawn more often."""
        self._sweeps = sweeps
        self._rows, self._columns, self._around_objects = rows, columns, around_objects
        places = [(number, row) for number, sweep in enumerate(sweeps) for row in np.flatnonzero(sweep.asked).tolist()]
        if not places:
            raise TrainingError("No vehicle in these drives has LiDAR points that an image shows: nothing to learn.")
        self._places = places
        classes = np.array([sweeps[number].classes[row] for number, row in places])
        weight = 1 / np.sqrt(np.bincount(classes))[classes]
        self._chance = np.cumsum(weight / weight.sum())

    def draw(self, rng: np.random.Generator) -> CloudExample:
        """An example, changed in place of others."""
        if rng.random() < self._around_objects:
            place = min(int(np.searchsorted(self._chance, rng.random())), len(self._places) - 1)
            number, row = self._places[place]
            sweep, around = self._sweeps[number], row
        else:
            sweep, around = self._sweeps[int(rng.integers(len(self._sweeps)))], -1
        move = Move.draw(rng)
        truth = move.of_boxes(sweep.truth)
        grid = self._window(truth[around] if around >= 0 else None, rng)
        xy_m = move.of_places(sweep.xyz_cm[:, :2].astype(np.float32) / np.float32(100))
        inside = (xy_m >= (grid.x_min_m, grid.y_min_m)) & (xy_m < (grid.x_max_m, grid.y_max_m))
        cloud = move.of_cloud(sweep.cloud(np.flatnonzero(inside.all(axis=1))))
        example = CloudExample(cloud, grid, truth, sweep.classes, sweep.asked, move.of_reach(sweep.reach_rad))
        return with_spoilt_paint(with_fewer_points(example, rng), rng)

    def _window(self, box: NDArray[np.float32] | None, rng: np.random.Generator) -> Grid:
        """A window that holds the middle of a box, or anywhere."""
        side_m = DIRECTION_GRID.cell_m
        size_m = np.array([self._rows, self._columns]) * side_m
        if box is not None:
            low_m = box[:2] - rng.uniform(0.2, 0.8, 2) * size_m
        else:
            room_m = np.array([DIRECTION_GRID.rows, DIRECTION_GRID.columns]) * side_m - size_m
            low_m = np.array([DIRECTION_GRID.x_min_m, DIRECTION_GRID.y_min_m]) + rng.random(2) * room_m
        return Grid(float(low_m[0]), float(low_m[1]), side_m, self._rows, self._columns)


@dataclass(frozen=True)
class Move:
    """Mirrored (``mirror`` -1) or not, turned about the camera, stretched, and lifted."""

    mirror: float
    turn_rad: float
    stretch: float
    lift_m: float

    @staticmethod
    def draw(rng: np.random.Generator) -> Move:
        mirror = -1.0 if rng.random() < 0.5 else 1.0
        turn_rad = float(rng.uniform(-_TURN_RAD, _TURN_RAD))
        stretch = float(rng.uniform(1 - _STRETCH, 1 + _STRETCH))
        return Move(mirror, turn_rad, stretch, float(rng.normal(0, _HEIGHT_STD_M)))

    def of_places(self, xy_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 2) places, moved."""
        cos, sin = np.cos(self.turn_rad), np.sin(self.turn_rad)
        matrix = self.stretch * np.array([[cos, -sin], [sin, cos]]) @ np.diag([1.0, self.mirror])
        return xy_m @ matrix.T.astype(np.float32)

    def of_cloud(self, cloud: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, D) points, moved."""
        moved = cloud.copy()
        moved[:, :2] = self.of_places(cloud[:, :2])
        moved[:, 2] = cloud[:, 2] * np.float32(self.stretch) + np.float32(self.lift_m)
        return moved

    def of_boxes(self, boxes: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 7) boxes, moved; the ground stays, so they are not lifted."""
        moved = boxes.copy()
        moved[:, :2] = self.of_places(boxes[:, :2])
        moved[:, 2:6] *= np.float32(self.stretch)
        moved[:, 6] = self.mirror * boxes[:, 6] + self.turn_rad
        return moved

    def of_reach(self, reach_rad: NDArray[np.float32]) -> NDArray[np.float32]:
        """(2,) how far the image reaches right and left, moved."""
        return (np.sort(self.mirror * reach_rad) + self.turn_rad).astype(np.float32)


def with_fewer_points(example: CloudExample, rng: np.random.Generator) -> CloudExample:
    """Some of the beams, or of the points, left out; an object that keeps too few is not asked for any more."""
    cloud, kept = example.cloud, np.ones(len(example.cloud), np.bool_)
    if rng.random() < _FEWER_BEAMS:
        elevation = np.arctan2(cloud[:, 2] - _SENSOR_HEIGHT_M, np.hypot(cloud[:, 0], cloud[:, 1]))
        beam = np.floor(elevation / _BEAM_RAD + rng.random()).astype(np.int64)
        beam -= beam.min(initial=0)
        stays = rng.random(int(beam.max(initial=0)) + 1) < rng.uniform(0.3, 0.9)
        kept &= stays[beam]
    if rng.random() < _FEWER_POINTS:
        kept &= rng.random(len(cloud)) < rng.uniform(0.3, 1.0)
    cloud = cloud[kept]
    asked = example.asked.copy()
    for row in np.flatnonzero(asked & near_window(example)).tolist():
        asked[row] = np.count_nonzero(points_inside(cloud[:, :3], example.truth[row], 0.1)) >= MIN_POINTS
    return replace(example, cloud=cloud, asked=asked)


def with_spoilt_paint(example: CloudExample, rng: np.random.Generator) -> CloudExample:
    """The paint of a segmentation, or a calibration, that is worse than the one that painted."""
    cloud = example.cloud.copy()
    scores = cloud[:, SEEN_COLUMN:]
    if len(cloud) and rng.random() < _BESIDE:
        elevation = np.arctan2(cloud[:, 2] - _SENSOR_HEIGHT_M, np.hypot(cloud[:, 0], cloud[:, 1]))
        around = np.stack([np.arctan2(cloud[:, 1], cloud[:, 0]), elevation], axis=1)
        _, source = cKDTree(around).query(around + rng.normal(0, _BESIDE_RAD, 2))
        scores = scores[source]
    if rng.random() < _SPOILT:
        scores[:, 1:] = np.clip(scores[:, 1:] * rng.uniform(0.7, 1.1) + rng.normal(0, 0.03, scores[:, 1:].shape), 0, 1)
        scores[:, 1:] *= scores[:, :1] > 0.5
        for row in np.flatnonzero(example.asked & (rng.random(len(example.asked)) < 0.1)).tolist():
            scores[points_inside(cloud[:, :3], example.truth[row], 0.3), 1] *= np.float32(rng.random() * 0.5)
        if len(cloud):
            for place in rng.integers(len(cloud), size=rng.poisson(0.5)).tolist():
                near = np.abs(cloud[:, :2] - cloud[place, :2]).max(axis=1) < _FALSE_PAINT_M
                scores[near & (scores[:, 0] > 0.5), 1] = rng.uniform(0.3, 1.0)
    if rng.random() < _UNPAINTED:
        scores[:, 1:] = 0
    cloud[:, SEEN_COLUMN:] = scores
    return replace(example, cloud=cloud)


def near_window(example: CloudExample) -> NDArray[np.bool_]:
    """(T,) which vehicles may reach into the window."""
    grid, reach_m = example.grid, np.hypot(example.truth[:, 3], example.truth[:, 4])
    x_m, y_m = example.truth[:, 0], example.truth[:, 1]
    inside = (x_m > grid.x_min_m - reach_m) & (x_m < grid.x_max_m + reach_m)
    return np.asarray(inside & (y_m > grid.y_min_m - reach_m) & (y_m < grid.y_max_m + reach_m))
