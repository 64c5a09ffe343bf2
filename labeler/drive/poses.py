"""Ego poses from the rows of a table: bad rows out, in order of time, each time once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from labeler.drive.listing import counted
from labeler.drive.types import Poses


def se3_from_rows(wxyz: NDArray[np.float64], translation_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4, 4) matrices from (N, 4) quaternions, scalar first, of any length, and (N, 3) translations in metres.

    Rows that are not finite or whose quaternion has length zero become NaN."""
    norm = np.linalg.norm(wxyz, axis=1)
    good = np.isfinite(norm) & (norm > 1e-9) & np.isfinite(translation_m).all(axis=1)
    matrices = np.full((len(wxyz), 4, 4), np.nan)
    matrices[good] = np.eye(4)
    if good.any():
        matrices[good, :3, :3] = Rotation.from_quat(wxyz[good][:, [1, 2, 3, 0]]).as_matrix()
    matrices[good, :3, 3] = translation_m[good]
    return matrices


def poses_from_rows(
    timestamp_ns: NDArray[np.int64], city_SE3_ego: NDArray[np.float64], *, source: str, warnings: list[str]
) -> Poses | None:
    """Poses from (N,) times in any order and (N, 4, 4) matrices, of which bad ones are NaN; None when none is left.

    ``source`` names the table in the warnings. Of several rows of one time the first is kept."""
    good = np.isfinite(city_SE3_ego).all(axis=(1, 2))
    if not good.all():
        bad = counted(int(np.count_nonzero(~good)), "pose")
        warnings.append(f"{source}: left out {bad} with a number that is not finite or with a quaternion of length 0.")
    timestamp_ns, city_SE3_ego = timestamp_ns[good], city_SE3_ego[good]
    if not len(timestamp_ns):
        warnings.append(f"{source} holds no pose that can be used: the drive is labelled without ego poses.")
        return None
    if np.any(np.diff(timestamp_ns) < 0):
        warnings.append(f"{source}: the poses were out of order and have been sorted by time.")
    unique_ns, first = np.unique(timestamp_ns, return_index=True)
    if repeated := len(timestamp_ns) - len(unique_ns):
        warnings.append(f"{source}: left out {counted(repeated, 'pose')} of a time that an earlier row already has.")
    return Poses(unique_ns, city_SE3_ego[first])
