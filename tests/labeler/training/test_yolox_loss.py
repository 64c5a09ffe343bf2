"""The detector's loss on outputs made by hand."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.assignment import assign
from labeler.training.devices import CPU
from labeler.training.pictures import Picture
from labeler.training.yolox_loss import TrueObjects, _grid_on, yolox_loss  # pyright: ignore[reportPrivateUsage]

INPUT_HW = (32, 32)  # 16 cells of stride 8, 4 of 16, 1 of 32
CELLS = 21
Box = tuple[float, float, float, float]


def shown(*boxes: Box, classes: Sequence[int] = (), ignored: Sequence[Box] = ()) -> Picture:
    return Picture(
        image=np.zeros((*INPUT_HW, 3), np.uint8),
        boxes_px=np.array(boxes, np.float32).reshape(-1, 4),
        classes=np.array(classes, np.int64),
        ignored_px=np.array(ignored, np.float32).reshape(-1, 4),
        semantic=None,
    )


def truth(*pictures: Picture) -> TrueObjects:
    return TrueObjects.of(pictures, CPU)


def output(objectness: float = 0.0) -> torch.Tensor:
    cells = torch.zeros(1, CELLS, 7)
    cells[..., 4] = objectness
    return cells


def test_nothing_to_see_costs_what_the_cells_claim() -> None:
    # Each of 21 cells says one half: -log(1/2) each.
    assert float(yolox_loss(output(), truth(shown()), INPUT_HW)) == pytest.approx(CELLS * math.log(2))


def test_inside_an_ignored_box_a_claim_costs_nothing() -> None:
    # Of stride 8 (centres at 4, 12, 20, 28) four cells lie inside; of stride 16 (8, 24) one; of stride 32 (16) one.
    ignored = shown(ignored=[(0, 0, 16, 16)])

    assert float(yolox_loss(output(), truth(ignored), INPUT_HW)) == pytest.approx((CELLS - 6) * math.log(2))


def test_a_perfect_answer_costs_almost_nothing() -> None:
    cells = output(-20.0)
    # The cell in column 1, row 1 of stride 8: middle at (1 + .5) * 8 = 12, sides of 8, so 8 to 16.
    cells[0, 5] = torch.tensor([0.5, 0.5, 0.0, 0.0, 20.0, 20.0, -20.0])
    car = truth(shown((8, 8, 16, 16), classes=[0]))

    assert float(yolox_loss(cells, car, INPUT_HW)) == pytest.approx(0.0, abs=1e-4)
    worse = cells.clone()
    worse[0, 5, 5:] = torch.tensor([-20.0, 20.0])  # the other class
    assert float(yolox_loss(worse, car, INPUT_HW)) > 30


def test_it_can_be_learned_from() -> None:
    cells = output().requires_grad_()
    yolox_loss(cells, truth(shown((6, 6, 20, 20), classes=[1])), INPUT_HW).backward()

    assert cells.grad is not None
    assert torch.isfinite(cells.grad).all()
    assert (cells.grad.abs().sum(dim=(0, 1)) > 0).all()  # every number of a cell is pulled somewhere


def test_images_of_a_batch_count_as_if_they_were_alone() -> None:
    """Filled up with what is not there, whatever the others show: sums over images, divided by the cells asked."""
    cells = torch.randn(3, CELLS, 7, generator=torch.Generator().manual_seed(1))
    pictures = [
        shown((4, 4, 14, 12), (10, 8, 30, 30), classes=[0, 1], ignored=[(0, 16, 8, 32)]),
        shown(),
        shown((16, 2, 26, 20), classes=[1], ignored=[(0, 0, 8, 8), (24, 24, 32, 32)]),
    ]
    corner, stride = _grid_on(INPUT_HW, CPU)
    middle, half = (cells[..., :2] + corner) * stride, cells[..., 2:4].exp() * stride / 2
    sums, counts = list[float](), list[int]()
    for row, picture in enumerate(pictures):
        alone = truth(picture)
        chosen = assign(
            torch.cat([middle - half, middle + half], dim=2)[row, None], cells[row, None, :, 4],
            cells[row, None, :, 5:], (corner + 0.5) * stride, stride.squeeze(1), alone.boxes_px, alone.classes,
            alone.is_there,
        )  # fmt: skip
        counts.append(int(chosen.takes.sum()))
        sums.append(float(yolox_loss(cells[row, None], alone, INPUT_HW)) * max(counts[-1], 1))

    together = float(yolox_loss(cells, truth(*pictures), INPUT_HW))
    assert together == pytest.approx(sum(sums) / sum(counts), rel=1e-5)


def test_nothing_of_it_is_made_on_another_device_or_waits_for_a_value() -> None:
    """A meta tensor has no values: reading one, or mixing it with the CPU's, fails as it would cost time on a GPU."""
    meta = torch.device("meta")
    cells = torch.zeros(2, CELLS, 7, device=meta, requires_grad=True)
    objects = TrueObjects.of([shown((6, 6, 20, 20), classes=[1]), shown()], meta)

    loss = yolox_loss(cells, objects, INPUT_HW)
    loss.backward()

    assert loss.is_meta
    assert cells.grad is not None
