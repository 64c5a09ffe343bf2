"""Which detection feeds which track, in crowds as well: only pairs that overlap enough are ever looked at.

Most tracks and detections have one possible partner each, or one that outweighs all others: these are pairs at once.
Those that compete fall into groups that share no member; in each group the pairs are those with the largest total
weight, by the Hungarian method. A group too large for that (it grows with the cube of its size) is paired greedily, the
heaviest first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

_Rows = NDArray[np.intp]
_Corners = tuple[NDArray[np.float64], NDArray[np.float64]]
_COMPARE_ALL_CELLS = 8_000
_CELLS_AT_ONCE = 250_000
_DENSE_CELLS = 40_000
_HUNGARIAN_CELLS = 1_000_000
_FIRST_TURN, _TURN = 1000.0, 10.0  # weights are at most 1, so a pair of an earlier turn ranks before any of a later


@dataclass(frozen=True, eq=False)
class Candidates:
    """Pairs that may match: rows ``a`` and ``b`` (P,) intp, and their ``weight`` (P,) float64, above 0."""

    a: _Rows
    b: _Rows
    weight: NDArray[np.float64]

    def __getitem__(self, chosen: NDArray[np.bool_] | _Rows) -> Candidates:
        return Candidates(self.a[chosen], self.b[chosen], self.weight[chosen])

    @staticmethod
    def of_parts(parts: Sequence[Candidates]) -> Candidates:
        """All of them, in order."""
        if len(parts) == 1:
            return parts[0]
        return Candidates(
            np.concatenate([np.zeros(0, np.intp), *(part.a for part in parts)]),
            np.concatenate([np.zeros(0, np.intp), *(part.b for part in parts)]),
            np.concatenate([np.zeros(0), *(part.weight for part in parts)]),
        )


def overlapping(
    a_upper_left: NDArray[np.float64],
    a_lower_right: NDArray[np.float64],
    b_upper_left: NDArray[np.float64],
    b_lower_right: NDArray[np.float64],
    *,
    min_iou: float,
) -> Candidates:
    """All pairs of boxes with an IoU of at least ``min_iou`` (above 0), by corners (2, A), (2, A), (2, B), (2, B).

    Few boxes are compared all with all. Of many only those are whose left and right sides leave them a chance, so the
    cost of a crowd hardly grows faster than itself. Memory does not grow with the product of their numbers.
    """
    a_count, b_count = a_upper_left.shape[1], b_upper_left.shape[1]
    if a_count * b_count <= _COMPARE_ALL_CELLS:
        sides = np.minimum(a_lower_right[:, :, None], b_lower_right[:, None, :])
        sides -= np.maximum(a_upper_left[:, :, None], b_upper_left[:, None, :])
        a, b = ((sides[0] > 0) & (sides[1] > 0)).nonzero()
        parts = [(a, b)]
    else:
        parts = list(_beside_each_other(a_upper_left[0], a_lower_right[0], b_upper_left[0], b_lower_right[0]))
    found = [
        _close(a, b, (a_upper_left, a_lower_right), (b_upper_left, b_lower_right), min_iou=min_iou) for a, b in parts
    ]
    return Candidates.of_parts(found)


def _close(a: _Rows, b: _Rows, a_corners: _Corners, b_corners: _Corners, *, min_iou: float) -> Candidates:
    """Those of the pairs of rows that overlap enough."""
    (a_upper_left, a_lower_right), (b_upper_left, b_lower_right) = (
        (one.take(a, axis=1) for one in a_corners),
        (one.take(b, axis=1) for one in b_corners),
    )
    sides = np.minimum(a_lower_right, b_lower_right) - np.maximum(a_upper_left, b_upper_left)
    np.maximum(sides, 0, out=sides)
    a_sides, b_sides = a_lower_right - a_upper_left, b_lower_right - b_upper_left
    intersection = sides[0] * sides[1]
    iou = intersection / (a_sides[0] * a_sides[1] + b_sides[0] * b_sides[1] - intersection)
    close = iou >= min_iou
    return Candidates(a[close], b[close], iou[close])


def _beside_each_other(
    a_left: NDArray[np.float64], a_right: NDArray[np.float64], b_left: NDArray[np.float64], b_right: NDArray[np.float64]
) -> Iterator[tuple[_Rows, _Rows]]:
    """Pairs of rows of a and b that share a stretch from left to right, a part of them at a time.

    Of two such boxes one begins inside the other, which a look into the sorted beginnings finds."""
    for begin, left, right, swapped in ((b_left, a_left, a_right, False), (a_left, b_left, b_right, True)):
        order = np.argsort(begin, kind="stable")
        low = np.searchsorted(begin[order], left, side="right" if swapped else "left")
        high = np.searchsorted(begin[order], right, side="left")
        for row, place in ranges_of(low, high):
            yield (order[place], row) if swapped else (row, order[place])


def ranges_of(low: _Rows, high: _Rows) -> Iterator[tuple[_Rows, _Rows]]:
    """Each row (N,) with each place from its ``low`` (N,) up to before its ``high`` (N,): rows and places, flat, about
    as many at a time as memory should hold."""
    count = np.maximum(high - low, 0)
    total = np.cumsum(count)
    first = 0
    while first < len(count):
        done = int(total[first - 1]) if first else 0
        last = max(first + 1, int(np.searchsorted(total, done + _CELLS_AT_ONCE, side="right")))
        part = slice(first, last)
        row = np.repeat(np.arange(first, last), count[part])
        before = np.cumsum(count[part]) - count[part] - low[part]
        yield row, np.arange(len(row)) - np.repeat(before, count[part])
        first = last


def pair_off(candidates: Candidates, *, a_count: int, b_count: int) -> tuple[_Rows, _Rows]:
    """Rows of a and rows of b, one to one, with the largest total weight (greedily in very large groups)."""
    turn = np.zeros(len(candidates.a), np.intp)
    return pair_in_turn(candidates, turn, a_count=a_count, b_count=b_count)


def pair_in_turn(candidates: Candidates, turn: NDArray[np.intp], *, a_count: int, b_count: int) -> tuple[_Rows, _Rows]:
    """Like :func:`pair_off`, turn by turn: candidates of ``turn`` (P,) 0 first, then those of 1 with what is left."""
    clear = _outweighs_rivals(candidates, turn, a_count, b_count)
    a, b = candidates.a[clear], candidates.b[clear]
    free_a, free_b = np.ones(a_count, np.bool_), np.ones(b_count, np.bool_)
    free_a[a] = free_b[b] = False
    open_still = free_a[candidates.a] & free_b[candidates.b]
    if not open_still.any():
        return a, b
    rest, turn = candidates[open_still], turn[open_still]
    found_a, found_b = [a], [b]
    for number in np.flatnonzero(np.bincount(turn)).tolist():
        offered = (turn == number) & free_a[rest.a] & free_b[rest.b]
        a, b = _pair_off_rivals(rest[offered], a_count, b_count)
        free_a[a] = free_b[b] = False
        found_a.append(a)
        found_b.append(b)
    return np.concatenate(found_a), np.concatenate(found_b)


def _outweighs_rivals(candidates: Candidates, turn: NDArray[np.intp], a_count: int, b_count: int) -> NDArray[np.bool_]:
    """(P,) whether a pair weighs as much as the heaviest rivals of both its members together: then none of them could
    do better without it. A rival of an earlier turn outweighs everything, one of a later turn nothing."""
    a, b, weight = candidates.a, candidates.b, candidates.weight
    base = _FIRST_TURN - _TURN * turn
    rank = base + weight
    best_a, best_b = _largest(rank, a, a_count), _largest(rank, b, b_count)
    first = np.flatnonzero((rank == best_a[a]) & (rank == best_b[b]))
    for row, count in ((a, a_count), (b, b_count)):  # of equals one
        chosen = np.empty(count, np.intp)
        chosen[row[first]] = first
        first = first[chosen[row[first]] == first]
    others = np.ones(len(rank), np.bool_)
    others[first] = False
    rival_a = _largest(rank[others], a[others], a_count)[a[first]]
    rival_b = _largest(rank[others], b[others], b_count)[b[first]]
    against = np.maximum(rival_a - base[first], 0) + np.maximum(rival_b - base[first], 0)
    outweighs = np.zeros(len(rank), np.bool_)
    outweighs[first] = weight[first] >= against
    return outweighs


def _largest(values: NDArray[np.float64], row: _Rows, count: int) -> NDArray[np.float64]:
    """(count,) the largest of the values, above 0, of each row; 0 where it has none."""
    largest = np.zeros(count)
    np.maximum.at(largest, row, values)
    return largest


def _pair_off_rivals(candidates: Candidates, a_count: int, b_count: int) -> tuple[_Rows, _Rows]:
    """Pairs among candidates that all compete."""
    if len(candidates.a) <= 1:
        return candidates.a, candidates.b
    a_rows, a_place = _numbered(candidates.a, a_count)
    b_rows, b_place = _numbered(candidates.b, b_count)
    if len(a_rows) * len(b_rows) <= _DENSE_CELLS:
        a, b = _hungarian(a_place, b_place, candidates.weight)
    else:
        a, b = _pair_off_groups(Candidates(a_place, b_place, candidates.weight), len(a_rows), len(b_rows))
    return a_rows[a], b_rows[b]


def _numbered(rows: _Rows, count: int) -> tuple[_Rows, _Rows]:
    """The different rows, all below ``count``, in order, and the place (N,) of each row among them."""
    is_there = np.zeros(count, np.bool_)
    is_there[rows] = True
    return np.flatnonzero(is_there), (np.cumsum(is_there) - 1)[rows]


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
