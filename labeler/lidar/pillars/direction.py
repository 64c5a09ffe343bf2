"""The cloud of one camera direction: turned so that the camera looks along x, heights above the ground, painted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.cloud import POINT_COLUMNS, paint_cloud
from labeler.lidar.painting.scores import PixelScores
from labeler.lidar.painting.view import View
from labeler.lidar.pillars.grouping import Grid
from labeler.lidar.scene import Scene

PAINTED_CLASSES = ("vehicle", "building", "vegetation")
"""The scores that a painted point carries. Segmentations of streets know all three; one that is not known stays 0."""

SEEN_COLUMN = POINT_COLUMNS
"""After x, y, z and intensity: 1 where the camera's image shows the point; the scores come after it."""

_UPRIGHT = 1e-3


@dataclass(frozen=True, eq=False)
class Direction:
    """Where a camera stands and looks, seen from above: ``origin_m`` (2,) in the ego frame and ``yaw_rad`` of its line
    of sight. The direction's own frame has its origin there and x along the line of sight; y is left."""

    origin_m: NDArray[np.float64]
    yaw_rad: float

    @staticmethod
    def of(view: View) -> Direction:
        """A camera that looks straight up or down takes the direction of its image's upper edge."""
        rotation = view.ego_SE3_camera[:3, :3]
        ahead = rotation[:2, 2] if np.hypot(*rotation[:2, 2]) > _UPRIGHT else -rotation[:2, 1]
        return Direction(view.position_m[:2].astype(np.float64), float(np.arctan2(ahead[1], ahead[0])))

    def from_ego(self, xy_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 2) places in the ego frame, in this frame."""
        cos, sin = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return (xy_m - self.origin_m) @ np.array([[cos, -sin], [sin, cos]])

    def to_ego(self, xy_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 2) places in this frame, in the ego frame."""
        cos, sin = np.cos(self.yaw_rad), np.sin(self.yaw_rad)
        return xy_m @ np.array([[cos, sin], [-sin, cos]]) + self.origin_m


def direction_cloud(
    scene: Scene, view: View, scores: PixelScores | None, config: LidarConfig, *, within: Grid | None = None
) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
    """The points of a scene that stand clear of the ground, in the frame of a camera's direction; with a grid, those
    ``within`` it. (No point outside hides one inside: sight goes outward, and does not come back.)

    (N, 5 + C) float32: x and y in the direction's frame, z above the ground, intensity as a share of the strongest
    ones of the sweep, 1 where the image shows the point, and the C scores of :data:`PAINTED_CLASSES`, all 0 where
    ``scores`` is None. With them (N,) the row of each in the scene. A sweep without known ground gives no points.
    """
    rows, xyz_m, above_m = scene.clear, scene.clear_xyz_m, scene.clear_above_m
    direction = Direction.of(view)
    xy_m = direction.from_ego(xyz_m[:, :2])
    wanted = np.isfinite(above_m)
    if within is not None:
        wanted &= (xy_m[:, 0] >= within.x_min_m) & (xy_m[:, 0] < within.x_max_m)
        wanted &= (xy_m[:, 1] >= within.y_min_m) & (xy_m[:, 1] < within.y_max_m)
    chosen = np.flatnonzero(wanted)
    rows, xyz_m = rows[chosen], xyz_m[chosen]
    painted = paint_cloud(
        xyz_m,
        scene.relative_intensity[rows],
        view,
        painted_classes=PAINTED_CLASSES,
        detections=Detections.empty(),
        class_names=(),
        scores=scores,
        config=config,
    )
    cloud = np.empty((len(rows), SEEN_COLUMN + 1 + len(PAINTED_CLASSES)), np.float32)
    cloud[:, :2] = xy_m[chosen]
    cloud[:, 2] = above_m[chosen]
    cloud[:, 3] = painted.points[:, 3]
    cloud[:, SEEN_COLUMN] = painted.seen
    cloud[:, SEEN_COLUMN + 1 :] = painted.points[:, POINT_COLUMNS:]
    return cloud, rows


def columns_for(painted_classes: Sequence[str]) -> int:
    """How many columns a network's points have: x, y, z, intensity, and where it is painted, seen and the scores."""
    return POINT_COLUMNS + (1 + len(painted_classes) if painted_classes else 0)
