"""Wide images for a network whose input shape is fixed: overlapping tiles, and one box again for an object on a seam.

A letterbox of a wide image would waste most of the input on padding. Tiles stand in one row (or one column). A box that
touches a tile's inner border may be half an object. Next to the seam both tiles see the same strip, so two boxes are of
one object when they agree inside the strip. If one of them is whole it stands for both, else their union does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.geometry.boxes_2d import area, intersection_matrix, iou_matrix

_SAME_IN_STRIP_IOU = 0.5
_COVERED_SHARE = 0.7


@dataclass(frozen=True)
class Tile:
    """A part of an image, in pixels; ``x2`` and ``y2`` are exclusive."""

    x1: int
    y1: int
    x2: int
    y2: int

    @property
    def hw(self) -> tuple[int, int]:
        return self.y2 - self.y1, self.x2 - self.x1

    def cut(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """This part of the (H, W, 3) image, as a view."""
        return image[self.y1 : self.y2, self.x1 : self.x2]


def plan_tiles(
    image_hw: tuple[int, int], input_hw: tuple[int, int], *, aspect_limit: float, overlap: float
) -> tuple[Tile, ...]:
    """The fewest equal tiles, left to right or top to bottom, none ``aspect_limit`` times as wide (high) as the input.

    Next tiles share about ``overlap`` of their length. An image that fits is one tile."""
    height, width = image_hw
    relative = (width / height) / (input_hw[1] / input_hw[0])
    if relative >= aspect_limit:
        return tuple(Tile(a, 0, b, height) for a, b in _spans(width, relative / aspect_limit, overlap))
    if 1 / relative >= aspect_limit:
        return tuple(Tile(0, a, width, b) for a, b in _spans(height, 1 / relative / aspect_limit, overlap))
    return (Tile(0, 0, width, height),)


def _spans(length_px: int, lengths_needed: float, overlap: float) -> list[tuple[int, int]]:
    """Equal spans of [0, length_px], each shorter than ``length_px / lengths_needed``."""
    count = max(2, math.floor((lengths_needed - overlap) / (1 - overlap)) + 1)
    span_px = math.ceil(length_px / (count - (count - 1) * overlap))
    starts = [round(index * (length_px - span_px) / (count - 1)) for index in range(count)]
    return [(start, start + span_px) for start in starts]


@dataclass(frozen=True, eq=False)
class _Cut:
    """Boxes of one tile and which of them reach its inner borders, on the axis along which the tiles stand."""

    boxes: Detections
    at_start: NDArray[np.bool_]
    at_end: NDArray[np.bool_]


def join_tiles(
    tiles: tuple[Tile, ...], detections: list[Detections], group_of_class: NDArray[np.int32], *, reach_px: float
) -> Detections:
    """Boxes of all tiles, given in pixels of the image, with the halves of an object on a seam made one.

    ``reach_px`` says how near to a tile's inner border a box counts as cut by it. Boxes are compared only within a
    group of classes: ``group_of_class`` (C,). What two tiles both see whole is still there twice: suppress it after.
    """
    axis = 0 if tiles[0].y1 == tiles[-1].y1 else 1
    starts = [(tile.x1, tile.y1)[axis] for tile in tiles]
    ends = [(tile.x2, tile.y2)[axis] for tile in tiles]
    done: list[Detections] = []
    before: _Cut | None = None
    for index, boxes in enumerate(detections):
        last = index == len(tiles) - 1
        now = _Cut(
            boxes,
            at_start=(boxes.xyxy_px[:, axis] <= starts[index] + reach_px) & (index > 0),
            at_end=(boxes.xyxy_px[:, axis + 2] >= ends[index] - reach_px) & (not last),
        )
        if before is not None:
            left, now = _join_seam(before, now, axis, (starts[index], ends[index - 1]), group_of_class)
            done.append(left)
        before = now
    if before is not None:
        done.append(before.boxes)
    return Detections(
        np.concatenate([part.xyxy_px for part in done]),
        np.concatenate([part.score for part in done]),
        np.concatenate([part.class_id for part in done]),
    )


def _join_seam(
    a: _Cut, b: _Cut, axis: int, strip_px: tuple[int, int], group_of_class: NDArray[np.int32]
) -> tuple[Detections, _Cut]:
    """What is left of tile a's boxes, and tile b's with those that stand for an object in both."""
    same_group = group_of_class[a.boxes.class_id][:, None] == group_of_class[b.boxes.class_id][None, :]
    in_strip = iou_matrix(_clip(a.boxes.xyxy_px, axis, strip_px), _clip(b.boxes.xyxy_px, axis, strip_px))
    is_cut = a.at_end[:, None] | b.at_start[None, :]
    agreement = np.where(same_group & is_cut, in_strip, 0)

    xyxy, score, class_id = b.boxes.xyxy_px.copy(), b.boxes.score.copy(), b.boxes.class_id.copy()
    at_end = b.at_end.copy()
    a_open, b_open = np.ones(len(a.boxes), np.bool_), np.ones(len(b.boxes), np.bool_)
    rows, columns = np.nonzero(agreement >= _SAME_IN_STRIP_IOU)
    for pair in np.argsort(-agreement[rows, columns], kind="stable"):
        i, j = rows[pair], columns[pair]
        if not (a_open[i] and b_open[j]):
            continue
        a_open[i] = b_open[j] = False
        if a.at_end[i] and b.at_start[j]:
            xyxy[j, :2] = np.minimum(xyxy[j, :2], a.boxes.xyxy_px[i, :2])
            xyxy[j, 2:] = np.maximum(xyxy[j, 2:], a.boxes.xyxy_px[i, 2:])
        elif b.at_start[j]:
            xyxy[j] = a.boxes.xyxy_px[i]
            at_end[j] = False
        if a.boxes.score[i] > score[j]:
            score[j], class_id[j] = a.boxes.score[i], a.boxes.class_id[i]

    # Pieces that found no partner, yet lie inside what the other tile saw.
    inside_b = _covered(a.boxes.xyxy_px, xyxy, same_group) & a.at_end
    inside_a = _covered(b.boxes.xyxy_px, a.boxes.xyxy_px, same_group.T) & b.at_start
    a_stays, b_stays = a_open & ~inside_b, ~(b_open & inside_a)
    joined = Detections(xyxy, score, class_id)[b_stays]
    return a.boxes[a_stays], _Cut(joined, b.at_start[b_stays], at_end[b_stays])


def _clip(xyxy_px: NDArray[np.float32], axis: int, strip_px: tuple[int, int]) -> NDArray[np.float32]:
    clipped = xyxy_px.copy()
    clipped[:, [axis, axis + 2]] = np.clip(clipped[:, [axis, axis + 2]], *strip_px)
    return clipped


def _covered(
    pieces: NDArray[np.float32], others: NDArray[np.float32], same_group: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """(P,) whether most of a piece lies inside one other box of its group."""
    shared = np.where(same_group, intersection_matrix(pieces, others), 0)
    return np.any(shared >= _COVERED_SHARE * np.maximum(area(pieces), 1e-6)[:, None], axis=1)
