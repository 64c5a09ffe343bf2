"""Which label hits which true object, in all images of a part of the drive at once.

The rule is the paper's (and COCO's): in each image labels choose one after the other, the surest first, and each takes
the free true object of its class that it overlaps most, if by at least the asked IoU. A label never loses its object to
a less sure one, so what holds for all labels holds for those above any threshold: one pass serves all thresholds. Ties
go by the boxes' coordinates, so that the order of the rows does not matter.

Only pairs in one image that overlap at all are looked at. Where a label and an object have no other choice they are a
match at once; the few that compete go through a loop.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.boxes_2d import area

INSIDE_SHARE = 0.5
"""A label falls on a don't-care region when at least this share of it lies inside."""

UNMATCHED = -1


@dataclass(frozen=True, eq=False)
class Pairs:
    """Boxes a and b that overlap in one image: rows ``a``, ``b`` (P,) intp, their ``iou`` (P,) float64, and
    ``inside`` (P,) float64, the share of a that lies in b."""

    a: NDArray[np.intp]
    b: NDArray[np.intp]
    iou: NDArray[np.float64]
    inside: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.a)

    def __getitem__(self, rows: NDArray[np.bool_]) -> Pairs:
        return Pairs(self.a[rows], self.b[rows], self.iou[rows], self.inside[rows])


def overlapping_pairs(
    a_image: NDArray[np.int64],
    a_xyxy_px: NDArray[np.floating],
    b_image: NDArray[np.int64],
    b_xyxy_px: NDArray[np.floating],
) -> Pairs:
    """All pairs of boxes in one image whose intersection is not empty.

    ``a_image`` (A,) and ``b_image`` (B,) number the images; ``b_image`` must be sorted. Boxes are (A, 4) and (B, 4).
    """
    start = np.searchsorted(b_image, a_image, side="left")
    count = np.searchsorted(b_image, a_image, side="right") - start
    a = np.repeat(np.arange(len(a_image)), count)
    first = np.cumsum(count) - count
    b = np.arange(len(a)) - np.repeat(first, count) + np.repeat(start, count)
    box_a, box_b = a_xyxy_px[a].astype(np.float64), b_xyxy_px[b].astype(np.float64)
    sides = np.minimum(box_a[:, 2:], box_b[:, 2:]) - np.maximum(box_a[:, :2], box_b[:, :2])
    touching = (sides > 0).all(axis=1)
    a, b, box_a, box_b, sides = a[touching], b[touching], box_a[touching], box_b[touching], sides[touching]
    intersection = sides[:, 0] * sides[:, 1]
    area_a, area_b = area(box_a), area(box_b)
    return Pairs(a, b, intersection / (area_a + area_b - intersection), intersection / area_a)


def rank_labels(
    image: NDArray[np.int64], score: NDArray[np.floating], xyxy_px: NDArray[np.floating]
) -> NDArray[np.int64]:
    """(N,) place of each label in the order in which they choose: by image, surest first, then by the box."""
    rank = np.empty(len(image), np.int64)
    rank[np.lexsort((*xyxy_px.T[::-1], -score, image))] = np.arange(len(image))
    return rank


def match_greedily(pairs: Pairs, rank: NDArray[np.int64], *, truth_count: int) -> NDArray[np.intp]:
    """(N,) row of the true object that each label takes, UNMATCHED where it takes none.

    ``pairs`` are (label, object) that may match at all; ``rank`` (N,) is the order of the labels. Of equal overlaps
    the object with the smaller row is taken.
    """
    taken_by = np.full(len(rank), UNMATCHED, np.intp)
    choices = np.bincount(pairs.a, minlength=len(rank))
    suitors = np.bincount(pairs.b, minlength=truth_count)
    alone = (choices[pairs.a] == 1) & (suitors[pairs.b] == 1)
    taken_by[pairs.a[alone]] = pairs.b[alone]

    rest = pairs[~alone]
    order = np.lexsort((rest.b, -rest.iou, rank[rest.a]))
    matched: dict[int, int] = {}
    taken: set[int] = set()
    for label, truth in zip(rest.a[order].tolist(), rest.b[order].tolist(), strict=True):
        if label not in matched and truth not in taken:
            matched[label] = truth
            taken.add(truth)
    taken_by[list(matched.keys())] = list(matched.values())
    return taken_by


def fallen_on_dont_care(pairs: Pairs, *, label_count: int, min_iou: float) -> NDArray[np.bool_]:
    """(N,) whether a label falls on a don't-care region: IoU of at least ``min_iou``, or at least half of it inside.

    ``pairs`` are (label, region). A region takes any number of labels, of any class.
    """
    fallen = np.zeros(label_count, np.bool_)
    fallen[pairs.a[(pairs.iou >= min_iou) | (pairs.inside >= INSIDE_SHARE)]] = True
    return fallen
