"""What the sweep readers of all formats share: points are checked before anything uses them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.drive.errors import DriveFileError
from labeler.drive.types import Sweep, SweepFile


def checked_sweep(
    file: SweepFile,
    xyz_m: NDArray[np.float32],
    intensity: NDArray[np.float32],
    offset_ns: NDArray[np.int32] | None = None,
) -> Sweep:
    """A sweep of the points whose coordinates are finite; an intensity that is not finite becomes 0.

    An empty sweep is valid. DriveFileError when more than half of the points are not finite."""
    good = np.isfinite(xyz_m).all(axis=1)
    points = len(xyz_m)
    bad = points - int(np.count_nonzero(good))
    if 2 * bad > points:
        raise _unusable(file.path, f"holds {bad:,} of {points:,} points that are not finite numbers")
    if bad:
        xyz_m, intensity = xyz_m[good], intensity[good]
        offset_ns = None if offset_ns is None else offset_ns[good]
    intensity = np.nan_to_num(intensity, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
    return Sweep(file.timestamp_ns, xyz_m, intensity, offset_ns)


def read_float32_rows(path: Path, columns: int) -> NDArray[np.float32]:
    """(N, columns) float32 of a file of bare little-endian numbers, row by row. DriveFileError when the file can't be
    read or does not end with a whole row.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _unusable(path, f"can't be read ({error.strerror})") from error
    if len(data) % (4 * columns):
        raise _unusable(
            path, f"is truncated: {len(data):,} bytes are no multiple of {4 * columns}, the size of a point"
        )
    return np.frombuffer(data, dtype="<f4").astype(np.float32).reshape(-1, columns)


def _unusable(path: Path, problem: str) -> DriveFileError:
    return DriveFileError(f"The LiDAR sweep {path} {problem}. Its frame is labelled without LiDAR.")
