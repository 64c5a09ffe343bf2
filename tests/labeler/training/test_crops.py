"""What is cut out of a picture, to the pixel."""

from dataclasses import replace

import numpy as np
import pytest

from labeler.simulation.materials import Semantic
from labeler.training.crops import CropConfig, CropSampler
from labeler.training.pictures import Picture
from tests.labeler.training.made_pictures import picture

WHOLE = CropConfig(height_px=96, width_px=128, smallest_scale=1.0, largest_scale=1.0, around_objects=0.0, beyond_px=0)


def drawn(source: Picture, config: CropConfig, seed: int) -> Picture:
    return CropSampler([source], config).draw(np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(6))
def test_a_whole_picture_comes_out_as_it_is_or_mirrored(seed: int) -> None:
    source = picture((0, 10, 20, 50, 40))

    example = drawn(source, WHOLE, seed)

    assert example.boxes_px.tolist() in ([[10, 20, 50, 40]], [[128 - 50, 20, 128 - 10, 40]])
    x1, y1, x2, y2 = example.boxes_px[0].astype(int)
    assert example.semantic is not None
    inside = example.semantic[y1:y2, x1:x2]
    assert (inside == Semantic.VEHICLE).all()
    assert np.count_nonzero(example.semantic == Semantic.VEHICLE) == inside.size
    assert len(np.unique(example.image[y1:y2, x1:x2].reshape(-1, 3), axis=0)) == 1  # one colour, another than before


@pytest.mark.parametrize("seed", range(20))
def test_boxes_lie_around_the_objects_at_any_scale_and_place(seed: int) -> None:
    source = picture((2, 30, 20, 90, 60), size_px=(160, 120))
    config = CropConfig(height_px=64, width_px=96, smallest_scale=0.5, largest_scale=1.5, around_objects=1.0)

    example = drawn(source, config, seed)

    assert example.image.shape == (64, 96, 3)
    assert example.semantic is not None
    rows, columns = np.nonzero(example.semantic == Semantic.VEHICLE)
    seen = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1])
    box = np.concatenate([example.boxes_px, example.ignored_px])[0]
    assert np.abs(box - seen).max() <= 1.0


def test_a_box_of_which_little_is_left_is_ignored() -> None:
    source = picture((0, 60, 10, 120, 30))  # 60 wide; a window of half the width holds 4 to 60 of that
    config = replace(WHOLE, width_px=64, kept_share=0.4)

    examples = [drawn(source, config, seed) for seed in range(60)]

    asked = np.concatenate([example.boxes_px for example in examples])
    ignored = np.concatenate([example.ignored_px for example in examples])
    assert len(asked) > 5
    assert len(ignored) > 5
    assert (asked[:, 2] - asked[:, 0]).min() >= 0.4 * 60
    assert (ignored[:, 2] - ignored[:, 0]).max() < 0.4 * 60


def test_what_was_ignored_stays_ignored() -> None:
    source = replace(picture(), ignored_px=np.array([[10, 20, 50, 40]], np.float32))

    example = drawn(source, WHOLE, 0)

    assert len(example.boxes_px) == 0
    assert example.ignored_px.tolist() in ([[10, 20, 50, 40]], [[78, 20, 118, 40]])


def test_rare_classes_are_drawn_more_often_than_they_come() -> None:
    # 24 cars and one motorcycle: the root of the frequencies is 4.9 to 1, so one window in six is laid around it.
    cars = [picture((0, 40, 30, 80, 60)) for _ in range(24)]
    config = CropConfig(height_px=64, width_px=64, smallest_scale=1.0, largest_scale=1.0, around_objects=1.0)
    sampler = CropSampler([*cars, picture((3, 40, 30, 80, 60))], config)
    rng = np.random.default_rng(0)

    examples = [sampler.draw(rng) for _ in range(600)]

    shown = sum(3 in example.classes for example in examples)
    assert shown / 600 == pytest.approx(1 / 5.9, abs=0.05)


def test_the_same_generator_gives_the_same_example() -> None:
    source = picture((0, 10, 20, 50, 40), (1, 60, 50, 90, 80))
    config = CropConfig(height_px=64, width_px=96)

    first, second = drawn(source, config, 7), drawn(source, config, 7)

    assert first.image.tobytes() == second.image.tobytes()
    assert first.boxes_px.tolist() == second.boxes_px.tolist()


def test_a_picture_without_objects_and_smaller_than_the_window_is_filled_with_grey() -> None:
    example = drawn(picture(size_px=(64, 32)), replace(WHOLE, height_px=64, width_px=96), 1)

    assert example.image.shape == (64, 96, 3)
    assert len(np.unique(example.image[:, :, 0])) == 2  # the picture and the filling, each of one colour
