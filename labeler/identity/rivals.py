"""How well a track goes on where another begins, beside the other choices that both have."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

_STILL_STD_M = 0.5
_CAP = 5.0


def densities(
    sigmas: NDArray[np.float64], determinant_m4: NDArray[np.float64], still_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(P,) logarithm of how densely the two places of an object would lie here, up to a constant: unlike a distance in
    standard deviations it does not make a track whose place is hardly known fit everywhere. Of two that stand, as if
    their places were known to half a metre."""
    moving = -np.square(sigmas) - np.log(determinant_m4) / 2
    standing = -np.square(still_m / _STILL_STD_M) / 2 - 2 * np.log(_STILL_STD_M)
    return np.fmax(moving, standing)


def over_rivals(
    density: NDArray[np.float64],
    first: NDArray[np.intp],
    second: NDArray[np.intp],
    track_ids: Sequence[int],
    exclude: Callable[[int, int], bool],
) -> NDArray[np.float64]:
    """(P,) by how much a pair's density is above that of its best rival: another choice of either track that this one
    excludes, since the two chosen are two objects; below 0 where the rival is the better one."""
    best = np.full(len(density), -np.inf)
    for side, other in ((first, second), (second, first)):
        order = np.lexsort((-density, side))
        ends = np.flatnonzero(np.diff(side[order])) + 1
        for rows in np.split(order, ends):
            chosen = [(float(density[row]), track_ids[int(other[row])]) for row in rows.tolist()]
            for row, (_, mine) in zip(rows.tolist(), chosen, strict=True):
                rivals = (of_rival for of_rival, track in chosen if of_rival > best[row] and exclude(mine, track))
                best[row] = max(best[row], next(rivals, -np.inf))  # the surest come first
    return np.clip(density - best, -_CAP, _CAP)
