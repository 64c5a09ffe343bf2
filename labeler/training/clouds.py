"""Simulated drives as the training of pillars wants them: the painted cloud of every camera direction, with its truth.

Painting takes most of the time, so it is done once: the clouds of a drive lie in one file, whole centimetres and bytes,
about 2 MB for 16 moments of four cameras.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.drive import DriveFileError, Frame, read_image
from labeler.drive.types import Drive, Truth, TruthBoxes3D
from labeler.evaluation.categories import CLASSES as COUNTED_CLASSES
from labeler.evaluation.categories import class_of_category
from labeler.lidar import LidarConfig, Scene, View, prepare_scene
from labeler.lidar.pillars.direction import Direction, direction_cloud
from labeler.pipeline.lidar_units import lidar_frame
from labeler.segmentation import Segmenter
from labeler.training.errors import TrainingError
from labeler.training.pictures import DETECTOR_CLASSES, MIN_VISIBLE_PIXELS, opened

PILLAR_CLASSES = DETECTOR_CLASSES
MIN_POINTS = 3
"""A vehicle is asked for when the image shows it and so many points above the ground lie on it."""

_KEPT_X_M, _KEPT_Y_M = (-12.0, 62.0), 60.0
_NEAR_BOX_M = 0.1
_BYTE = 255.0
_FORM = 1


@dataclass(frozen=True, eq=False)
class DirectionSweep:
    """One camera direction of one sweep. ``xyz_cm`` (N, 3) int16 in the direction's frame, z above the ground, and
    ``rest`` (N, 2 + C) uint8, the further columns of a direction's cloud times 255. ``truth`` (T, 7) float32: centre in
    the same frame, length, width, height and yaw; ``classes`` (T,) int8; ``asked`` (T,) bool: false where neither
    finding it nor leaving it out shall count. ``reach_rad`` (2,): how far the image reaches right (negative) and left.
    """

    xyz_cm: NDArray[np.int16]
    rest: NDArray[np.uint8]
    truth: NDArray[np.float32]
    classes: NDArray[np.int8]
    asked: NDArray[np.bool_]
    reach_rad: NDArray[np.float32]

    def cloud(self, rows: NDArray[np.intp] | slice = slice(None)) -> NDArray[np.float32]:
        """(N, 5 + C) as :func:`labeler.lidar.pillars.direction.direction_cloud` made it, rounded; or ``rows`` of it."""
        xyz_m = self.xyz_cm[rows].astype(np.float32) / np.float32(100)
        return np.concatenate([xyz_m, self.rest[rows].astype(np.float32) / np.float32(_BYTE)], axis=1)


def load_clouds(
    drives: Sequence[Path], segmenter: Segmenter, folder: Path, *, painter: str, report: Callable[[str], None]
) -> list[DirectionSweep]:
    """The directions of all drives, painted by ``segmenter`` or read from ``folder``, where they are kept. ``painter``
    names the segmentation: a file that another one painted is made again. TrainingError when a drive can't be learned
    from or ``folder`` can't be written."""
    found: list[DirectionSweep] = []
    for number, drive in enumerate(drives, start=1):
        file = folder / f"{drive.name}-{_key(drive, painter)}.npz"
        if not file.exists():
            report(f"painting drive {number} of {len(drives)}: {drive.name}")
            _keep(file, list(direction_sweeps(opened(drive), segmenter)))
        found += _kept(file)
    return found


def direction_sweeps(drive: Drive, segmenter: Segmenter) -> Iterator[DirectionSweep]:
    """Every calibrated camera of every frame with a sweep. TrainingError when the drive has no true 3D boxes together
    with true boxes in images."""
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_3d is None or truth.boxes_2d is None:
        raise TrainingError(f"{drive.root} has no true 3D boxes together with true boxes in images to learn from.")
    shown = _shown(truth)
    config = LidarConfig()
    for frame in drive.frames:
        if frame.sweep is None:
            continue
        try:
            scene = prepare_scene(drive.read_sweep(frame.sweep), config)
            yield from _of_frame(drive, frame, scene, truth.boxes_3d, shown, segmenter, config)
        except DriveFileError as error:
            raise TrainingError(f"{drive.root} can't be learned from: {error}") from error


def _of_frame(
    drive: Drive, frame: Frame, scene: Scene, boxes: TruthBoxes3D, shown: set[tuple[int, str, str]],
    segmenter: Segmenter, config: LidarConfig,
) -> Iterator[DirectionSweep]:  # fmt: skip
    class_of_row = [class_of_category(name) for name in boxes.category]
    rows = [
        row
        for row in np.flatnonzero(boxes.frame_index == frame.index).tolist()
        if 0 <= class_of_row[row] < len(PILLAR_CLASSES)
    ]
    classes = np.array([PILLAR_CLASSES.index(COUNTED_CLASSES[class_of_row[row]]) for row in rows], np.int8)
    motion = lidar_frame(frame, frame.sweep, drive.poses).image_ego_SE3_frame_ego
    for camera in drive.cameras:
        if camera.name not in frame.images or camera.calibration is None:
            continue
        view = View.of(camera, motion[camera.name])
        scores = segmenter.segment(read_image(frame.images[camera.name], camera))
        cloud, _ = direction_cloud(scene, view, scores, config)
        in_image = np.array([(frame.index, camera.name, boxes.track_uuid[row]) in shown for row in rows], np.bool_)
        yield _direction(cloud, scene, view, boxes, np.array(rows, np.intp), classes, in_image)


def _direction(
    cloud: NDArray[np.float32], scene: Scene, view: View, boxes: TruthBoxes3D, rows: NDArray[np.intp],
    classes: NDArray[np.int8], in_image: NDArray[np.bool_],
) -> DirectionSweep:  # fmt: skip
    near = (cloud[:, 0] > _KEPT_X_M[0]) & (cloud[:, 0] < _KEPT_X_M[1]) & (np.abs(cloud[:, 1]) < _KEPT_Y_M)
    near &= np.abs(cloud[:, 2]) < 300
    cloud = cloud[near]
    direction = Direction.of(view)
    center_m = boxes.center_m[rows].astype(np.float64)
    truth = np.zeros((len(rows), 7), np.float32)
    truth[:, :2] = direction.from_ego(center_m[:, :2])
    truth[:, 2] = center_m[:, 2] - scene.ground.at(center_m[:, :2])
    truth[:, 3:6], truth[:, 6] = boxes.size_m[rows], boxes.yaw_rad[rows] - direction.yaw_rad
    points = np.array([np.count_nonzero(points_inside(cloud[:, :3], box, _NEAR_BOX_M)) for box in truth], np.int64)
    focal_px, middle_px = view.intrinsics[0, 0], view.intrinsics[0, 2]
    reach_rad = -np.arctan((view.size_px[0] - middle_px) / focal_px), np.arctan(middle_px / focal_px)
    return DirectionSweep(
        xyz_cm=np.rint(cloud[:, :3] * 100).astype(np.int16),
        rest=np.rint(np.clip(cloud[:, 3:], 0, 1) * _BYTE).astype(np.uint8),
        truth=truth,
        classes=classes,
        asked=in_image & (points.reshape(-1) >= MIN_POINTS),
        reach_rad=np.array(reach_rad, np.float32),
    )


def points_inside(xyz_m: NDArray[np.float32], box: NDArray[np.floating], margin_m: float) -> NDArray[np.bool_]:
    """(N,) which of (N, 3) points lie in a box (centre, length, width, height, yaw), or so close to it."""
    off_m = xyz_m - box[:3]
    cos, sin = np.cos(box[6]), np.sin(box[6])
    inside = np.abs(cos * off_m[:, 0] + sin * off_m[:, 1]) <= box[3] / 2 + margin_m
    inside &= np.abs(cos * off_m[:, 1] - sin * off_m[:, 0]) <= box[4] / 2 + margin_m
    return np.asarray(inside & (np.abs(off_m[:, 2]) <= box[5] / 2 + margin_m))


def _shown(truth: Truth) -> set[tuple[int, str, str]]:
    """Frame, camera and object of every object that enough pixels show."""
    flat = truth.boxes_2d
    assert flat is not None
    pixels = flat.visible_pixels
    enough = np.ones(len(flat.camera), np.bool_) if pixels is None else pixels >= MIN_VISIBLE_PIXELS
    keys = zip(flat.frame_index.tolist(), flat.camera, flat.track_uuid, strict=True)
    return {key for key, counts in zip(keys, enough, strict=True) if counts}


def _key(drive: Path, painter: str) -> str:
    """Changes with the drive's sweeps and truth, and with what paints."""
    content = hashlib.sha256(f"{_FORM} {painter} {drive.resolve()}".encode())
    for file in sorted([*drive.glob("*.feather"), *drive.glob("sensors/lidar/*")]):
        content.update(f"{file.name} {file.stat().st_size}".encode())
    return content.hexdigest()[:12]


def _keep(file: Path, sweeps: Sequence[DirectionSweep]) -> None:
    columns: dict[str, NDArray[Any]] = {
        name: np.concatenate([getattr(sweep, name) for sweep in sweeps])
        for name in ("xyz_cm", "rest", "truth", "classes", "asked")
    }
    columns["points"] = np.array([len(sweep.xyz_cm) for sweep in sweeps])
    columns["objects"] = np.array([len(sweep.truth) for sweep in sweeps])
    columns["reach_rad"] = np.stack([sweep.reach_rad for sweep in sweeps])
    temporary = file.with_name(f".{file.name}.tmp")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        try:
            with temporary.open("wb") as stream:
                np.savez_compressed(stream, allow_pickle=False, **columns)
            temporary.replace(file)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise TrainingError(f"{file} can't be written: {error.strerror}.") from error


def _kept(file: Path) -> list[DirectionSweep]:
    try:
        with file.open("rb") as stream, np.load(stream) as stored:
            columns = {name: stored[name] for name in stored.files}
    except Exception as error:  # a damaged file fails in many ways
        raise TrainingError(f"{file} can't be read: {error}. Delete it, and it is made again.") from error
    points, objects = np.cumsum([0, *columns["points"]]), np.cumsum([0, *columns["objects"]])
    return [
        DirectionSweep(
            columns["xyz_cm"][points[n] : points[n + 1]],
            columns["rest"][points[n] : points[n + 1]],
            columns["truth"][objects[n] : objects[n + 1]],
            columns["classes"][objects[n] : objects[n + 1]],
            columns["asked"][objects[n] : objects[n + 1]],
            columns["reach_rad"][n],
        )
        for n in range(len(columns["points"]))
    ]
