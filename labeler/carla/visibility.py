"""Which vehicle each pixel shows, and from this the true boxes in images.

From 0.9.16 on, the instance segmentation camera tells it: red is the semantic tag, green and blue are the low and the
high byte of the actor's number (https://github.com/carla-simulator/carla/pull/8334). Things that are no actors have a
number of the engine's there, which may be an actor's by chance, so only pixels with the tag of a vehicle count.

Older servers show the engine's numbers only, or (0.9.12) have no such camera. There, a pixel shows a vehicle when it
has the tag of one and the point that the depth camera puts there lies in its 3D box: no two vehicles are in one place.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from labeler.carla.coordinates import CarlaImage, depth_of, pixels_of
from labeler.geometry.se3 import transform_points
from labeler.simulation.rig import View
from labeler.simulation.silhouettes import whole_box
from labeler.simulation.truth import Target, TrueBox, boxes_in_image, points_inside

_BOX_MARGIN_M = 0.1
_FILLS_OF_BOX = {"car": 0.71, "truck": 0.71, "bus": 0.83, "motorcycle": 0.40}
"""How much of its 3D box's silhouette a vehicle in full view covers: medians over the simulated fleet, seen from a roof
camera from all sides, 8 to 40 m away. For cars, 5 % cover less than 0.66 and 5 % more than 0.78."""
_NUMBERS = 65536
_GREEN, _BLUE, _RED = 1, 0, 2


def ids_from_instances(image: CarlaImage, targets: Sequence[Target], vehicle_tags: Sequence[int]) -> NDArray[np.int32]:
    """(H, W) int32 of an instance segmentation image: the actor's number, 0 where no target is."""
    pixels = pixels_of(image)
    shown = pixels[..., _GREEN].astype(np.int32) + 256 * pixels[..., _BLUE].astype(np.int32)
    number_of = np.zeros(_NUMBERS, dtype=np.int32)
    for target in targets:
        number_of[target.vehicle_id % _NUMBERS] = target.vehicle_id
    return np.where(np.isin(pixels[..., _RED], vehicle_tags), number_of[shown], 0).astype(np.int32)


def ids_from_depth(
    view: View, depth: CarlaImage, semantics: CarlaImage, targets: Sequence[Target], vehicle_tags: Sequence[int]
) -> NDArray[np.int32]:
    """The same from a depth image and a semantic segmentation image."""
    ids = np.zeros((depth.height, depth.width), dtype=np.int32)
    rows, columns = np.nonzero(np.isin(pixels_of(semantics)[..., _RED], vehicle_tags))
    rays = np.stack([columns + 0.5, rows + 0.5, np.ones(len(rows))], axis=1) @ np.linalg.inv(view.intrinsics).T
    points_camera_m = rays * depth_of(depth)[rows, columns, None]
    points_ego_m = transform_points(view.ego_SE3_camera, points_camera_m)
    for target in targets:
        inside = points_inside(target, points_ego_m, margin_m=_BOX_MARGIN_M)
        ids[rows[inside], columns[inside]] = target.vehicle_id
    return ids


def true_boxes(
    view: View, ids: NDArray[np.int32], targets: Sequence[Target], *, hidden_until_m: float
) -> list[TrueBox]:
    """The boxes of all targets that an image shows, then of those up to a distance that it would show if nothing stood
    in front of them: these have no visible box (NaN), 0 pixels and a share of 0."""
    shown: list[Target] = []
    hidden: list[Target] = []
    present = set(np.unique(ids).tolist())
    for target in targets:
        (shown if target.vehicle_id in present else hidden).append(target)
    boxes = [replace(box, visible_share=_visible_share(box)) for box in boxes_in_image(view, ids, shown)]
    for target in hidden:
        if target.distance_m > hidden_until_m:
            continue
        whole_px = whole_box(view, target.ego_SE3_body, target.solid.triangles_m)
        if whole_px is not None and (whole_px[2:] > whole_px[:2]).all():
            boxes.append(TrueBox(target, whole_px, np.full(4, np.nan), 0, 0.0))
    return boxes


def _visible_share(box: TrueBox) -> float:
    """Estimated, since CARLA tells a vehicle's 3D box but not its shape."""
    return min(1.0, box.visible_share / _FILLS_OF_BOX[box.target.category])
