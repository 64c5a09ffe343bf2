"""Scores that fit how often a detector is right."""

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.calibration import (
    Calibration,
    JudgedBoxes,
    find_calibration,
    fit,
    judge_boxes,
    with_calibration,
)
from labeler.training.pictures import Picture
from labeler.training.yolox_network import Yolox, YoloxShape
from tests.labeler.training.made_pictures import picture

TINY = YoloxShape(depth=0.33, width=0.125, depthwise=True)


def sigmoid(x: np.ndarray) -> np.ndarray:
    return 1 / (1 + np.exp(-x))


def test_the_fit_makes_scores_into_shares_of_hits() -> None:
    """A detector that claims half of what it could: its boxes are hits far more often than its scores say."""
    rng = np.random.default_rng(0)
    objectness, classes = rng.normal(0, 2, 8000).astype(np.float32), rng.normal(1, 1, 8000).astype(np.float32)
    truly = sigmoid(1.5 * objectness + 1.0) * sigmoid(classes + 2.0)
    is_hit = rng.random(8000) < truly

    found = fit(JudgedBoxes(objectness, classes, is_hit))

    score = sigmoid(found.objectness_scale * objectness + found.objectness_shift) * sigmoid(
        found.class_scale * classes + found.class_shift
    )
    for low, high in ((0.1, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.9)):
        inside = (score >= low) & (score < high)
        assert is_hit[inside].mean() == pytest.approx(score[inside].mean(), abs=0.05)


def test_a_calibration_changes_the_logits_and_not_the_boxes() -> None:
    torch.manual_seed(0)
    network = Yolox(4, TINY).eval()
    blob = torch.rand(1, 3, 64, 64) * 255

    with torch.no_grad():
        before, after = network(blob), with_calibration(network, Calibration(2.0, 0.5, 3.0, -1.0))(blob)

    torch.testing.assert_close(after[..., :4], before[..., :4])
    torch.testing.assert_close(after[..., 4], before[..., 4] * 2 + 0.5)
    torch.testing.assert_close(after[..., 5:], before[..., 5:] * 3 - 1)


class KnowsOneBox(torch.nn.Module):
    """Puts a car of 16 x 16 px around the middle of cell (2, 1) of stride 8, and nothing else."""

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        height, width = images.shape[2] // 8, images.shape[3] // 8
        cells = torch.full((1, height * width * 21 // 16, 9), -10.0)
        cells[0, width + 2] = torch.tensor([0.5, 0.5, np.log(2.0), np.log(2.0), 3.0, 2.0, -9.0, -9.0, -9.0])
        return cells


@pytest.mark.parametrize(
    ("shown", "hits"),
    [
        (picture((0, 12, 4, 28, 20)), [True]),  # middle (20, 12): the very box
        (picture((1, 12, 4, 28, 20)), [False]),  # a truck there
        (picture((0, 60, 40, 76, 56)), [False]),  # a car elsewhere
    ],
)
def test_boxes_are_judged_in_pixels_of_the_picture(shown: Picture, hits: list[bool]) -> None:
    judged = judge_boxes(KnowsOneBox(), shown)

    assert judged.is_hit.tolist() == hits
    assert judged.objectness.tolist() == [3.0]
    assert judged.classes.tolist() == [2.0]


def test_too_few_boxes_tell_nothing() -> None:
    assert find_calibration(KnowsOneBox(), [picture((0, 12, 4, 28, 20))]) is None
