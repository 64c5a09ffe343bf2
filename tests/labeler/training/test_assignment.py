"""SimOTA on cells that can be counted on one's fingers."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch
from torch.nn.functional import binary_cross_entropy, one_hot

from labeler.detection.decode import anchor_grid
from labeler.training.assignment import Assignment, assign, iou


def test_iou_of_boxes_that_overlap_touch_and_contain() -> None:
    a = torch.tensor([[0.0, 0, 10, 10]])
    b = torch.tensor([[5.0, 0, 15, 10], [10, 0, 20, 10], [2, 2, 7, 6], [0, 0, 10, 10]])

    # 50 of 150; nothing; 20 of 100; all
    assert iou(a, b).tolist() == pytest.approx([1 / 3, 0, 0.2, 1])


Found = dict[int, tuple[int, float]]
"""The object that each cell learns, and the IoU with it."""


def found_in(
    boxes: torch.Tensor, objectness: torch.Tensor, classes: torch.Tensor, centers: torch.Tensor,
    strides: torch.Tensor, true_boxes: torch.Tensor, true_classes: torch.Tensor,
) -> Found:  # fmt: skip
    """What a batch of one image says."""
    chosen = assign(
        boxes[None], objectness[None], classes[None], centers, strides, true_boxes[None], true_classes[None],
        torch.ones(1, len(true_boxes), dtype=torch.bool),
    )  # fmt: skip
    return found_by(chosen)[0]


def found_by(chosen: Assignment) -> list[Found]:
    """Image by image."""
    images: list[Found] = [{} for _ in chosen.cells]
    for image, object_, place in chosen.takes.nonzero().tolist():
        cell = int(chosen.cells[image, object_, place])
        assert cell not in images[image], "a cell learns one object"
        images[image][cell] = (object_, float(chosen.overlaps[image, object_, place]))
    return images


def simply(
    boxes: torch.Tensor, objectness: torch.Tensor, classes: torch.Tensor, centers: torch.Tensor,
    strides: torch.Tensor, true_boxes: torch.Tensor, true_classes: torch.Tensor,
) -> dict[int, int]:  # fmt: skip
    """SimOTA as one reads it: cell by cell of one image."""
    cost, wants = dict[tuple[int, int], float](), dict[int, list[int]]()
    for object_, box in enumerate(true_boxes):
        middle = (box[:2] + box[2:]) / 2
        near = [c for c in range(len(boxes)) if bool(((centers[c] - middle).abs() < 1.5 * strides[c]).all())]
        overlaps = {cell: float(iou(box, boxes[cell])) for cell in near}
        for cell in near:
            score = (classes[cell].sigmoid() * objectness[cell].sigmoid()).sqrt()
            wanted = one_hot(true_classes[object_], classes.shape[1]).float()
            named = float(binary_cross_entropy(score, wanted, reduction="sum"))
            cost[object_, cell] = named - 3 * math.log(max(overlaps[cell], 1e-8))
        count = max(int(sum(sorted(overlaps.values(), reverse=True)[:10])), 1)
        for cell in sorted(near, key=lambda cell: (cost[object_, cell], cell))[:count]:
            wants.setdefault(cell, []).append(object_)
    chosen = dict[int, int]()
    for cell, objects in wants.items():
        near_to = [object_ for object_ in range(len(true_boxes)) if (object_, cell) in cost]
        chosen[cell] = objects[0] if len(objects) == 1 else min(near_to, key=lambda object_: cost[object_, cell])
    return chosen


@given(seed=st.integers(0, 10_000), counts=st.lists(st.integers(0, 9), min_size=1, max_size=4))
@settings(max_examples=30, deadline=None)
def test_a_batch_is_assigned_as_each_image_alone(seed: int, counts: list[int]) -> None:
    """Crowded: up to nine objects, and boxes that overlap many of them, on 64 x 64 pixels."""
    rng = torch.Generator().manual_seed(seed)
    grid = anchor_grid((64, 64))
    strides = torch.from_numpy(grid.stride_px[:, 0].copy())
    centers = (torch.from_numpy(grid.cell.copy()) + 0.5) * strides[:, None]

    def boxes_around(middles: torch.Tensor) -> torch.Tensor:
        half = 3 + 13 * torch.rand(middles.shape, generator=rng)
        return torch.cat([middles - half, middles + half], dim=-1)

    images, cells, most = len(counts), len(centers), max(1, *counts)
    boxes = boxes_around(centers + 8 * torch.randn(images, cells, 2, generator=rng))
    objectness, classes = torch.randn(images, cells, generator=rng), torch.randn(images, cells, 3, generator=rng)
    true_boxes = boxes_around(64 * torch.rand(images, most, 2, generator=rng))
    true_classes = torch.randint(3, (images, most), generator=rng)
    is_there = torch.arange(most) < torch.tensor(counts)[:, None]

    together = found_by(assign(boxes, objectness, classes, centers, strides, true_boxes, true_classes, is_there))

    for n, count in enumerate(counts):
        alone = simply(
            boxes[n], objectness[n], classes[n], centers, strides, true_boxes[n, :count], true_classes[n, :count]
        )
        assert {cell: object_ for cell, (object_, _) in together[n].items()} == alone
        for cell, (object_, overlap) in together[n].items():
            assert overlap == pytest.approx(float(iou(true_boxes[n, object_], boxes[n, cell])), abs=1e-5)


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

    found = found_in(boxes, *logits, centers, strides, truth, torch.tensor([0]))

    # Overlaps add up to 2.5: two cells, the two with IoU 1.
    assert found == {1: (0, pytest.approx(1.0)), 2: (0, pytest.approx(1.0))}


def test_of_equal_boxes_the_cell_that_says_the_class_is_taken() -> None:
    centers, strides = row_of_cells(4)
    truth = torch.tensor([[8.0, 0, 16, 8]])
    boxes = torch.tensor([[8.0, 0, 12, 8]]).repeat(4, 1)  # IoU .5 each: 1.5 over the three near cells, so one is taken
    classes = torch.tensor([[5.0, -5], [-5, 5], [5, -5], [5, -5]])  # logits; only the second says class 1

    found = found_in(boxes, torch.zeros(4), classes, centers, strides, truth, torch.tensor([1]))

    assert list(found) == [1]


def test_a_cell_that_two_objects_want_goes_to_the_one_it_fits() -> None:
    centers, strides = row_of_cells(3)
    truths = torch.tensor([[8.0, 0, 16, 8], [10.0, 0, 18, 8]])
    boxes = torch.tensor([[100.0, 0, 101, 8], [10.0, 0, 18, 8], [100.0, 0, 101, 8]])

    found = found_in(boxes, torch.zeros(3), torch.zeros(3, 1), centers, strides, truths, torch.tensor([0, 0]))

    assert found[1][0] == 1


def test_an_object_between_no_cells_is_learned_by_none() -> None:
    centers, strides = row_of_cells(2)
    truth = torch.tensor([[200.0, 0, 210, 8]])

    found = found_in(torch.zeros(2, 4), torch.zeros(2), torch.zeros(2, 1), centers, strides, truth, torch.tensor([0]))

    assert not found
