"""The units of the LiDAR step: what stands where, in 3D, in a clip of frames.

A row of the table is a detection of a camera that stands somewhere: its position, and its 3D box where it has one (the
box's columns are NaN or 0 where not, and ``score`` is NaN). A frame without a sweep of its own borrows the nearest one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.detection import Detections
from labeler.drive import Camera, DriveFileError, Frame, Poses, SweepFile, SweepReader
from labeler.geometry.se3 import invert_se3
from labeler.lidar import (
    Agreement,
    Boxes3D,
    BoxMaker,
    CameraInput,
    LidarConfig,
    Positions3D,
    Scene,
    View,
    find_positions,
    measure_agreement,
    open_box_maker,
    prepare_scene,
)
from labeler.pipeline.detecting import read_detections
from labeler.pipeline.segmenting import SegmentationClip
from labeler.pipeline.stages import Stage
from labeler.pipeline.tables import Columns, columns_of, concatenate, read_note, rows_of, write_table

_COMPARED_EVERY = 4
"""Cameras and LiDAR are compared in every so-manieth frame."""


@dataclass(frozen=True)
class LidarFrame:
    """One frame: ``sweep`` is its own, or the nearest one; None where none is near.

    ``frame_ego_SE3_sweep_ego`` (4, 4) is the car's motion from the sweep's time to the frame's, and
    ``image_ego_SE3_frame_ego`` (4, 4) by camera that from the frame's time to the image's.
    """

    frame_index: int
    timestamp_ns: int
    sweep: SweepFile | None
    frame_ego_SE3_sweep_ego: NDArray[np.float64]
    image_ego_SE3_frame_ego: Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class LidarUnit:
    """A clip of frames, for every calibrated camera. ``detections`` is that clip's artifact by camera, and so is
    ``segmentation``, which is empty where the drive was not segmented."""

    key: str
    frames: tuple[LidarFrame, ...]
    cameras: tuple[Camera, ...]
    detections: Mapping[str, Path]
    segmentation: Mapping[str, Path]
    read_sweep: SweepReader
    config: LidarConfig
    class_names: tuple[str, ...]

    @property
    def effort(self) -> int:
        return sum(frame.sweep is not None for frame in self.frames)


def lidar_frame(frame: Frame, sweep: SweepFile | None, poses: Poses | None) -> LidarFrame:
    """A frame with the sweep that serves it. Without poses the car is taken to stand still between readings."""
    own, images = np.eye(4), {camera: np.eye(4) for camera in frame.images}
    if poses is not None:
        city_SE3_frame_ego = poses.at(frame.timestamp_ns)
        if sweep is not None and sweep.timestamp_ns != frame.timestamp_ns:
            own = invert_se3(city_SE3_frame_ego) @ poses.at(sweep.timestamp_ns)
        images = {
            camera: invert_se3(poses.at(file.timestamp_ns)) @ city_SE3_frame_ego
            for camera, file in frame.images.items()
        }
    return LidarFrame(frame.index, frame.timestamp_ns, sweep, own, images)


def locate_detections(unit: LidarUnit, path: Path) -> None:
    """Write positions and 3D boxes of a clip. A sweep that can't be read is noted, and its frame done without. Noted as
    well is how the cameras agree with the LiDAR, measured in some of the frames."""
    found = {
        name: {frame.frame_index: frame.detections for frame in read_detections([file])}
        for name, file in unit.detections.items()
    }
    segmented = {name: SegmentationClip(file) for name, file in unit.segmentation.items()}
    maker = open_box_maker(unit.config, class_names=unit.class_names)
    parts = [_columns(Boxes3D.empty(), Positions3D.empty(), Detections.empty(), 0, 0)]
    warnings: list[str] = []
    agreement = {camera.name: Agreement.nothing() for camera in unit.cameras}
    for number, frame in enumerate(unit.frames):
        scene = _scene(frame, unit, warnings)
        cameras = {
            camera.name: CameraInput(
                View.of(camera, frame.image_ego_SE3_frame_ego.get(camera.name)),
                found.get(camera.name, {}).get(frame.frame_index, Detections.empty()),
                segmented[camera.name].at(frame.frame_index) if camera.name in segmented else None,
            )
            for camera in unit.cameras
        }
        parts.extend(_frame_columns(frame.frame_index, scene, cameras, maker, unit))
        if scene is not None and number % _COMPARED_EVERY == 0:
            for name, camera in cameras.items():
                compared = measure_agreement(scene, camera, unit.config, class_names=unit.class_names)
                agreement[name] = agreement[name].plus(compared)
    note = {
        "cameras": list(agreement),
        "warnings": warnings,
        "agreement": {name: asdict(of_camera) for name, of_camera in agreement.items()},
    }
    write_table(path, [concatenate(parts)], note=note)


def agreement_of(paths: Iterable[Path]) -> dict[str, Agreement]:
    """How each camera agrees with the LiDAR, over all clips."""
    total: dict[str, Agreement] = {}
    for path in paths:
        for name, noted in read_note(path)["agreement"].items():
            found = Agreement(noted["near"], noted["found"], tuple(noted["right_deg"]), tuple(noted["down_deg"]))
            total[name] = total.get(name, Agreement.nothing()).plus(found)
    return total


LIDAR = Stage("lidar", 3, "arrow", locate_detections)


def boxes_of(columns: Columns) -> Boxes3D:
    """The 3D boxes among the rows of the table."""
    rows = rows_of(Boxes3D, columns)
    return rows[np.flatnonzero(np.isfinite(rows.score))]


def positions_of(columns: Columns) -> Positions3D:
    """The positions in the rows of the table."""
    rows = rows_of(Positions3D, columns)
    return rows[np.flatnonzero(np.isfinite(rows.position_m[:, 0]))]


def _scene(frame: LidarFrame, unit: LidarUnit, warnings: list[str]) -> Scene | None:
    if frame.sweep is None:
        return None
    try:
        sweep = unit.read_sweep(frame.sweep)
    except DriveFileError as error:
        if str(error) not in warnings:
            warnings.append(str(error))
        return None
    moved = None if frame.sweep.timestamp_ns == frame.timestamp_ns else frame.frame_ego_SE3_sweep_ego
    return prepare_scene(sweep, unit.config, frame_time_ns=frame.timestamp_ns, frame_ego_SE3_sweep_ego=moved)


def _frame_columns(
    frame_index: int, scene: Scene | None, cameras: Mapping[str, CameraInput], maker: BoxMaker, unit: LidarUnit
) -> list[dict[str, NDArray[Any]]]:
    boxes = maker.boxes(scene, cameras) if scene is not None and len(scene.xyz_m) else {}
    parts: list[dict[str, NDArray[Any]]] = []
    for number, (name, camera) in enumerate(cameras.items()):
        own = boxes.get(name, Boxes3D.empty())
        positions = find_positions(own, camera, scene, unit.config, class_names=unit.class_names)
        parts.append(_columns(own, positions, camera.detections, frame_index, number))
    return parts


def _columns(
    boxes: Boxes3D, positions: Positions3D, detections: Detections, frame_index: int, camera: int
) -> dict[str, NDArray[Any]]:
    """A row for each detection that has a box or a position, and for each box without a detection."""
    count = len(detections)
    stray = np.flatnonzero(boxes.detection_index < 0)
    of_boxes, of_positions = columns_of(boxes), columns_of(positions)
    total = count + len(stray)
    columns: dict[str, NDArray[Any]] = {}
    for name, column in of_positions.items():
        columns[name] = _spread(column, positions.detection_index, total)
    box_row = boxes.detection_index.copy()
    box_row[stray] = np.arange(count, total)
    for name, column in of_boxes.items():
        columns[name] = _spread(column, box_row, total)
    columns["detection_index"] = np.concatenate([np.arange(count), np.full(len(stray), -1)]).astype(np.int32)
    said = np.zeros(total, np.bool_)
    said[positions.detection_index] = True
    said[box_row] = True
    columns["frame_index"] = np.full(total, frame_index, np.int32)
    columns["camera"] = np.full(total, camera, np.int16)
    return {name: column[said] for name, column in columns.items()}


def _spread(column: NDArray[Any], row: NDArray[np.integer], count: int) -> NDArray[Any]:
    """The column with its entries at ``row`` of ``count`` rows, and NaN, or 0 where whole numbers stand, elsewhere."""
    blank = np.nan if np.issubdtype(column.dtype, np.floating) else 0
    spread = np.full((count, *column.shape[1:]), blank, column.dtype)
    spread[row] = column
    return spread
