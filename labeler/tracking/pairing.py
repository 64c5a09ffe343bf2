"""Which detection feeds which track, in crowds as well: only pairs that overlap enough are ever looked at.

Most tracks and detections have one possible partner each: these are pairs at once. Those that compete fall into groups
that share no member; in each group the pairs are those with the largest total weight, by the Hungarian method. A group
too large for that (it grows with the cube of its size) is paired greedily, the heaviest first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

_Rows = NDArray[np.intp]
_CELLS_AT_ONCE = 250_000
_DENSE_CELLS = 40_000
_HUNGARIAN_CELLS = 1_000_000


@dataclass(frozen=True, eq=False)
class Candidates:
    """Pairs that may match: rows ``a`` and ``b`` (P,) intp, and their ``weight`` (P,) float64, above 0."""

    a: _Rows
    b: _Rows
    weight: NDArray[np.float64]

    def __getitem__(self, chosen: NDArray[np.bool_] | _Rows) -> Candidates:
        return Candidates(self.a[chosen], self.b[chosen], self.weight[chosen])


def overlapping(
    a_upper_left: NDArray[np.float64],
    a_lower_right: NDArray[np.float64],
    b_upper_left: NDArray[np.float64],
    b_lower_right: NDArray[np.float64],
    *,
    min_iou: float,
) -> Candidates:
    """All pairs of boxes with an IoU of at least ``min_iou`` (above 0), by corners (2, A), (2, A), (2, B), (2, B).

    Memory does not grow with the product of their numbers.
    """
    b_area = np.multiply(*(b_lower_right - b_upper_left))
    a_area = np.multiply(*(a_lower_right - a_upper_left))
    rows_at_once = max(1, _CELLS_AT_ONCE // max(1, len(b_area)))
    parts: list[Candidates] = []
    for start in range(0, len(a_area), rows_at_once):
        part = slice(start, start + rows_at_once)
        sides = np.minimum(a_lower_right[:, part, None], b_lower_right[:, None, :])
        sides -= np.maximum(a_upper_left[:, part, None], b_upper_left[:, None, :])
        np.maximum(sides, 0, out=sides)
        shared = np.multiply(sides[0], sides[1], out=sides[0])
        a, b = shared.nonzero()
        intersection = shared[a, b]
        iou = intersection / (a_area[part][a] + b_area[b] - intersection)
        close = iou >= min_iou
        parts.append(Candidates(a[close] + start, b[close], iou[close]))
    if len(parts) == 1:
        return parts[0]
    return Candidates(
        np.concatenate([part.a for part in parts]) if parts else np.zeros(0, np.intp),
        np.concatenate([part.b for part in parts]) if parts else np.zeros(0, np.intp),
        np.concatenate([part.weight for part in parts]) if parts else np.zeros(0),
    )


def pair_off(candidates: Candidates, *, a_count: int, b_count: int) -> tuple[_Rows, _Rows]:
    """Rows of a and rows of b, one to one, with the largest total weight (greedily in very large groups)."""
    a, b = candidates.a, candidates.b
    alone = (np.bincount(a, minlength=a_count)[a] == 1) & (np.bincount(b, minlength=b_count)[b] == 1)
    if alone.all():
        return a, b
    rest = candidates[~alone]
    a_rows, a_place = np.unique(rest.a, return_inverse=True)
    b_rows, b_place = np.unique(rest.b, return_inverse=True)
    if len(a_rows) * len(b_rows) <= _DENSE_CELLS:
        found_a, found_b = _hungarian(a_place, b_place, rest.weight)
    else:
        found_a, found_b = _pair_off_groups(Candidates(a_place, b_place, rest.weight), len(a_rows), len(b_rows))
    return np.concatenate([a[alone], a_rows[found_a]]), np.concatenate([b[alone], b_rows[found_b]])


def _pair_off_groups(candidates: Candidates, a_count: int, b_count: int) -> tuple[_Rows, _Rows]:
    """Pairs, group by group: no candidate joins two groups."""
    count = a_count + b_count
    graph = coo_array((candidates.weight, (candidates.a, candidates.b + a_count)), shape=(count, count))
    group = connected_components(graph, directed=False)[1][candidates.a]
    order = np.argsort(group, kind="stable")
    found_a: list[_Rows] = []
    found_b: list[_Rows] = []
    for rows in np.split(order, np.flatnonzero(np.diff(group[order])) + 1):
        a_rows, a_place = np.unique(candidates.a[rows], return_inverse=True)
        b_rows, b_place = np.unique(candidates.b[rows], return_inverse=True)
        pair = _hungarian if len(a_rows) * len(b_rows) <= _HUNGARIAN_CELLS else _greedy
        a, b = pair(a_place, b_place, candidates.weight[rows])
        found_a.append(a_rows[a])
        found_b.append(b_rows[b])
    return np.concatenate(found_a), np.concatenate(found_b)


def _hungarian(a: _Rows, b: _Rows, weight: NDArray[np.float64]) -> tuple[_Rows, _Rows]:
    matrix = np.zeros((int(a.max()) + 1, int(b.max()) + 1))
    matrix[a, b] = weight
    rows, columns = linear_sum_assignment(matrix, maximize=True)
    paired = matrix[rows, columns] > 0
    return rows[paired], columns[paired]


def _greedy(a: _Rows, b: _Rows, weight: NDArray[np.float64]) -> tuple[_Rows, _Rows]:
    partner: dict[int, int] = {}
    taken: set[int] = set()
    order = np.lexsort((b, a, -weight))
    for one, other in zip(a[order].tolist(), b[order].tolist(), strict=True):
        if one not in partner and other not in taken:
            partner[one] = other
            taken.add(other)
    return np.array(list(partner.keys()), np.intp), np.array(list(partner.values()), np.intp)
