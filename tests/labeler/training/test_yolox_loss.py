"""The detector's loss on outputs made by hand."""

import math

import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.yolox_loss import TrueObjects, yolox_loss

INPUT_HW = (32, 32)  # 16 cells of stride 8, 4 of 16, 1 of 32
CELLS = 21
NO_BOXES = torch.zeros(0, 4)
NOTHING = TrueObjects(NO_BOXES, torch.zeros(0, dtype=torch.int64), NO_BOXES)


def output(objectness: float = 0.0) -> torch.Tensor:
    cells = torch.zeros(1, CELLS, 7)
    cells[..., 4] = objectness
    return cells


def test_nothing_to_see_costs_what_the_cells_claim() -> None:
    # Each of 21 cells says one half: -log(1/2) each.
    assert float(yolox_loss(output(), [NOTHING], INPUT_HW)) == pytest.approx(CELLS * math.log(2))


def test_inside_an_ignored_box_a_claim_costs_nothing() -> None:
    # Of stride 8 (centres at 4, 12, 20, 28) four cells lie inside; of stride 16 (8, 24) one; of stride 32 (16) one.
    ignored = TrueObjects(NO_BOXES, torch.zeros(0, dtype=torch.int64), torch.tensor([[0.0, 0, 16, 16]]))

    assert float(yolox_loss(output(), [ignored], INPUT_HW)) == pytest.approx((CELLS - 6) * math.log(2))


def test_a_perfect_answer_costs_almost_nothing() -> None:
    cells = output(-20.0)
    # The cell in column 1, row 1 of stride 8: middle at (1 + .5) * 8 = 12, sides of 8, so 8 to 16.
    cells[0, 5] = torch.tensor([0.5, 0.5, 0.0, 0.0, 20.0, 20.0, -20.0])
    truth = TrueObjects(torch.tensor([[8.0, 8, 16, 16]]), torch.tensor([0]), NO_BOXES)

    assert float(yolox_loss(cells, [truth], INPUT_HW)) == pytest.approx(0.0, abs=1e-4)
    worse = cells.clone()
    worse[0, 5, 5:] = torch.tensor([-20.0, 20.0])  # the other class
    assert float(yolox_loss(worse, [truth], INPUT_HW)) > 30


def test_it_can_be_learned_from() -> None:
    cells = output().requires_grad_()
    truth = TrueObjects(torch.tensor([[6.0, 6, 20, 20]]), torch.tensor([1]), NO_BOXES)

    yolox_loss(cells, [truth], INPUT_HW).backward()

    assert cells.grad is not None
    assert torch.isfinite(cells.grad).all()
    assert (cells.grad.abs().sum(dim=(0, 1)) > 0).all()  # every number of a cell is pulled somewhere
