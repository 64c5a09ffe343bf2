"""The noise model: what a detector and a LiDAR step would make of the objects that a camera could see.

All errors have two parts: one that stays for a while with an object in a camera (half hidden from the same side, a bad
angle: it does not average out over a track, and makes runs of misses that break it), and one of the moment. With
distance and with how much of an object is hidden, misses and errors grow and the score falls. A 3D box of an object
that is hidden or cut at the image's edge is drawn towards the part that is seen, and towards the sensor, as boxes are
that are fitted to points. False boxes stand at places far away for a moment, or span a hidden object and the one in
front of it.

``level`` scales it: 0 is exact and complete, 1 the usual, 2 twice the errors and the misses. The numbers stand for a
small network at 10 Hz (YOLOX-nano on the simulated drives); none is taken from a drive that it is measured on.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from labeler.detection.types import Detections
from labeler.drive.types import Camera
from labeler.evaluation.categories import CLASSES
from labeler.evaluation.made_observations.scene import NOTHING, Scene, SeenObjects, seen_objects
from labeler.geometry.se3 import invert_se3
from labeler.lidar.config import LidarConfig
from labeler.lidar.makers import CameraInput
from labeler.lidar.painting.view import View
from labeler.lidar.positions import find_positions
from labeler.lidar.types import Boxes3D, BoxSource, Positions3D

CLASS_NAMES = CLASSES
"""The classes that made detections have; a class id is an index."""

_MEMORY_S = {"miss": 0.4, "box": 0.8, "score": 0.8, "place": 1.5, "shape": 4.0, "class": 0.4}
_GHOSTS_PER_S = 0.5
_GHOST_LIFE_S = 0.5
_GHOST_REACH_M = 80.0
_POINTS_AT_1_M = 5e4
_MIN_POINTS = 4
_QUARTER_TURN_SIGMA = 1.75


@dataclass(frozen=True)
class Noise:
    """How strong the noise is, from which seed, and whether there is a LiDAR to make 3D boxes with."""

    level: float = 1.0
    seed: int = 0
    lidar: bool = True

    def __post_init__(self) -> None:
        if not (math.isfinite(self.level) and 0 <= self.level <= 5):
            raise ValueError(f"The noise must be from 0 (exact) to 5, got {self.level}.")


@dataclass(frozen=True, eq=False)
class MadeFrame:
    """One camera in one frame: detections, 3D boxes of some of them, where each stands, and the object of each.

    ``object_id`` (N,) int32, NOTHING where a detection lies on none. ``truth`` is what could be seen.
    """

    frame_index: int
    timestamp_ns: int
    detections: Detections
    boxes_3d: Boxes3D
    positions: Positions3D
    object_id: NDArray[np.int32]
    truth: SeenObjects


def make_frames(scene: Scene, noise: Noise) -> Iterator[dict[str, MadeFrame]]:
    """Every camera in every frame, in order of time; the same scene and noise give the same."""
    makers = {camera.name: _CameraNoise(scene, camera, noise) for camera in scene.cameras}
    for frame, seen in enumerate(seen_objects(scene)):
        yield {name: makers[name].make(frame, objects) for name, objects in seen.items()}


@dataclass
class _Ghost:
    """A false box that stands at a place for a moment: ``until_ns``, ``place_m`` in the city frame, and its size."""

    until_ns: int
    place_m: NDArray[np.float64]
    size_m: tuple[float, float]
    score: float


@dataclass
class _Wander:
    """Errors of one object in one camera that stay for a while: a number of unit normals of each kind."""

    timestamp_ns: int
    values: dict[str, NDArray[np.float64]] = field(default_factory=dict[str, NDArray[np.float64]])


_KINDS = {"miss": 1, "box": 5, "score": 1, "place": 2, "shape": 6, "class": 1}


class _CameraNoise:
    """The noise of one camera, frame by frame."""

    def __init__(self, scene: Scene, camera: Camera, noise: Noise) -> None:
        assert camera.calibration is not None
        self._scene = scene
        self._camera = camera
        self._calibration = camera.calibration
        self._noise = noise
        self._random = np.random.default_rng([noise.seed, zlib.crc32(camera.name.encode())])
        self._wanders: dict[int, _Wander] = {}
        self._ghosts: list[_Ghost] = []
        self._before_ns: int | None = None

    def make(self, frame: int, seen: SeenObjects) -> MadeFrame:
        now_ns = int(self._scene.timestamp_ns[frame])
        objects = self._scene.object_id[seen.row]
        drift = self._drift(objects, now_ns)
        found = np.flatnonzero(self._found(seen, drift))
        xyxy_px, score = self._boxes(seen, drift)
        class_id = self._classes(seen, drift)
        parts = [(xyxy_px[found], score[found], class_id[found], objects[found])]
        parts += [self._doubles(seen, objects), self._ghost_boxes(frame, now_ns)]
        boxes_px, scores, classes, owner = (np.concatenate(column) for column in zip(*parts, strict=True))
        boxes_px = np.clip(boxes_px, 0, [self._camera.width_px, self._camera.height_px] * 2)
        sound = np.flatnonzero((boxes_px[:, 2:] - boxes_px[:, :2] > 1).all(axis=1))
        order = sound[np.argsort(-scores[sound], kind="stable")]
        place_of = np.full(len(boxes_px), NOTHING)
        place_of[order] = np.arange(len(order))
        boxes_3d = self._boxes_3d(seen, found, drift, place_of[: len(found)], classes)
        self._before_ns = now_ns
        detections = Detections(
            boxes_px[order].astype(np.float32), scores[order].astype(np.float32), classes[order].astype(np.int16)
        )
        seen_here = CameraInput(View.of(self._camera), detections)
        return MadeFrame(
            frame_index=frame,
            timestamp_ns=now_ns,
            detections=detections,
            boxes_3d=boxes_3d,
            positions=find_positions(boxes_3d, seen_here, None, LidarConfig(), class_names=CLASS_NAMES),
            object_id=owner[order].astype(np.int32),
            truth=seen,
        )

    def _drift(self, objects: NDArray[np.int32], now_ns: int) -> dict[str, NDArray[np.float64]]:
        """For each kind of error (N, K) unit normals that wander: correlated over the time that the kind remembers."""
        rows: dict[str, list[NDArray[np.float64]]] = {kind: [] for kind in _KINDS}
        for number in objects.tolist():
            wander = self._wanders.get(number)
            if wander is None:
                values = {kind: self._random.standard_normal(width) for kind, width in _KINDS.items()}
                wander = self._wanders[number] = _Wander(now_ns, values)
            elapsed_s = (now_ns - wander.timestamp_ns) / 1e9
            for kind, width in _KINDS.items():
                kept = math.exp(-elapsed_s / _MEMORY_S[kind])
                fresh = math.sqrt(1 - kept * kept) * self._random.standard_normal(width)
                wander.values[kind] = kept * wander.values[kind] + fresh
                rows[kind].append(wander.values[kind])
            wander.timestamp_ns = now_ns
        return {kind: np.array(of_kind).reshape(len(objects), _KINDS[kind]) for kind, of_kind in rows.items()}

    def _hidden(self, seen: SeenObjects) -> NDArray[np.float64]:
        """(N,) how much of each object is not seen: hidden, or beyond the image's edge."""
        return 1 - seen.visible_share * (1 - np.minimum(seen.cut.sum(axis=1), 1))

    def _found(self, seen: SeenObjects, drift: dict[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
        hidden = self._hidden(seen)
        chance = 0.97 * np.exp(-np.square(seen.distance_m / 75)) * np.clip((0.92 - hidden) / 0.5, 0, 1)
        chance = np.where(hidden < 0.98, np.power(chance, self._noise.level), 0.0)  # exact: all that shows at all
        return _share_below(drift["miss"][:, 0]) < chance

    def _boxes(
        self, seen: SeenObjects, drift: dict[str, NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(N, 4) boxes and (N,) scores of all objects, as if all were found."""
        level, count, hidden = self._noise.level, len(seen), self._hidden(seen)
        side_px = seen.xyxy_px[:, 2:] - seen.xyxy_px[:, :2]
        std = level * (0.02 + 0.0006 * seen.distance_m)[:, None]
        error = std * (drift["box"][:, :4] + self._random.standard_normal((count, 4)))
        # What is hidden from one side loses that side, for as long as the error stays.
        lost = level * np.clip(1 - seen.visible_share, 0, 0.8) * _share_below(drift["box"][:, 4]) * 0.6
        from_left = drift["shape"][:, 0] > 0
        error[:, 0] += np.where(from_left, lost, 0)
        error[:, 2] -= np.where(from_left, 0, lost)
        boxes_px = seen.xyxy_px + error * np.tile(side_px, 2)
        score = 0.93 * np.exp(-np.square(seen.distance_m / 85)) * np.sqrt(np.clip(1 - hidden, 0, 1))
        score += 0.07 * level * (drift["score"][:, 0] + self._random.standard_normal(count))
        return boxes_px, np.clip(score, 0.05, 0.98)

    def _classes(self, seen: SeenObjects, drift: dict[str, NDArray[np.float64]]) -> NDArray[np.int64]:
        """Cars and trucks are taken for each other, more so far away and half hidden."""
        true = self._scene.category_class[seen.row].astype(np.int64)
        chance = self._noise.level * (0.03 + 0.002 * seen.distance_m + 0.2 * self._hidden(seen))
        wavers = _share_below(drift["class"][:, 0]) < np.minimum(chance, 0.5)
        car, truck = CLASSES.index("car"), CLASSES.index("truck")
        other = np.where(true == car, truck, np.where(true == CLASSES.index("motorcycle"), true, car))
        return np.where(wavers, other, true)

    def _doubles(
        self, seen: SeenObjects, objects: NDArray[np.int32]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.int32]]:
        """Boxes that span a hidden object and a nearer one that stands in front of it."""
        half_hidden = (seen.visible_share > 0.1) & (seen.visible_share < 0.7)
        chance = 0.06 * self._noise.level * half_hidden
        rows = np.flatnonzero(self._random.random(len(seen)) < chance)
        low, high = seen.xyxy_px[:, :2], seen.xyxy_px[:, 2:]
        boxes: list[NDArray[np.float64]] = []
        owner: list[int] = []
        for row in rows.tolist():
            touching = (low < high[row]).all(axis=1) & (high > low[row]).all(axis=1)
            nearer = np.flatnonzero(touching & (seen.distance_m < seen.distance_m[row]))
            if len(nearer):
                front = nearer[seen.distance_m[nearer].argmax()]
                boxes.append(np.concatenate([np.minimum(low[row], low[front]), np.maximum(high[row], high[front])]))
                owner.append(int(objects[row]))
        scores = self._random.uniform(0.1, 0.5, len(boxes))
        return (
            np.array(boxes).reshape(-1, 4),
            scores,
            np.zeros(len(boxes), np.int64),
            np.array(owner, np.int32),
        )

    def _ghost_boxes(
        self, frame: int, now_ns: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.int32]]:
        self._ghosts = [ghost for ghost in self._ghosts if ghost.until_ns >= now_ns]
        elapsed_s = 0.1 if self._before_ns is None else min(1.0, (now_ns - self._before_ns) / 1e9)
        city_SE3_ego = self._scene.city_SE3_ego[frame]
        for _ in range(self._random.poisson(_GHOSTS_PER_S * self._noise.level * elapsed_s)):
            self._ghosts.append(self._new_ghost(city_SE3_ego, now_ns))
        boxes: list[NDArray[np.float64]] = []
        scores: list[float] = []
        for ghost in self._ghosts:
            camera_SE3_city = invert_se3(city_SE3_ego @ self._calibration.ego_SE3_camera)
            x_m, y_m, depth_m = (camera_SE3_city[:3, :3] @ ghost.place_m + camera_SE3_city[:3, 3]).tolist()
            if depth_m < 1:
                continue
            focal_px = np.diag(self._calibration.intrinsics)[:2]
            middle = focal_px * np.array([x_m, y_m]) / depth_m + self._calibration.intrinsics[:2, 2]
            half = focal_px * np.array(ghost.size_m) / depth_m / 2 * np.exp(0.05 * self._random.standard_normal(2))
            box = np.concatenate([middle - half, middle + half])
            if (box[:2] < [self._camera.width_px, self._camera.height_px]).all() and (box[2:] > 0).all():
                boxes.append(box)
                scores.append(ghost.score + 0.05 * float(self._random.standard_normal()))
        count = len(boxes)
        return (
            np.array(boxes).reshape(-1, 4),
            np.clip(np.array(scores), 0.05, 0.7),
            np.zeros(count, np.int64),
            np.full(count, NOTHING, np.int32),
        )

    def _new_ghost(self, city_SE3_ego: NDArray[np.float64], now_ns: int) -> _Ghost:
        """Somewhere in the image on the ground, as likely at any place seen from above: mostly far."""
        depth_m = _GHOST_REACH_M * math.sqrt(self._random.uniform(0.02, 1))
        x_px = self._random.uniform(0, self._camera.width_px)
        ray = (x_px - self._calibration.intrinsics[0, 2]) / self._calibration.intrinsics[0, 0]
        place = self._calibration.ego_SE3_camera @ np.array([ray * depth_m, 0.0, depth_m, 1.0])
        place[2] = 0.8
        life_s = self._random.exponential(_GHOST_LIFE_S)
        size_m = (float(self._random.uniform(1.5, 5)), float(self._random.uniform(1.2, 2.5)))
        score = float(self._random.uniform(0.1, 0.55))
        return _Ghost(now_ns + round(life_s * 1e9), (city_SE3_ego @ place)[:3], size_m, score)

    def _boxes_3d(
        self,
        seen: SeenObjects,
        found: NDArray[np.intp],
        drift: dict[str, NDArray[np.float64]],
        place_of: NDArray[np.intp],
        classes: NDArray[np.int64],
    ) -> Boxes3D:
        """The 3D boxes of the found objects that enough points fall on."""
        if not self._noise.lidar or not len(found):
            return Boxes3D.empty()
        boxes, level = self._scene.boxes, self._noise.level
        rows, hidden = seen.row[found], self._hidden(seen)[found]
        points = self._points(seen, found, hidden)
        center_m, size_m = boxes.center_m[rows].copy(), boxes.size_m[rows]
        camera_m = self._calibration.ego_SE3_camera[:2, 3]
        sight = center_m[:, :2] - camera_m
        distance_m = np.maximum(np.linalg.norm(sight, axis=1), 1e-6)
        sight /= distance_m[:, None]
        aside = np.stack([sight[:, 1], -sight[:, 0]], axis=1)  # to the right of the line of sight
        moment = self._random.standard_normal((len(found), 2))
        stays = drift["place"][found]
        along_std_m = level * (0.12 + 0.005 * distance_m + 0.45 * hidden)
        aside_std_m = level * (0.06 + 0.002 * distance_m + 0.30 * hidden)
        along_m = along_std_m * (0.8 * stays[:, 0] + 0.6 * moment[:, 0])
        aside_m = aside_std_m * (0.8 * stays[:, 1] + 0.6 * moment[:, 1])
        reach_m = size_m[:, :2].mean(axis=1) / 2
        nearer = _share_below(drift["shape"][found, 1])  # of what is half hidden only the near part is seen
        along_m -= level * 0.5 * reach_m * hidden * nearer
        cut = seen.cut[found]
        aside_m += level * 0.6 * reach_m * (cut[:, 0] - cut[:, 1])  # what lies beyond an edge is not boxed
        stray = _share_below(drift["shape"][found, 2]) > 1 - 0.03 * level * (1 + 3 * hidden)
        along_m += np.where(stray, level * 3 * np.abs(drift["shape"][found, 3]) + 1, 0)  # the points behind it
        center_m[:, :2] += along_m[:, None] * sight + aside_m[:, None] * aside
        center_m[:, 2] += 0.08 * level * self._random.standard_normal(len(found))
        grown = np.exp(level * 0.1 * drift["shape"][found, 3:6])
        turned = np.abs(drift["shape"][found, 5]) > _QUARTER_TURN_SIGMA / max(level, 1e-6)
        yaw_std_rad = level * np.radians(3 + 0.1 * distance_m)
        yaw_rad = boxes.yaw_rad[rows] + yaw_std_rad * self._random.standard_normal(len(found))
        yaw_rad += np.where(turned, np.pi / 2, 0) + np.pi * self._random.integers(0, 2, len(found))
        center_std_m = np.hypot(along_std_m, aside_std_m) / np.sqrt(2)  # which way a box is off, nobody tells
        kept = np.flatnonzero((points >= _MIN_POINTS) & (place_of >= 0))
        kept = kept[np.argsort(place_of[kept])]
        return Boxes3D(
            center_m=center_m[kept].astype(np.float32),
            size_m=(size_m * grown)[kept].astype(np.float32),
            yaw_rad=yaw_rad[kept].astype(np.float32),
            score=(points[kept] / (points[kept] + 10.0)).astype(np.float32),
            class_id=classes[kept].astype(np.int16),
            num_points=points[kept].astype(np.int32),
            detection_index=place_of[kept].astype(np.int32),
            source=np.full(len(kept), BoxSource.CLUSTER, np.int8),
            center_std_m=np.tile(center_std_m[kept, None], (1, 2)).astype(np.float32),
            yaw_std_rad=yaw_std_rad[kept].astype(np.float32),
            seen_m=np.full((len(kept), 4), np.nan, np.float32),
            offset_s=np.zeros(len(kept), np.float32),
        )

    def _points(self, seen: SeenObjects, found: NDArray[np.intp], hidden: NDArray[np.float64]) -> NDArray[np.int64]:
        """(M,) LiDAR points on each found object: as recorded, else by distance; the hidden part has none."""
        if self._scene.boxes.num_points is not None:
            expected = self._scene.boxes.num_points[seen.row[found]] * (1 - np.minimum(seen.cut[found].sum(axis=1), 1))
        else:
            expected = _POINTS_AT_1_M / np.square(np.maximum(seen.distance_m[found], 3)) * (1 - hidden)
        return self._random.poisson(np.maximum(expected, 0)).astype(np.int64)


def _share_below(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of unit normals the share of all that are smaller: evenly spread from 0 to 1."""
    return np.asarray(ndtr(normal), np.float64)
