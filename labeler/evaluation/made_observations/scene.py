"""What each camera of a drive could see of the true vehicles: where they stand in its image, how hidden, how far.

It needs no image and no sweep. A 3D box is projected edge by edge, so that a car half behind the camera has the box of
the half before it. Where the drive records true 2D boxes, these say which objects an image shows and how much of them
is visible; else nearer objects hide farther ones, and what no LiDAR point fell on, where that is recorded, is hidden.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Calibration, Camera, Drive, TruthBoxes2D, TruthBoxes3D
from labeler.evaluation.categories import class_of_category
from labeler.evaluation.types import EvaluationError
from labeler.geometry.boxes_2d import area
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.se3 import invert_se3, transform_points

NOTHING = -1
"""The object of a box that lies on none."""

MAX_DISTANCE_M = 120.0
_NEAR_M = 0.2
_MIN_SIDE_PX = 1.5
_FARTHEST_PX = 20.0  # image widths: how far outside of the image a projection may lie
_SAMPLES = 6
_SOLID_SHARE = 0.92  # a vehicle fills its box but for the corners
_EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4)])


@dataclass(frozen=True, eq=False)
class Scene:
    """The truth of a drive, for cameras that have a calibration.

    ``timestamp_ns`` (F,) int64 and ``city_SE3_ego`` (F, 4, 4) of every frame; ``cameras_at`` the names of the cameras
    that look in each. ``boxes`` are true 3D boxes of vehicles in order of frames, ``object_id`` (N,) int32 which object
    each is of, ``category_class`` (N,) int16 its class in :data:`labeler.evaluation.categories.CLASSES`.
    """

    name: str
    cameras: tuple[Camera, ...]
    timestamp_ns: NDArray[np.int64]
    city_SE3_ego: NDArray[np.float64]
    cameras_at: tuple[frozenset[str], ...]
    boxes: TruthBoxes3D
    object_id: NDArray[np.int32]
    category_class: NDArray[np.int16]
    recorded: Mapping[tuple[str, int], RecordedBoxes] | None


@dataclass(frozen=True, eq=False)
class RecordedBoxes:
    """True 2D boxes of one image: ``object_id`` (N,), ``xyxy_px`` (N, 4) whole, ``visible_share`` (N,) in 0..1."""

    object_id: NDArray[np.int32]
    xyxy_px: NDArray[np.float64]
    visible_share: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SeenObjects:
    """The objects that one camera could see in one frame, a row each.

    ``row`` (N,) intp is the row of the scene's boxes; ``xyxy_px`` (N, 4) float64 the box of the whole object, cut at
    the image's edge; ``cut`` (N, 2) float64 how much of the uncut box's width lies beyond the left and the right edge,
    as shares; ``visible_share`` (N,) float64 of the part inside of the image; ``distance_m`` (N,) float64 from the
    camera over the ground.
    """

    row: NDArray[np.intp]
    xyxy_px: NDArray[np.float64]
    cut: NDArray[np.float64]
    visible_share: NDArray[np.float64]
    distance_m: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.row)


def scene_of(drive: Drive, *, max_frames: int | None = None) -> Scene:
    """The scene of a drive; with ``max_frames`` of its first frames only.

    Raises EvaluationError when it lacks true 3D boxes, calibrated cameras or poses."""
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_3d is None or not len(truth.boxes_3d.frame_index):
        raise EvaluationError(f"{drive.root} has no true 3D boxes: name a drive with annotations.feather.")
    cameras = tuple(camera for camera in drive.cameras if camera.calibration is not None)
    if not cameras:
        raise EvaluationError(f"{drive.root} has no calibrated camera, so its truth can't be seen by any.")
    if drive.poses is None:
        raise EvaluationError(f"{drive.root} has no poses of the car (city_SE3_egovehicle.feather).")
    frames = drive.frames[:max_frames]
    poses, names = drive.poses, frozenset(camera.name for camera in cameras)
    boxes, object_id, category_class = _vehicles(truth.boxes_3d, len(frames))
    uuids = {uuid: number for number, uuid in zip(object_id.tolist(), boxes.track_uuid, strict=True)}
    return Scene(
        name=drive.name,
        cameras=cameras,
        timestamp_ns=np.array([frame.timestamp_ns for frame in frames], np.int64),
        city_SE3_ego=np.stack([poses.at(frame.timestamp_ns) for frame in frames]),
        cameras_at=tuple(names & frozenset(frame.images) if frame.images else names for frame in frames),
        boxes=boxes,
        object_id=object_id,
        category_class=category_class,
        recorded=None if truth.boxes_2d is None else _recorded(truth.boxes_2d, uuids),
    )


def seen_objects(scene: Scene) -> Iterator[dict[str, SeenObjects]]:
    """For each frame in order what each camera that looks could see; the cameras always in the same order."""
    starts = np.searchsorted(scene.boxes.frame_index, np.arange(len(scene.timestamp_ns) + 1))
    for frame, looking in enumerate(scene.cameras_at):
        rows = np.arange(int(starts[frame]), int(starts[frame + 1]))
        yield {camera.name: _seen_by(scene, camera, frame, rows) for camera in scene.cameras if camera.name in looking}


def _vehicles(boxes: TruthBoxes3D, frames: int) -> tuple[TruthBoxes3D, NDArray[np.int32], NDArray[np.int16]]:
    """The boxes of vehicles within reach, in order of frames; the number and the class of the object of each."""
    classes = {name: class_of_category(name) for name in set(boxes.category)}
    category_class = np.array([classes[name] for name in boxes.category], np.int16)
    sound: NDArray[np.bool_] = np.isfinite(boxes.center_m).all(axis=1) & np.isfinite(boxes.yaw_rad)
    sound &= boxes.size_m.min(axis=1, initial=np.inf) > 0
    near = np.linalg.norm(boxes.center_m[:, :2], axis=1) <= MAX_DISTANCE_M
    kept = np.flatnonzero(sound & near & (category_class >= 0) & (boxes.frame_index < frames))
    order: NDArray[np.intp] = np.argsort(boxes.frame_index[kept], kind="stable")
    rows = kept[order]
    taken = TruthBoxes3D(
        boxes.frame_index[rows],
        tuple(boxes.track_uuid[int(row)] for row in rows),
        tuple(boxes.category[int(row)] for row in rows),
        boxes.center_m[rows],
        boxes.size_m[rows],
        boxes.yaw_rad[rows],
        None if boxes.num_points is None else boxes.num_points[rows],
    )
    number_of = {uuid: number for number, uuid in enumerate(dict.fromkeys(taken.track_uuid))}
    object_id = np.array([number_of[uuid] for uuid in taken.track_uuid], np.int32)
    return taken, object_id, category_class[rows]


def _recorded(boxes: TruthBoxes2D, number_of: Mapping[str, int]) -> dict[tuple[str, int], RecordedBoxes]:
    rows_of: dict[tuple[str, int], list[int]] = {}
    for row, (camera, frame, uuid) in enumerate(
        zip(boxes.camera, boxes.frame_index.tolist(), boxes.track_uuid, strict=True)
    ):
        if uuid in number_of:
            rows_of.setdefault((camera, frame), []).append(row)
    share = np.ones(len(boxes.camera))
    if boxes.visible_share is not None:
        share = np.clip(np.nan_to_num(boxes.visible_share.astype(np.float64)), 0, 1)
    elif boxes.visible_xyxy_px is not None:
        whole_px2 = np.maximum(area(boxes.xyxy_px), 1e-6)
        share = np.clip(np.nan_to_num(area(boxes.visible_xyxy_px) / whole_px2).astype(np.float64), 0, 1)
    return {
        image: RecordedBoxes(
            np.array([number_of[boxes.track_uuid[row]] for row in rows], np.int32),
            boxes.xyxy_px[rows].astype(np.float64),
            share[rows],
        )
        for image, rows in rows_of.items()
    }


def _seen_by(scene: Scene, camera: Camera, frame: int, rows: NDArray[np.intp]) -> SeenObjects:
    assert camera.calibration is not None
    uncut_px, whole_m = _projected(scene.boxes, rows, camera.calibration, camera.width_px)
    size_px = np.array([camera.width_px, camera.height_px] * 2, np.float64)
    inside_px = np.clip(uncut_px, 0, size_px)
    shown = (inside_px[:, 2:] - inside_px[:, :2] >= _MIN_SIDE_PX).all(axis=1)
    share = np.ones(len(rows))
    if scene.recorded is not None:
        inside_px, share, listed = _as_recorded(scene, camera.name, frame, rows, inside_px)
        shown = listed & (inside_px[:, 2:] > inside_px[:, :2]).all(axis=1)
    chosen = np.flatnonzero(shown)
    camera_m = camera.calibration.ego_SE3_camera[:2, 3]
    distance_m = np.linalg.norm(scene.boxes.center_m[rows[chosen], :2] - camera_m, axis=1)
    if scene.recorded is None:
        share = _unhidden_share(inside_px[chosen], distance_m)
        if scene.boxes.num_points is not None:
            share[scene.boxes.num_points[rows[chosen]] == 0] = 0.0
    else:
        share = share[chosen]
    width_px = np.maximum(uncut_px[chosen, 2] - uncut_px[chosen, 0], 1e-6)
    cut = np.stack([-uncut_px[chosen, 0], uncut_px[chosen, 2] - camera.width_px], axis=1) / width_px[:, None]
    behind = np.where(whole_m[chosen], 0.0, 0.5)[:, None] * (cut > 0)
    return SeenObjects(
        row=rows[chosen],
        xyxy_px=inside_px[chosen],
        cut=np.clip(np.maximum(cut, behind), 0, 1),
        visible_share=share,
        distance_m=distance_m,
    )


def _projected(
    boxes: TruthBoxes3D, rows: NDArray[np.intp], calibration: Calibration, width_px: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """(N, 4) boxes around the part before the camera, not cut at the image's edge and empty where there is none; and
    (N,) whether all of the object is before the camera."""
    if not len(rows):
        return np.zeros((0, 4)), np.zeros(0, np.bool_)
    corners_ego_m = corners_of(boxes.center_m[rows], boxes.size_m[rows], boxes.yaw_rad[rows])
    corners_m = transform_points(invert_se3(calibration.ego_SE3_camera), corners_ego_m.reshape(-1, 3)).reshape(-1, 8, 3)
    a, b = corners_m[:, _EDGES[:, 0]], corners_m[:, _EDGES[:, 1]]
    depth_a, depth_b = a[..., 2:], b[..., 2:]
    step = depth_b - depth_a
    share = np.divide(_NEAR_M - depth_a, step, out=np.zeros_like(step), where=np.abs(step) > 1e-9)
    crossing = a + np.clip(share, 0, 1) * (b - a)
    ends = np.concatenate(
        [np.where(depth_a >= _NEAR_M, a, crossing), np.where(depth_b >= _NEAR_M, b, crossing)], axis=1
    )
    before = ends[..., 2] >= _NEAR_M - 1e-6
    depth_m = np.maximum(ends[..., 2:], _NEAR_M)
    pixel = ends[..., :2] / depth_m @ calibration.intrinsics[:2, :2].T + calibration.intrinsics[:2, 2]
    pixel = np.clip(pixel, -_FARTHEST_PX * width_px, _FARTHEST_PX * width_px)
    low = np.where(before[..., None], pixel, np.inf).min(axis=1)
    high = np.where(before[..., None], pixel, -np.inf).max(axis=1)
    empty = ~before.any(axis=1)
    low[empty], high[empty] = 0, 0
    return np.concatenate([low, high], axis=1), corners_m[..., 2].min(axis=1) >= _NEAR_M


def _as_recorded(
    scene: Scene, camera: str, frame: int, rows: NDArray[np.intp], projected_px: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Boxes and visible shares as recorded, and which objects the image shows by the record."""
    assert scene.recorded is not None
    xyxy_px, share, listed = projected_px.copy(), np.zeros(len(rows)), np.zeros(len(rows), np.bool_)
    image = scene.recorded.get((camera, frame))
    if image is None:
        return xyxy_px, share, listed
    place = {number: at for at, number in enumerate(image.object_id.tolist())}
    for at, number in enumerate(scene.object_id[rows].tolist()):
        if number in place:
            xyxy_px[at], share[at], listed[at] = image.xyxy_px[place[number]], image.visible_share[place[number]], True
    return xyxy_px, share, listed


def _unhidden_share(xyxy_px: NDArray[np.float64], distance_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) share of each box that no nearer object's box covers, from a grid of samples."""
    count = len(xyxy_px)
    if count < 2:
        return np.ones(count)
    at = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    x = xyxy_px[:, None, 0] + at * (xyxy_px[:, 2] - xyxy_px[:, 0])[:, None]
    y = xyxy_px[:, None, 1] + at * (xyxy_px[:, 3] - xyxy_px[:, 1])[:, None]
    shrink = (1 - _SOLID_SHARE) / 2 * (xyxy_px[:, 2:] - xyxy_px[:, :2])
    low, high = xyxy_px[:, :2] + shrink, xyxy_px[:, 2:] - shrink
    in_x = (x[:, None] >= low[None, :, :1]) & (x[:, None] <= high[None, :, :1])
    in_y = (y[:, None] >= low[None, :, 1:]) & (y[:, None] <= high[None, :, 1:])
    nearer = distance_m[None, :] < distance_m[:, None]
    covered = (in_x & nearer[..., None])[..., :, None] & in_y[..., None, :]
    return 1 - covered.any(axis=1).mean(axis=(1, 2))
