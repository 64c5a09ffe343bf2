"""Pictures drawn in metres, and noise that repeats."""

import numpy as np
import pytest

from labeler.simulation.textures import LAYER_PX, Ink, Picture, TextureSet, rgb_of, tileable_noise

WHITE, RED = Ink((255, 255, 255), paint=1.0), Ink((255, 0, 0), metal=1.0, rough=0.0, glass=1.0)


def layer_of(picture: Picture) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    textures = TextureSet()
    assert textures.add(picture) == 0
    assert len(textures) == 1
    assert textures.surface[0].shape == (LAYER_PX, LAYER_PX, 3)
    return textures.color[0]


def test_a_rectangle_covers_its_metres() -> None:
    picture = Picture((-2.0, 2.0), (0.0, 1.0), WHITE)
    picture.rectangle((0.0, 2.0), (0.0, 0.5), RED)  # the lower right quarter

    layer = layer_of(picture)

    half = LAYER_PX // 2
    assert layer[half + 3, half + 3].tolist() == [255, 0, 0, 0]
    assert layer[-3, -3].tolist() == [255, 0, 0, 0]
    for untouched in (layer[half - 3, half + 3], layer[half + 3, half - 3], layer[3, 3]):
        assert untouched.tolist() == [255, 255, 255, 255]


def test_a_range_that_runs_backwards_mirrors_shapes() -> None:
    picture = Picture((2.0, -2.0), (0.0, 1.0), WHITE)
    picture.rectangle((1.0, 2.0), (0.0, 1.0), RED)

    layer = layer_of(picture)

    assert layer[10, 10].tolist() == [255, 0, 0, 0]
    assert layer[10, -10].tolist() == [255, 255, 255, 255]


def test_ink_says_what_the_surface_is() -> None:
    picture = Picture((0.0, 1.0), (0.0, 1.0), RED)
    textures = TextureSet()
    textures.add(picture)

    assert textures.surface[0][7, 7].tolist() == [255, 0, 255]  # metal, roughness, glass


@pytest.mark.parametrize("height_m", [0.1, 0.3])
def test_letters_are_as_high_as_said(height_m: float) -> None:
    picture = Picture((0.0, 2.0), (0.0, 1.0), WHITE)
    picture.text("HI", (0.2, 0.4), height_m, RED)

    rows = np.nonzero((layer_of(picture)[..., 1] < 128).any(axis=1))[0]

    assert (rows.max() + 1 - rows.min()) / LAYER_PX == pytest.approx(height_m, rel=0.15)
    assert 1 - (rows.max() + 1) / LAYER_PX == pytest.approx(0.4, abs=0.02)


def test_words_that_do_not_fit_are_cut_at_the_edge() -> None:
    picture = Picture((0.0, 1.0), (0.0, 1.0), WHITE)
    picture.text("LOGISTICS", (0.5, 0.5), 0.3, RED)

    layer = layer_of(picture)

    assert (layer[:, -60:, 1] < 128).any()
    assert (layer[:, :200, 1] == 255).all()


def test_noise_repeats_without_a_seam_and_fills_its_range() -> None:
    noise = tileable_noise(np.random.default_rng(0), 128, (4, 16))

    inside = np.abs(np.diff(noise, axis=1)).max()
    across = np.abs(noise[:, 0] - noise[:, -1]).max()
    assert noise.shape == (128, 128)
    assert 0.0 <= noise.min() < 0.3
    assert 0.7 < noise.max() <= 1.0
    assert across <= 1.5 * inside


def test_three_numbers_are_a_colour() -> None:
    assert rgb_of(np.array([1, 2, 3])) == (1.0, 2.0, 3.0)
