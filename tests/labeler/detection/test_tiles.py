from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.detection.tiles import Tile, join_tiles, plan_tiles
from labeler.detection.types import Detections

_GROUPS = np.array([0, 0, 1], np.int32)  # car, truck, person
_TWO = (Tile(0, 0, 120, 100), Tile(80, 0, 200, 100))  # both see 80..120


@pytest.mark.parametrize(
    ("image_hw", "input_hw", "tiles"),
    [
        # KITTI on a square: 1242 / (2 - 0.2) = 690
        ((375, 1242), (416, 416), ((0, 690), (552, 1242))),
        # the paper's camera, exactly twice as wide: 720 / 1.8 = 400
        ((360, 720), (416, 416), ((0, 400), (320, 720))),
        # four times as wide: two tiles would be 2.2 times as wide as high, so three: 256 / 2.6 = 98.5
        ((64, 256), (64, 64), ((0, 99), (78, 177), (157, 256))),
        # fits well enough
        ((1216, 1936), (416, 416), ((0, 1936),)),
        ((375, 1242), (288, 928), ((0, 1242),)),
    ],
)
def test_wide_images_are_cut(
    image_hw: tuple[int, int], input_hw: tuple[int, int], tiles: tuple[tuple[int, int], ...]
) -> None:
    planned = plan_tiles(image_hw, input_hw, aspect_limit=2, overlap=0.2)
    # 157 / 2 = 78.5 rounds to the even 78
    assert tuple((tile.x1, tile.x2) for tile in planned) == tiles
    assert {(tile.y1, tile.y2) for tile in planned} == {(0, image_hw[0])}


def test_high_images_are_cut_the_other_way() -> None:
    planned = plan_tiles((720, 360), (416, 416), aspect_limit=2, overlap=0.2)
    assert planned == (Tile(0, 0, 360, 400), Tile(0, 320, 360, 720))


@given(
    height=st.integers(1, 2000),
    width=st.integers(1, 2000),
    input_height=st.integers(1, 40),
    input_width=st.integers(1, 40),
    limit=st.floats(1.2, 4),
    overlap=st.floats(0, 0.6),
)
def test_tiles_cover_the_image_and_overlap(
    height: int, width: int, input_height: int, input_width: int, limit: float, overlap: float
) -> None:
    tiles = plan_tiles((height, width), (input_height, input_width), aspect_limit=limit, overlap=overlap)
    assert (tiles[0].x1, tiles[0].y1, tiles[-1].x2, tiles[-1].y2) == (0, 0, width, height)
    for before, after in pairwise(tiles):
        assert after.x1 <= before.x2
        assert after.y1 <= before.y2
        assert (before.x1, before.y1) <= (after.x1, after.y1)
    assert all(0 <= tile.x1 < tile.x2 <= width and 0 <= tile.y1 < tile.y2 <= height for tile in tiles)


def _boxes(*rows: tuple[float, float, float, float, float, int]) -> Detections:
    table = np.array(rows, np.float64).reshape(-1, 6)
    return Detections(table[:, :4].astype(np.float32), table[:, 4].astype(np.float32), table[:, 5].astype(np.int16))


def _join(*parts: Detections, tiles: tuple[Tile, ...] = _TWO) -> list[tuple[float, ...]]:
    joined = join_tiles(tiles, list(parts), _GROUPS, reach_px=4)
    table = zip(joined.xyxy_px.tolist(), joined.score.tolist(), joined.class_id.tolist(), strict=True)
    return sorted((*box, round(score, 3), class_id) for box, score, class_id in table)


@pytest.mark.parametrize(
    ("first", "second", "joined"),
    [
        # a long object is cut in both: its halves become one, with the better score and its class
        (_boxes((40, 20, 119, 60, 0.6, 0)), _boxes((82, 22, 180, 60, 0.8, 1)), [(40, 20, 180, 60, 0.8, 1)]),
        # cut in the first, whole in the second: the whole one, with the better score
        (_boxes((90, 20, 120, 60, 0.9, 0)), _boxes((91, 20, 150, 60, 0.7, 0)), [(91, 20, 150, 60, 0.9, 0)]),
        # whole in the first, cut in the second
        (_boxes((50, 20, 110, 60, 0.5, 0)), _boxes((80, 20, 111, 60, 0.9, 1)), [(50, 20, 110, 60, 0.9, 1)]),
        # halves at different heights are two objects
        (
            _boxes((40, 0, 120, 20, 0.6, 0)),
            _boxes((80, 60, 180, 90, 0.8, 0)),
            [(40, 0, 120, 20, 0.6, 0), (80, 60, 180, 90, 0.8, 0)],
        ),
        # a person in front of a car's other half is not that half
        (
            _boxes((40, 20, 120, 60, 0.6, 0)),
            _boxes((80, 20, 180, 60, 0.8, 2)),
            [(40, 20, 120, 60, 0.6, 0), (80, 20, 180, 60, 0.8, 2)],
        ),
        # whole in both: left to the suppression that follows
        (
            _boxes((90, 20, 110, 60, 0.6, 0)),
            _boxes((90, 20, 110, 60, 0.8, 0)),
            [(90, 20, 110, 60, 0.6, 0), (90, 20, 110, 60, 0.8, 0)],
        ),
        # a second, smaller piece of an object that the other tile saw whole goes
        (
            _boxes((90, 20, 120, 60, 0.9, 0), (100, 40, 120, 60, 0.3, 0)),
            _boxes((91, 20, 150, 60, 0.7, 0)),
            [(91, 20, 150, 60, 0.9, 0)],
        ),
        # a piece that the other tile does not know stays
        (_boxes((90, 20, 120, 60, 0.9, 0)), _boxes(), [(90, 20, 120, 60, 0.9, 0)]),
        # the image's own border is no seam
        (
            _boxes((0, 20, 30, 60, 0.9, 0)),
            _boxes((170, 20, 200, 60, 0.9, 0)),
            [(0, 20, 30, 60, 0.9, 0), (170, 20, 200, 60, 0.9, 0)],
        ),
        (_boxes(), _boxes(), []),
    ],
)
def test_object_on_a_seam_is_one_box(first: Detections, second: Detections, joined: list[tuple[float, ...]]) -> None:
    assert _join(first, second) == joined


def test_object_longer_than_a_tile_is_joined_over_both_seams() -> None:
    tiles = (Tile(0, 0, 100, 50), Tile(80, 0, 180, 50), Tile(160, 0, 260, 50))
    parts = _boxes((40, 10, 100, 40, 0.5, 1)), _boxes((80, 10, 180, 40, 0.4, 1)), _boxes((160, 10, 230, 40, 0.7, 1))
    assert _join(*parts, tiles=tiles) == [(40, 10, 230, 40, 0.7, 1)]


def test_seams_of_tiles_one_below_the_other_are_mended_too() -> None:
    tiles = (Tile(0, 0, 100, 120), Tile(0, 80, 100, 200))
    parts = _boxes((20, 40, 60, 120, 0.6, 0)), _boxes((20, 80, 60, 180, 0.8, 0))
    assert _join(*parts, tiles=tiles) == [(20, 40, 60, 180, 0.8, 0)]
