"""Images into a network's input, and its output into scores. The network looks at one colour; see tests.made_models."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.segmentation import Segmenter, open_segmenter
from labeler.segmentation.model import SegmentationLayout
from labeler.segmentation.network import Placement, place
from tests.made_models import write_segmentation_model

BLUE, RED = 0, 2


def one_colour(height: int, width: int, colour: int = RED, value: int = 255) -> NDArray[np.uint8]:
    """A BGR image."""
    image = np.zeros((height, width, 3), np.uint8)
    image[..., colour] = value
    return image


def opened(path: Path, **how: Any) -> Segmenter:
    return open_segmenter(write_segmentation_model(path / "made.onnx", **how))


def test_cells_get_the_scores_of_their_pixels(tmp_path: Path) -> None:
    image = one_colour(64, 96)
    image[:, 48:] = 0  # the right half is black
    image[:8, :8] = 0
    image[:8, :4, RED] = 102  # half of the first cell: a mean of 51, a fifth of 255
    found = opened(tmp_path).segment(image)
    assert found.scores.shape == (2, 8, 12)
    assert (found.stride_px, found.size_px) == (8.0, (96, 64))
    assert found.scores[1, 0, :2].tolist() == [51, 255]
    assert found.scores[0, 0, :2].tolist() == [204, 0]
    assert found.scores[1, 1:, :6].min() == 255
    assert found.scores[1, :, 6:].max() == 0


@pytest.mark.parametrize(
    ("metadata", "channel", "colour"),
    [
        ({}, 0, RED),  # the first channel of RGB
        ({"colour_order": "rgb"}, 2, BLUE),
        ({"colour_order": "BGR"}, 0, BLUE),
    ],
)
def test_channels_come_in_the_order_that_the_file_names(
    tmp_path: Path, metadata: dict[str, str], channel: int, colour: int
) -> None:
    segmenter = opened(tmp_path, channel=channel, metadata=metadata)
    assert segmenter.segment(one_colour(32, 32, colour)).scores[1].min() == 255
    assert segmenter.segment(one_colour(32, 32, 2 - colour)).scores[1].max() == 0


def test_mean_and_deviation_are_taken_from_the_file(tmp_path: Path) -> None:
    segmenter = opened(tmp_path, metadata={"mean": json.dumps([55, 0, 0]), "std": json.dumps([2, 1, 1])})
    assert segmenter.segment(one_colour(32, 32, value=157)).scores[1].max() == 51  # (157 - 55) / 2


@pytest.mark.parametrize("logits", [False, True])
def test_logits_are_told_from_probabilities(tmp_path: Path, logits: bool) -> None:
    found = opened(tmp_path, logits=logits).segment(one_colour(32, 32, value=51))
    assert found.scores[:, 0, 0].tolist() == [204, 51]


@pytest.mark.parametrize(
    ("image_hw", "grid", "stride_px"),
    [
        ((360, 720), (45, 90), 8.0),  # 360 is no multiple of 32: the input is 384x736, the grid is the image's
        ((361, 721), (46, 91), 8.0),  # a last cell for the last pixel
        ((1, 1), (1, 1), 8.0),
        ((540, 1920), (34, 120), 16.0),  # shrunk to 270x960: a cell is 16 px of the recorded image
        ((376, 1241), (37, 120), 8 * 1241 / 960),  # to 290.9: what lies in 291 rows needs 37 cells
    ],
)
def test_the_grid_covers_the_image_and_no_more(
    tmp_path: Path, image_hw: tuple[int, int], grid: tuple[int, int], stride_px: float
) -> None:
    found = opened(tmp_path).segment(one_colour(*image_hw))
    assert found.scores.shape == (2, *grid)
    assert found.stride_px == pytest.approx(stride_px)
    assert found.scores[1].min() == 255  # beyond the edge the image goes on as it ends
    corner = np.array([[image_hw[1] - 0.5, image_hw[0] - 0.5]])
    np.testing.assert_allclose(found.at(corner), [[0, 1]])


def test_a_fixed_input_is_filled(tmp_path: Path) -> None:
    segmenter = opened(tmp_path, batch=2, hw=(64, 128))
    found = segmenter.segment(one_colour(32, 32))  # enlarged to 64x64
    assert found.scores.shape == (2, 8, 8)
    assert found.stride_px == 4.0
    assert found.scores[1].min() == 255


def test_an_answer_for_each_pixel_is_averaged_to_cells_of_four(tmp_path: Path) -> None:
    image = one_colour(32, 32, value=0)
    image[0, :2, RED] = 204  # two of the sixteen pixels of a cell
    found = opened(tmp_path, stride=1).segment(image)
    assert found.scores.shape == (2, 8, 8)
    assert found.stride_px == 4.0
    assert found.scores[1, 0, :2].tolist() == [34, 0]  # 204 / 8 = 25.5, half-way between two levels: to the even one


@pytest.mark.parametrize(
    "image",
    [np.zeros((4, 4), np.uint8), np.zeros((4, 4, 4), np.uint8), np.zeros((0, 4, 3), np.uint8), np.zeros((4, 4, 3))],
)
def test_what_is_no_image_is_refused(tmp_path: Path, image: NDArray[np.uint8]) -> None:
    with pytest.raises(ValueError, match=r"image must be \(H, W, 3\) uint8"):
        opened(tmp_path).segment(image)


@pytest.mark.parametrize(
    ("image_hw", "fixed_hw", "placement"),
    [
        ((360, 720), (None, None), Placement((384, 736), (360, 720), 1.0)),
        ((375, 1242), (None, None), Placement((320, 960), (290, 960), 960 / 1242)),
        ((100, 100), (64, 128), Placement((64, 128), (64, 64), 0.64)),
        ((100, 200), (None, 100), Placement((64, 100), (50, 100), 0.5)),  # one side fixed, the other follows
    ],
)
def test_places(image_hw: tuple[int, int], fixed_hw: tuple[int | None, int | None], placement: Placement) -> None:
    layout = SegmentationLayout(
        "images", None, *fixed_hw, ("a",), 8, False, True, (0, 0, 0), (1, 1, 1), multiple_px=32, long_side_px=960
    )
    assert place(image_hw, layout) == placement
