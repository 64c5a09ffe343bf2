"""What is known for sure about a simulated moment: the boxes of vehicles in 3D and in every image.

In an image an object has two boxes. The whole box is around the object as if nothing stood in front of it, cut at the
image's edge; it comes from the object's true mesh. The visible box is around the pixels that show it; it comes from the
renderer's buffer of ids, so it is exact to the pixel. The visible share is the part of the pixels it would cover that
show it. Objects of which an image shows no pixel are not listed there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from labeler.geometry.se3 import invert_se3, transform_points
from labeler.simulation.rig import View
from labeler.simulation.silhouettes import covered_pixels, whole_box
from labeler.simulation.solids import Solid

_SHARE_SAMPLES = 1500


@dataclass(frozen=True, eq=False)
class Target:
    """A vehicle that is not the ego car: its number, kind, shape, size as length, width, height in metres, and where
    the middle of its body on the ground is in the ego frame."""

    vehicle_id: int
    track_uuid: str
    category: str
    solid: Solid
    size_m: tuple[float, float, float]
    ego_SE3_body: NDArray[np.float64]

    @property
    def distance_m(self) -> float:
        """Over the ground from the ego frame's origin to the body's middle."""
        return float(np.hypot(*self.ego_SE3_body[:2, 3]))


@dataclass(frozen=True, eq=False)
class TrueBox:
    """One object in one image. Boxes are (4,) x1, y1, x2, y2 in pixels, counted from the image's upper left corner."""

    target: Target
    whole_px: NDArray[np.float64]
    visible_px: NDArray[np.float64]
    visible_pixels: int
    visible_share: float


def boxes_in_image(view: View, ids: NDArray[np.integer], targets: Sequence[Target]) -> list[TrueBox]:
    """The boxes of all targets that an image shows, in their order. ``ids`` (H, W) holds each pixel's vehicle, or a
    number that is no target's."""
    if ids.shape != (view.height_px, view.width_px):
        raise ValueError(f"ids must have shape ({view.height_px}, {view.width_px}), got {ids.shape}")
    counts = np.bincount(ids.ravel().astype(np.int64))
    parts = ndimage.find_objects(ids.astype(np.int32))
    boxes: list[TrueBox] = []
    for target in targets:
        number = target.vehicle_id
        part = parts[number - 1] if number <= len(parts) else None
        if part is None:
            continue
        rows, columns = part
        visible_px = np.array([columns.start, rows.start, columns.stop, rows.stop], dtype=np.float64)
        projected_px = whole_box(view, target.ego_SE3_body, target.solid.triangles_m)
        whole_px = visible_px if projected_px is None else _around(projected_px, visible_px)
        boxes.append(
            TrueBox(
                target=target,
                whole_px=whole_px,
                visible_px=visible_px,
                visible_pixels=int(counts[number]),
                visible_share=_visible_share(view, ids, target, whole_px),
            )
        )
    return boxes


def points_inside(target: Target, xyz_m: NDArray[np.floating], *, margin_m: float = 0.0) -> NDArray[np.bool_]:
    """(N,) which of (N, 3) points in the ego frame lie in a target's 3D box, widened by a margin on all sides."""
    half_m = np.array(target.size_m) / 2
    reach_m = float(np.hypot(half_m[0], half_m[1])) + 2 * margin_m
    near = np.abs(xyz_m[:, 0] - target.ego_SE3_body[0, 3]) <= reach_m
    near &= np.abs(xyz_m[:, 1] - target.ego_SE3_body[1, 3]) <= reach_m
    local_m = transform_points(invert_se3(target.ego_SE3_body), xyz_m[near])
    local_m[:, 2] -= half_m[2]
    near[near] = (np.abs(local_m) <= half_m + margin_m).all(axis=1)
    return near


def _visible_share(view: View, ids: NDArray[np.integer], target: Target, whole_px: NDArray[np.float64]) -> float:
    """Of the pixels that a target would cover, the share that shows it; 1 where it would cover no pixel's centre."""
    covered = covered_pixels(view, target.ego_SE3_body, target.solid, whole_px, at_most=_SHARE_SAMPLES)
    if not len(covered):
        return 1.0
    shown = np.asarray(ids[covered[:, 1], covered[:, 0]] == target.vehicle_id)
    return float(np.count_nonzero(shown) / len(covered))


def _around(a_px: NDArray[np.float64], b_px: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([np.minimum(a_px[:2], b_px[:2]), np.maximum(a_px[2:], b_px[2:])])
