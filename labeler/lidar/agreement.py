"""Do a camera and the LiDAR agree where things are? A calibration that is off shows in what both see.

The points of an object must lie on its detection. So for each detection that the border does not cut, the points that
hang together and fill it best are taken, with those around the box, and their outline in the image is set against the
box: how far is the middle of the one to the right of, and below, the middle of the other? One object says little, for
boxes are loose and objects half hidden. Over many the median is near 0, unless the camera looks elsewhere than its
calibration says: then it is that angle, for near and far objects alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.clustering import connected_parts
from labeler.lidar.config import LidarConfig, usual_sizes_m
from labeler.lidar.makers import CameraInput
from labeler.lidar.painting.by_boxes import PaintedPoints, paint_points
from labeler.lidar.scene import Scene

_LEAST_POINTS = 15
_LEAST_SCORE = 0.3
_LEAST_TALL_PX = 16
_DEPTH_FITS = (0.6, 1.8)
"""Points count where they are so deep, in units of what the height of the box says."""
_WITHIN_M = 40.0

_LEAST_OBJECTS = 20
_SUSPICIOUS_DEG = 1.0
_STANDARD_ERRORS = 2.0
_LEAST_FOUND = 0.3


@dataclass(frozen=True)
class Agreement:
    """What was compared in one camera: ``near`` detections that look no farther than 40 m away, for how many of them
    fitting points were ``found``, and how far the points of each lie to the right of its detection, and below, in
    degrees: ``right_deg``, ``down_deg``."""

    near: int
    found: int
    right_deg: tuple[float, ...]
    down_deg: tuple[float, ...]

    @staticmethod
    def nothing() -> Agreement:
        return Agreement(0, 0, (), ())

    def plus(self, other: Agreement) -> Agreement:
        return Agreement(
            self.near + other.near,
            self.found + other.found,
            self.right_deg + other.right_deg,
            self.down_deg + other.down_deg,
        )


def measure_agreement(
    scene: Scene, camera: CameraInput, config: LidarConfig, *, class_names: tuple[str, ...]
) -> Agreement:
    """Compare the detections of one image with the points of its frame's sweep."""
    detections, view = camera.detections, camera.view
    boxes_px = detections.xyxy_px.astype(np.float64)
    tall_px = boxes_px[:, 3] - boxes_px[:, 1]
    with np.errstate(invalid="ignore"):
        usable = (detections.score >= _LEAST_SCORE) & (tall_px >= _LEAST_TALL_PX)
        usable &= ~view.sides_cutting(boxes_px).any(axis=1)
    size_m = usual_sizes_m(detections.class_id, class_names)
    depth_m = view.intrinsics[1, 1] * size_m[:, 2] / np.maximum(tall_px, 1)
    rows = np.flatnonzero(usable & (depth_m <= _WITHIN_M))
    if not len(rows):
        return Agreement.nothing()
    painted = paint_points(scene.xyz_m[scene.clear], detections[rows], view, config)
    if not len(painted):
        return Agreement(len(rows), 0, (), ())
    part = connected_parts(painted.xyz_m, painted.detection_index, config)
    right_deg: list[float] = []
    down_deg: list[float] = []
    for number, row in enumerate(rows.tolist()):
        chosen = _points_of(painted, part, number, float(depth_m[row]))
        if len(chosen):
            right, down = _offset_px(painted, chosen, boxes_px[row], view.intrinsics[1, 1] * config.ground_clearance_m)
            right_deg.append(round(float(np.degrees(right / view.intrinsics[0, 0])), 3))
            down_deg.append(round(float(np.degrees(down / view.intrinsics[1, 1])), 3))
    return Agreement(len(rows), len(right_deg), tuple(right_deg), tuple(down_deg))


def calibration_warnings(measured: Mapping[str, Agreement]) -> list[str]:
    """A sentence for each camera, by name, whose calibration does not fit the LiDAR."""
    told: list[str] = []
    for name, agreement in measured.items():
        if agreement.near < _LEAST_OBJECTS:
            continue
        if agreement.found < _LEAST_FOUND * agreement.near:
            told.append(
                f"Camera {name}: only {agreement.found} of {agreement.near} near detections have LiDAR points of their "
                "own. Its calibration, or the times of its images or of the sweeps, are probably wrong. Check them: 3D "
                "boxes and merges of this camera can't be trusted."
            )
            continue
        right_deg, down_deg = _median_beyond_chance(agreement.right_deg), _median_beyond_chance(agreement.down_deg)
        ways: list[str] = []
        if right_deg:
            ways.append(f"{abs(right_deg):.1f} degrees to the {'right' if right_deg > 0 else 'left'} of")
        if down_deg:
            ways.append(f"{abs(down_deg):.1f} degrees {'below' if down_deg > 0 else 'above'}")
        if ways:
            told.append(
                f"Camera {name}: the LiDAR points of objects lie {' and '.join(ways)} where the image shows them "
                f"(median of {agreement.found} objects). Check the camera's calibration, its rotation most of all: 3D "
                "boxes and merges of this camera suffer."
            )
    return told


def _points_of(painted: PaintedPoints, part: NDArray[np.int32], detection: int, depth_m: float) -> NDArray[np.intp]:
    """The rows of the part that has most of a detection's paint; none when it has few points or another depth."""
    mine = np.flatnonzero(painted.detection_index == detection)
    if len(mine) < _LEAST_POINTS:
        return mine[:0]
    parts, of_row = np.unique(part[mine], return_inverse=True)
    best = int(np.bincount(of_row, painted.score[mine], len(parts)).argmax())
    chosen = mine[of_row == best]
    fits = _DEPTH_FITS[0] <= float(np.median(painted.depth_m[chosen])) / depth_m <= _DEPTH_FITS[1]
    return chosen if fits and len(chosen) >= _LEAST_POINTS else chosen[:0]


def _offset_px(
    painted: PaintedPoints, rows: NDArray[np.intp], box_px: NDArray[np.float64], clearance_px_m: float
) -> tuple[float, float]:
    """How far the middle of the points' outline is to the right of the middle of a box, and below it. What lies close
    to the ground was taken away from the points, so the box loses as much."""
    low, high = painted.pixel[rows].min(axis=0), painted.pixel[rows].max(axis=0)
    lowest_px = box_px[3] - clearance_px_m / float(np.median(painted.depth_m[rows]))
    right = (float(low[0] - box_px[0]) + float(high[0] - box_px[2])) / 2
    down = (float(low[1] - box_px[1]) + float(high[1] - lowest_px)) / 2
    return right, down


def _median_beyond_chance(off_deg: Sequence[float]) -> float:
    """The median where it is larger than a degree by more than chance, else 0."""
    if len(off_deg) < _LEAST_OBJECTS / 2:
        return 0.0
    median = float(np.median(off_deg))
    spread = 1.4826 * float(np.median(np.abs(np.array(off_deg) - median)))
    unsure = _STANDARD_ERRORS * 1.2533 * spread / np.sqrt(len(off_deg))
    return median if abs(median) - unsure > _SUSPICIOUS_DEG else 0.0
