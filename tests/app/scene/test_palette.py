"""Colours."""

import re
from pathlib import Path

import numpy as np
import pytest

from app.scene.palette import IDENTITY_PALETTE, faded, identity_color, point_colors, scene_palette
from app.scene.types import Theme

PAGE_PALETTE = Path(__file__).parents[3] / "frontend" / "src" / "review" / "cameras" / "palette.ts"


@pytest.mark.parametrize(
    ("identity_id", "index"),
    [(0, 0), (1, 5), (2, 10), (3, 3), (12, 1), (13, 6), (143, (143 * 5 + 11) % 12)],  # each dozen is shifted by one
)
def test_identity_colors_step_through_the_palette(identity_id: int, index: int) -> None:
    assert identity_color(identity_id) == IDENTITY_PALETTE[index]


def test_the_page_has_the_same_colors() -> None:
    source = PAGE_PALETTE.read_text(encoding="utf-8")
    page = [tuple(bytes.fromhex(color)) for color in re.findall(r'^  "#([0-9a-f]{6})",', source, re.MULTILINE)]
    assert page == list(IDENTITY_PALETTE)
    assert "(identityId * 5 + dozen) % PALETTE.length" in source


def test_colors_are_darker_on_light() -> None:
    assert identity_color(1, Theme.LIGHT) == (166, 111, 141)  # .72 x (231, 154, 196)


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
