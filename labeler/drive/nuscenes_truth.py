"""The 3D annotations of a nuScenes scene, brought from the global frame into the ego frame of each key frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.drive.nuscenes_tables import Row, read_table, rows_where
from labeler.drive.poses import se3_from_rows
from labeler.drive.types import Frame, Truth, TruthBoxes3D
from labeler.geometry.se3 import invert_se3

_TABLES = ("sample_annotation.json", "instance.json", "category.json")


@dataclass(frozen=True, eq=False)
class TruthMoment:
    """A key frame: the sample, the time of its LiDAR sweep, and where the car was then."""

    sample_token: str
    timestamp_ns: int
    city_SE3_ego: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NuscenesTruthReader:
    """Reads ``sample_annotation.json`` and what it refers to; None where one of the tables or all rows are missing.

    DriveError when a table can't be read."""

    tables: Path
    moments: tuple[TruthMoment, ...]

    def __call__(self, frames: tuple[Frame, ...]) -> Truth | None:
        if not all((self.tables / table).is_file() for table in _TABLES):
            return None
        index_at = {frame.sweep.timestamp_ns: frame.index for frame in frames if frame.sweep is not None}
        moments = {moment.sample_token: moment for moment in self.moments if moment.timestamp_ns in index_at}
        rows = rows_where(self.tables / "sample_annotation.json", "sample_token", moments.keys())
        if not rows:
            return None
        category_of = _categories(self.tables, {str(row["instance_token"]) for row in rows})
        moment_of_row = [moments[str(row["sample_token"])] for row in rows]
        ego_SE3_city = np.stack([invert_se3(moment.city_SE3_ego) for moment in moment_of_row])
        ego_SE3_box = ego_SE3_city @ se3_from_rows(_numbers(rows, "rotation"), _numbers(rows, "translation"))
        return Truth(
            boxes_2d=None,
            boxes_3d=TruthBoxes3D(
                frame_index=np.array([index_at[moment.timestamp_ns] for moment in moment_of_row], dtype=np.int32),
                track_uuid=tuple(str(row["instance_token"]) for row in rows),
                category=tuple(category_of.get(str(row["instance_token"]), "unknown") for row in rows),
                center_m=ego_SE3_box[:, :3, 3],
                size_m=_numbers(rows, "size")[:, [1, 0, 2]],  # recorded as width, length, height
                yaw_rad=np.arctan2(ego_SE3_box[:, 1, 0], ego_SE3_box[:, 0, 0]),
            ),
        )


def _categories(tables: Path, instance_tokens: set[str]) -> dict[str, str]:
    names = {str(row["token"]): str(row["name"]) for row in read_table(tables / "category.json")}
    instances = rows_where(tables / "instance.json", "token", instance_tokens)
    return {str(row["token"]): names.get(str(row["category_token"]), "unknown") for row in instances}


def _numbers(rows: Sequence[Row], key: str) -> NDArray[np.float64]:
    return np.array([row[key] for row in rows], dtype=np.float64)
