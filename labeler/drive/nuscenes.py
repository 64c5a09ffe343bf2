"""nuScenes in the layout of its development kit, a scene at a time: https://www.nuscenes.org/nuscenes.

All images and sweeps of the scene are used, those between the key frames too. Tables that only describe (log, map) or
that hold truth may be missing. The city frame is nuScenes' global frame; times are microseconds there.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from labeler.drive.assembly import Recording, assemble
from labeler.drive.errors import DriveError
from labeler.drive.format import DriveFormat
from labeler.drive.listing import counted, folders_in, some_of
from labeler.drive.nuscenes_tables import Row, read_table, rows_where
from labeler.drive.nuscenes_truth import NuscenesTruthReader, TruthMoment
from labeler.drive.poses import poses_from_rows, se3_from_rows
from labeler.drive.sweeps import checked_sweep, read_float32_rows
from labeler.drive.types import Calibration, Drive, ImageFile, Poses, Sweep, SweepFile
from labeler.geometry.se3 import transform_points

_LIDAR = "LIDAR_TOP"
_TABLES = ("scene", "sample", "sample_data", "calibrated_sensor", "sensor", "ego_pose")


@dataclass(frozen=True, eq=False)
class NuscenesSweepReader:
    """Reads ``*.pcd.bin``: x, y, z, intensity, ring as float32 in the LiDAR's frame, which ``ego_SE3_lidar`` maps."""

    ego_SE3_lidar: NDArray[np.float64]

    def __call__(self, file: SweepFile) -> Sweep:
        rows = read_float32_rows(file.path, 5)
        sweep = checked_sweep(file, rows[:, :3], rows[:, 3])
        xyz_m = transform_points(self.ego_SE3_lidar, sweep.xyz_m).astype(np.float32)
        return Sweep(sweep.timestamp_ns, xyz_m, sweep.intensity)


@dataclass(frozen=True)
class _Scene:
    tables: Path
    token: str
    name: str


@dataclass(frozen=True, eq=False)
class _SensorRig:
    """By channel: the calibrations of cameras, and for the LiDAR its place."""

    channel_of: Mapping[str, str]
    calibrations: Mapping[str, Calibration]
    ego_SE3_lidar: NDArray[np.float64]


def _matches(path: Path) -> bool:
    return bool(_table_folders(path))


def _table_folders(path: Path) -> list[Path]:
    return [folder for folder in folders_in(path) if folder.name.startswith("v1.0-") and _is_table_folder(folder)]


def _is_table_folder(folder: Path) -> bool:
    return (folder / "scene.json").is_file() or (folder / "sample_data.json").is_file()


def _open(path: Path, scene: str | None) -> Drive:
    try:
        return _open_scene(path, scene)
    except KeyError as error:
        raise DriveError(f"The tables in {path} are not nuScenes': a row lacks the field {error}.") from error


def _open_scene(path: Path, scene: str | None) -> Drive:
    chosen = _chosen(path, scene)
    warnings: list[str] = []
    samples = rows_where(chosen.tables / "sample.json", "scene_token", {chosen.token})
    readings = rows_where(chosen.tables / "sample_data.json", "sample_token", {str(row["token"]) for row in samples})
    rig = _read_rig(chosen.tables, {str(row["calibrated_sensor_token"]) for row in readings}, warnings)
    by_channel = _by_channel(readings, rig.channel_of)
    files = {channel: _existing(path, channel, rows, warnings) for channel, rows in sorted(by_channel.items())}
    poses, pose_of = _read_poses(chosen.tables, readings, warnings)
    recording = Recording(
        name=chosen.name,
        format=NUSCENES.name,
        root=path,
        images={
            channel: [ImageFile(channel, timestamp_ns, file) for timestamp_ns, file in found]
            for channel, found in files.items()
            if channel != _LIDAR
        },
        sizes_px=_sizes(by_channel),
        calibrations=rig.calibrations,
        sweeps=[SweepFile(timestamp_ns, file) for timestamp_ns, file in files.get(_LIDAR, [])],
        poses=poses,
        read_sweep=NuscenesSweepReader(rig.ego_SE3_lidar),
        read_truth=NuscenesTruthReader(chosen.tables, _truth_moments(by_channel.get(_LIDAR, []), pose_of)),
    )
    return assemble(recording, warnings)


def _chosen(path: Path, scene: str | None) -> _Scene:
    scenes: list[_Scene] = []
    for tables in _table_folders(path):
        missing = [f"{table}.json" for table in _TABLES if not (tables / f"{table}.json").is_file()]
        if missing:
            raise DriveError(f"{tables} lacks {', '.join(missing)}: unpack the nuScenes metadata archive again.")
        scenes += [_Scene(tables, str(row["token"]), str(row["name"])) for row in read_table(tables / "scene.json")]
    chosen = [one for one in scenes if scene in (None, one.name)]
    if len(chosen) == 1:
        return chosen[0]
    listed = chosen or scenes
    names = some_of([one.name for one in listed], at_most=20)
    there = f"{path} holds {counted(len(listed), 'nuScenes scene')}: {names}."
    if chosen:
        raise DriveError(f"{there} Name the one to open as the scene.")
    raise DriveError(f"{path} has no nuScenes scene named {scene}. {there}")


def _read_rig(tables: Path, tokens: set[str], warnings: list[str]) -> _SensorRig:
    """The sensors that the readings name. A camera whose row is missing or makes no sense has no calibration."""
    sensors = {str(row["token"]): row for row in read_table(tables / "sensor.json")}
    channel_of: dict[str, str] = {}
    calibrations: dict[str, Calibration] = {}
    ego_SE3_lidar: NDArray[np.float64] | None = None
    for row in read_table(tables / "calibrated_sensor.json"):
        sensor = sensors.get(str(row["sensor_token"]))
        if row["token"] not in tokens or sensor is None:
            continue
        channel = str(sensor["channel"])
        if sensor["modality"] != "camera" and channel != _LIDAR:
            continue
        channel_of[str(row["token"])] = channel
        ego_SE3_sensor = _se3([row])[0]
        if channel == _LIDAR:
            ego_SE3_lidar = ego_SE3_sensor
            continue
        intrinsics = np.array(row["camera_intrinsic"], dtype=np.float64)
        if intrinsics.shape == (3, 3) and np.isfinite(intrinsics).all() and np.isfinite(ego_SE3_sensor).all():
            calibrations[channel] = Calibration(intrinsics, ego_SE3_sensor)
    if ego_SE3_lidar is None or not np.isfinite(ego_SE3_lidar).all():
        warnings.append(f"No usable calibration of {_LIDAR}: the drive is labelled without LiDAR.")
        channel_of = {token: channel for token, channel in channel_of.items() if channel != _LIDAR}
        ego_SE3_lidar = np.eye(4)
    return _SensorRig(channel_of, calibrations, ego_SE3_lidar)


def _by_channel(readings: Sequence[Row], channel_of: Mapping[str, str]) -> dict[str, list[Row]]:
    """Readings of cameras and LiDAR by channel, each in order of time."""
    by_channel: defaultdict[str, list[Row]] = defaultdict(list)
    for row in readings:
        channel = channel_of.get(str(row["calibrated_sensor_token"]))
        if channel is not None:
            by_channel[channel].append(row)
    return {channel: sorted(rows, key=_timestamp_ns) for channel, rows in by_channel.items()}


def _existing(root: Path, channel: str, rows: Sequence[Row], warnings: list[str]) -> list[tuple[int, Path]]:
    """(timestamp_ns, path) of the files that are there and not empty; the first of several of one time."""
    found: dict[int, Path] = {}
    absent: list[str] = []
    repeated: list[str] = []
    for row in rows:
        file = root / str(row["filename"])
        if not (file.is_file() and file.stat().st_size > 0):
            absent.append(file.name)
        elif _timestamp_ns(row) in found:
            repeated.append(file.name)
        else:
            found[_timestamp_ns(row)] = file
    if absent:
        told = f"{channel}: {len(absent):,} of {counted(len(rows), 'file')} that sample_data names are missing or empty"
        warnings.append(f"{told}: {some_of(absent)}.")
    if repeated:
        warnings.append(f"{channel}: skipped {counted(len(repeated), 'file')} of repeated times: {some_of(repeated)}.")
    return list(found.items())


def _sizes(by_channel: Mapping[str, Sequence[Row]]) -> dict[str, tuple[int, int]]:
    """(width, height) of each camera, where the tables tell it."""
    first = {channel: rows[0] for channel, rows in by_channel.items() if channel != _LIDAR}
    sizes = {channel: (int(row.get("width") or 0), int(row.get("height") or 0)) for channel, row in first.items()}
    return {channel: size_px for channel, size_px in sizes.items() if min(size_px) > 0}


def _read_poses(
    tables: Path, readings: Sequence[Row], warnings: list[str]
) -> tuple[Poses | None, dict[str, NDArray[np.float64]]]:
    """Poses of the scene in order of time, and each by its token."""
    rows = rows_where(tables / "ego_pose.json", "token", {str(row["ego_pose_token"]) for row in readings})
    rows.sort(key=_timestamp_ns)
    city_SE3_ego = _se3(rows)
    # A pose per reading: sensors that fire together repeat a time, which is no fault of the table.
    timestamp_ns = np.array([_timestamp_ns(row) for row in rows], dtype=np.int64)
    _, first = np.unique(timestamp_ns, return_index=True)
    poses = poses_from_rows(timestamp_ns[first], city_SE3_ego[first], source="ego_pose.json", warnings=warnings)
    return poses, {str(row["token"]): pose for row, pose in zip(rows, city_SE3_ego, strict=True)}


def _truth_moments(lidar_rows: Sequence[Row], pose_of: Mapping[str, NDArray[np.float64]]) -> tuple[TruthMoment, ...]:
    return tuple(
        TruthMoment(str(row["sample_token"]), _timestamp_ns(row), pose_of[str(row["ego_pose_token"])])
        for row in lidar_rows
        if row["is_key_frame"] and str(row["ego_pose_token"]) in pose_of
    )


def _se3(rows: Sequence[Row]) -> NDArray[np.float64]:
    wxyz = np.array([cast("list[float]", row["rotation"]) for row in rows], dtype=np.float64).reshape(-1, 4)
    translation_m = np.array([cast("list[float]", row["translation"]) for row in rows], dtype=np.float64)
    return se3_from_rows(wxyz, translation_m.reshape(-1, 3))


def _timestamp_ns(row: Row) -> int:
    return int(row["timestamp"]) * 1000


NUSCENES = DriveFormat(
    name="nuscenes",
    looked_for="a folder v1.0-<version> with scene.json, beside samples and sweeps",
    matches=_matches,
    open=_open,
)
