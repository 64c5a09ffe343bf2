"""SimOTA on cells that can be counted on one's fingers."""

import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.assignment import assign, iou


def test_iou_of_boxes_that_overlap_touch_and_contain() -> None:
    a = torch.tensor([[0.0, 0, 10, 10]])
    b = torch.tensor([[5.0, 0, 15, 10], [10, 0, 20, 10], [2, 2, 7, 6], [0, 0, 10, 10]])

    # 50 of 150; nothing; 20 of 100; all
    assert iou(a, b).tolist() == pytest.approx([1 / 3, 0, 0.2, 1])


def row_of_cells(count: int) -> tuple[torch.Tensor, torch.Tensor]:
    """A row of cells of stride 8: centres at 4, 12, 20, ... and y = 4."""
    x = torch.arange(count) * 8.0 + 4
    return torch.stack([x, torch.full_like(x, 4.0)], dim=1), torch.full((count,), 8.0)


def test_an_object_takes_as_many_cells_as_its_overlaps_add_up_to_the_best_first() -> None:
    centers, strides = row_of_cells(6)
    truth = torch.tensor([[12.0, 0, 28, 8]])  # middle 20: the cells at 12, 20 and 28 lie within 1.5 strides
    boxes = torch.tensor(
        [
            [12.0, 0, 28, 8],  # a perfect box, but of a cell that is too far away to be asked
            [12.0, 0, 28, 8],  # IoU 1
            [12.0, 0, 28, 8],  # IoU 1
            [20.0, 0, 28, 8],  # IoU .5
            [40.0, 0, 48, 8],
            [40.0, 0, 48, 8],
        ]
    )
    logits = torch.zeros(6), torch.zeros(6, 2)

    found = assign(boxes, *logits, centers, strides, truth, torch.tensor([0]))

    # Overlaps add up to 2.5: two cells, the two with IoU 1.
    assert found.cells.tolist() == [1, 2]
    assert found.objects.tolist() == [0, 0]
    assert found.overlaps.tolist() == pytest.approx([1.0, 1.0])


def test_of_equal_boxes_the_cell_that_says_the_class_is_taken() -> None:
    centers, strides = row_of_cells(4)
    truth = torch.tensor([[8.0, 0, 16, 8]])
    boxes = torch.tensor([[8.0, 0, 12, 8]]).repeat(4, 1)  # IoU .5 each: 1.5 over the three near cells, so one is taken
    classes = torch.tensor([[5.0, -5], [-5, 5], [5, -5], [5, -5]])  # logits; only the second says class 1

    found = assign(boxes, torch.zeros(4), classes, centers, strides, truth, torch.tensor([1]))

    assert found.cells.tolist() == [1]


def test_a_cell_that_two_objects_want_goes_to_the_one_it_fits() -> None:
    centers, strides = row_of_cells(3)
    truths = torch.tensor([[8.0, 0, 16, 8], [10.0, 0, 18, 8]])
    boxes = torch.tensor([[100.0, 0, 101, 8], [10.0, 0, 18, 8], [100.0, 0, 101, 8]])

    found = assign(boxes, torch.zeros(3), torch.zeros(3, 1), centers, strides, truths, torch.tensor([0, 0]))

    assert dict(zip(found.cells.tolist(), found.objects.tolist(), strict=True))[1] == 1
    assert len(set(found.cells.tolist())) == len(found.cells)


def test_an_object_between_no_cells_is_learned_by_none() -> None:
    centers, strides = row_of_cells(2)
    truth = torch.tensor([[200.0, 0, 210, 8]])

    found = assign(torch.zeros(2, 4), torch.zeros(2), torch.zeros(2, 1), centers, strides, truth, torch.tensor([0]))

    assert len(found.cells) == 0
