"""Makes a detector's score say how often it is right.

A network that has learned for minutes rather than days is right more often than it claims, and what counts labels above
a confidence counts few. So the logits of objectness and of the classes are stretched and shifted (J. Platt,
"Probabilistic Outputs for Support Vector Machines", 1999) until the score of a box is the probability that it is a hit:
of the right class, with an IoU of at least one half. The four numbers go into the last layer's weights, so the file is
like any other. Boxes whose score is low before are left out: there are thousands, and four numbers can't be right for
them and for the sure ones.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from labeler.detection.classes import suppression_group_of
from labeler.detection.config import DetectionConfig
from labeler.detection.decode import anchor_grid
from labeler.detection.letterbox import fit_letterbox
from labeler.detection.suppression import suppress
from labeler.evaluation.matching import match_greedily, overlapping_pairs
from labeler.training.pictures import DETECTOR_CLASSES, Picture
from labeler.training.yolox_network import Head, Yolox

_MIN_SCORE = 0.2
_HIT_IOU = 0.5
_INSIDE_IGNORED = 0.5
_FEWEST_BOXES = 50
_STEPS = 200


@dataclass(frozen=True)
class Calibration:
    """Factors and offsets of the logits: the new one is ``scale`` times the old one plus ``shift``."""

    objectness_scale: float = 1.0
    objectness_shift: float = 0.0
    class_scale: float = 1.0
    class_shift: float = 0.0


@dataclass(frozen=True, eq=False)
class JudgedBoxes:
    """Boxes that a detector put out: logits of ``objectness`` (N,) and of the best ``classes`` (N,), float32, and
    ``is_hit`` (N,) bool."""

    objectness: NDArray[np.float32]
    classes: NDArray[np.float32]
    is_hit: NDArray[np.bool_]


def find_calibration(network: nn.Module, pictures: Sequence[Picture]) -> Calibration | None:
    """The calibration that fits how often the network is right on ``pictures``; None where it has too few hits or false
    boxes there to tell."""
    judged = [judge_boxes(network, picture) for picture in pictures]
    boxes = JudgedBoxes(
        np.concatenate([each.objectness for each in judged]),
        np.concatenate([each.classes for each in judged]),
        np.concatenate([each.is_hit for each in judged]),
    )
    hits = int(np.count_nonzero(boxes.is_hit))
    return None if min(hits, len(boxes.is_hit) - hits) < _FEWEST_BOXES else fit(boxes)


def fit(boxes: JudgedBoxes) -> Calibration:
    """The calibration under which the boxes' scores explain best which of them are hits (maximum likelihood)."""
    objectness, classes = torch.from_numpy(boxes.objectness), torch.from_numpy(boxes.classes)
    is_hit = torch.from_numpy(boxes.is_hit.astype(np.float32))
    values = torch.tensor([0.0, 0.0, 0.0, 0.0], requires_grad=True)  # logarithms of the scales, then the shifts
    optimizer = torch.optim.LBFGS([values], max_iter=_STEPS, line_search_fn="strong_wolfe")

    def loss() -> Tensor:
        optimizer.zero_grad()
        scale = values[:2].exp()
        score = (objectness * scale[0] + values[2]).sigmoid() * (classes * scale[1] + values[3]).sigmoid()
        cost = nn.functional.binary_cross_entropy(score.clamp(1e-6, 1 - 1e-6), is_hit)
        cost = cost + 1e-3 * values.square().sum()  # of many fits that are as good, the one that changes least
        cost.backward()
        return cost

    optimizer.step(loss)
    a, c, b, d = [float(value) for value in values.detach()]
    return Calibration(float(np.exp(a)), b, float(np.exp(c)), d)


def with_calibration(network: Yolox, calibration: Calibration) -> Yolox:
    """A copy of the network whose last layers stretch and shift their logits."""
    changed = copy.deepcopy(network)
    with torch.no_grad():
        for head in changed.heads:
            assert isinstance(head, Head)
            for layer, scale, shift in (
                (head.objectness, calibration.objectness_scale, calibration.objectness_shift),
                (head.classes, calibration.class_scale, calibration.class_shift),
            ):
                layer.weight.mul_(scale)
                assert layer.bias is not None
                layer.bias.mul_(scale).add_(shift)
    return changed


def judge_boxes(network: nn.Module, picture: Picture) -> JudgedBoxes:
    """Run the network on a whole picture as the detection room does, and say which of its boxes are hits. What falls on
    an ignored box is left out."""
    height, width = picture.image.shape[:2]
    letterbox = fit_letterbox((height, width), height=None, width=None, long_side_px=max(height, width))
    blob = np.empty((1, 3, *letterbox.input_hw), np.float32)
    letterbox.write(picture.image, blob[0])
    with torch.no_grad():
        cells = network.eval()(torch.from_numpy(blob))[0]
    best = cells[:, 5:].max(dim=1)
    score = cells[:, 4].sigmoid() * best.values.sigmoid()
    rows = (score >= _MIN_SCORE).nonzero().squeeze(1)
    grid = anchor_grid(letterbox.input_hw)
    stride = grid.stride_px[rows.numpy()]
    middle = (cells[rows, :2].numpy() + grid.cell[rows.numpy()]) * stride
    half = np.exp(cells[rows, 2:4].numpy()) * stride / 2
    xyxy_px = np.clip(np.concatenate([middle - half, middle + half], axis=1), 0, [width, height, width, height])
    xyxy_px = letterbox.to_image(xyxy_px.astype(np.float32))
    classes = best.indices[rows].numpy()
    kept = suppress(
        xyxy_px,
        score[rows].numpy(),
        suppression_group_of(DETECTOR_CLASSES)[classes],
        iou=DetectionConfig().nms_iou,
        max_candidates=DetectionConfig().max_candidates,
    )
    is_hit, is_ignored = _outcomes(xyxy_px[kept], classes[kept], picture)
    chosen = rows.numpy()[kept][~is_ignored]
    return JudgedBoxes(cells[chosen, 4].numpy(), best.values[chosen].numpy(), is_hit[~is_ignored])


def _outcomes(
    xyxy_px: NDArray[np.float32], classes: NDArray[np.int64], picture: Picture
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which boxes, the surest first, are hits, and which of the others fall on an ignored box."""
    image, truths = np.zeros(len(xyxy_px), np.int64), np.zeros(len(picture.boxes_px), np.int64)
    pairs = overlapping_pairs(image, xyxy_px, truths, picture.boxes_px)
    may_match = (pairs.iou >= _HIT_IOU) & (classes[pairs.a] == picture.classes[pairs.b])
    taken = match_greedily(pairs[may_match], np.arange(len(xyxy_px)), truth_count=len(picture.boxes_px))
    fallen = overlapping_pairs(image, xyxy_px, np.zeros(len(picture.ignored_px), np.int64), picture.ignored_px)
    is_ignored = np.zeros(len(xyxy_px), np.bool_)
    is_ignored[fallen.a[fallen.inside >= _INSIDE_IGNORED]] = True
    return taken >= 0, is_ignored & (taken < 0)
