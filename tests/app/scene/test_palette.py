"""Colours."""

import numpy as np
import pytest

from app.scene.palette import as_linear, faded, identity_color, point_colors, scene_palette
from app.scene.types import Theme


@pytest.mark.parametrize(
    ("identity_id", "color"),
    [
        (0, (221, 60, 60)),  # hue 0: lightness .55 +- .7 x .45 = .865 and .235
        (1, (60, 221, 107)),  # hue 137.508: green, and blue (137.508 - 120) / 60 of the way up
        (3, (221, 201, 60)),  # hue 52.524
    ],
)
def test_identity_colors_follow_the_golden_angle(identity_id: int, color: tuple[int, int, int]) -> None:
    assert identity_color(identity_id) == color


def test_colors_as_linear_light() -> None:
    # 188 / 255 = .737, the sRGB value of half the light; 10 lies on the straight part of the curve: 10 / 12.92 = .77
    assert as_linear(np.array([[0, 10, 188], [255, 255, 255]], np.uint8)).tolist() == [[0, 1, 128], [255, 255, 255]]


def test_a_faded_color_is_half_background() -> None:
    assert faded((200, 100, 0), (0, 100, 255)) == (100, 100, 127)


@pytest.mark.parametrize("theme", list(Theme))
def test_points_run_from_low_to_high(theme: Theme) -> None:
    palette = scene_palette(theme)
    height_m = np.array([-0.2, 0.0, 4.0, 9.0], np.float32)
    colors = point_colors(height_m, np.zeros(4, np.float32), palette)
    assert colors[:2].tolist() == [list(palette.point_low)] * 2
    assert colors[2:].tolist() == [list(palette.point_high)] * 2


@pytest.mark.parametrize("theme", list(Theme))
def test_reflecting_points_stand_out_on_the_ground(theme: Theme) -> None:
    palette = scene_palette(theme)
    dull, bright = point_colors(np.zeros(2, np.float32), np.array([0.0, 1.0], np.float32), palette).astype(int).sum(1)
    toward_high = sum(palette.point_high) - sum(palette.point_low)
    assert (bright - dull) / toward_high == pytest.approx(0.55, abs=0.02)
