"""Line colours come out as meant."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.scene.palette import IDENTITY_PALETTE
from app.scene.tone import line_colors


def on_screen(sent: NDArray[np.uint8]) -> NDArray[np.float64]:
    """sRGB 0..255 of lines for the values sent: linear light, the film curve of three.js, sRGB."""
    to_film = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
    from_film = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
    film = to_film @ (sent / 255 / 0.6)
    curve = (film * (film + 0.0245786) - 0.000090537) / (film * (0.983729 * film + 0.4329510) + 0.238081)
    light = np.clip(from_film @ curve, 0.0, 1.0)
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055) * 255


@pytest.mark.parametrize(
    ("sent", "seen"),
    [((255, 50, 15), (240, 146, 81)), ((255, 138, 163), (228, 203, 209))],  # pixels of a real picture
)
def test_the_model_of_the_screen_is_right(sent: tuple[int, int, int], seen: tuple[int, int, int]) -> None:
    assert on_screen(np.array(sent, np.uint8)).tolist() == pytest.approx(seen, abs=1.5)


@given(st.integers(120, 255), st.floats(0.7, 1.0), st.floats(0.7, 1.0), st.permutations([0, 1, 2]))
def test_a_color_comes_out_as_it_was_or_darker_by_one_factor(
    largest: int, share_a: float, share_b: float, order: list[int]
) -> None:
    """Of colours that are not too saturated: those lie beyond the film curve's reach and come out a little paler."""
    wanted = np.array([largest, largest * share_a, largest * share_b], np.uint8)[order]
    seen = on_screen(line_colors(wanted[None])[0])
    factor = seen.max() / largest
    assert 0.87 < factor < 1.01
    assert seen.tolist() == pytest.approx((wanted * factor).tolist(), abs=3)


def test_identity_colors_come_out_closer_than_if_sent_as_linear_light() -> None:
    colors = np.array(IDENTITY_PALETTE, np.uint8)
    linear = np.round(((colors / 255 + 0.055) / 1.055) ** 2.4 * 255).astype(np.uint8)
    ours = np.mean([np.abs(on_screen(sent) - color) for color, sent in zip(colors, line_colors(colors), strict=True)])
    plain = np.mean([np.abs(on_screen(sent) - color) for color, sent in zip(colors, linear, strict=True)])
    assert ours < 0.65 * plain


def test_one_color_does_not_change_another() -> None:
    colors = np.array([[255, 255, 255], [255, 122, 69]], np.uint8)
    assert line_colors(colors)[1].tolist() == line_colors(colors[1:])[0].tolist()
    assert line_colors(colors[:0]).shape == (0, 3)
