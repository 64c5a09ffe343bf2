import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from labeler.detection.letterbox import Letterbox, fit_letterbox

_SIDE = st.integers(1, 3000)
_FIXED_SIDE = st.none() | st.integers(1, 40).map(lambda count: 32 * count)


@pytest.mark.parametrize(
    ("image_hw", "fixed_hw", "long_side_px", "input_hw", "placed_hw"),
    [
        # free shape, image smaller than the limit: its own pixels, padded up to 32
        ((375, 1242), (None, None), 1280, (384, 1248), (375, 1242)),
        # free shape, image larger: 1216 * 960 / 1936 = 602.98
        ((1216, 1936), (None, None), 960, (608, 960), (603, 960)),
        # fixed shape: 416 / 1242 = 0.335, height 125.6
        ((375, 1242), (416, 416), 960, (416, 416), (126, 416)),
        # fixed shape larger than the image: enlarged
        ((100, 200), (416, 416), 960, (416, 416), (208, 416)),
        # only the height is fixed: the width follows; 288 / 375 = 0.768
        ((375, 1242), (288, None), 960, (288, 960), (288, 954)),
        # one pixel stays one pixel
        ((1, 1), (None, None), 960, (32, 32), (1, 1)),
        # a line: never less than a pixel high
        ((1, 5000), (None, None), 960, (32, 960), (1, 960)),
    ],
)
def test_input_follows_the_image(
    image_hw: tuple[int, int],
    fixed_hw: tuple[int | None, int | None],
    long_side_px: int,
    input_hw: tuple[int, int],
    placed_hw: tuple[int, int],
) -> None:
    box = fit_letterbox(image_hw, height=fixed_hw[0], width=fixed_hw[1], long_side_px=long_side_px)
    assert (box.input_hw, box.placed_hw) == (input_hw, placed_hw)


def test_image_lies_upper_left_in_bgr_planes_and_the_rest_is_114() -> None:
    image = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    planes = np.full((3, 32, 32), -1, np.float32)
    Letterbox((2, 3), (32, 32), (2, 3)).write(image, planes)
    assert planes[0, :2, :3].tolist() == [[0, 3, 6], [9, 12, 15]]  # blue, values as they are
    assert planes[2, :2, :3].tolist() == [[2, 5, 8], [11, 14, 17]]  # red
    planes[:, :2, :3] = 114
    assert (planes == 114).all()


def test_a_smaller_place_means_a_resized_image() -> None:
    image = np.full((64, 128, 3), 200, np.uint8)
    planes = np.zeros((3, 32, 64), np.float32)
    Letterbox((64, 128), (32, 64), (32, 64)).write(image, planes)
    assert (planes == 200).all()


@given(
    height=_SIDE,
    width=_SIDE,
    fixed_height=_FIXED_SIDE,
    fixed_width=_FIXED_SIDE,
    share=st.tuples(*[st.floats(0, 1)] * 4),
)
def test_boxes_survive_the_round_trip(
    height: int, width: int, fixed_height: int | None, fixed_width: int | None, share: tuple[float, ...]
) -> None:
    box = fit_letterbox((height, width), height=fixed_height, width=fixed_width, long_side_px=960)
    boxes: NDArray[np.float32] = (np.array([share]) * [width, height, width, height]).astype(np.float32)
    there = box.to_input(boxes)
    assert (there[:, 0::2] <= box.placed_hw[1] * (1 + 1e-5)).all()
    assert (there[:, 1::2] <= box.placed_hw[0] * (1 + 1e-5)).all()
    np.testing.assert_allclose(box.to_image(there), boxes, rtol=1e-4, atol=1e-4)


@given(height=_SIDE, width=_SIDE, fixed_height=_FIXED_SIDE, fixed_width=_FIXED_SIDE)
def test_image_fits_its_input(height: int, width: int, fixed_height: int | None, fixed_width: int | None) -> None:
    box = fit_letterbox((height, width), height=fixed_height, width=fixed_width, long_side_px=960)
    assert box.input_hw[0] % 32 == 0
    assert box.input_hw[1] % 32 == 0
    assert 1 <= box.placed_hw[0] <= box.input_hw[0]
    assert 1 <= box.placed_hw[1] <= box.input_hw[1]
    assert box.input_hw[0] == (fixed_height or box.input_hw[0])
    assert box.input_hw[1] == (fixed_width or box.input_hw[1])
    if fixed_height is None or fixed_width is None:
        assert box.placed_hw[0] <= height
        assert box.placed_hw[1] <= width
