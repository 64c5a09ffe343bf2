"""Training learns, stops, and goes on as if it had not stopped."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.crops import CropConfig
from labeler.training.detector import DetectorTask
from labeler.training.errors import TrainingError
from labeler.training.loop import CHECKPOINT, TrainingConfig, train
from labeler.training.segmenter import SegmentationTask
from labeler.training.yolox_network import YoloxShape
from tests.labeler.training.made_pictures import picture

CROPS = CropConfig(height_px=64, width_px=96, smallest_scale=0.9, largest_scale=1.1, around_objects=1.0)
WIDE = replace(CROPS, height_px=96, width_px=128, around_objects=0.0)
TINY = YoloxShape(depth=0.33, width=0.125, depthwise=True)
PICTURES = (picture((0, 20, 20, 60, 50), (1, 70, 40, 110, 80)), picture((2, 30, 30, 90, 70)))
CONFIG = TrainingConfig(seed=3, steps=8, batch_size=4, workers=2, warm_up_steps=2, checkpoint_every=100)


def detector_task(drives: Sequence[str] = ("a", "b")) -> DetectorTask:
    return DetectorTask(PICTURES, drives, (CROPS, WIDE), TINY)


def quiet(_: str) -> None:
    pass


def numbers_of(network: torch.nn.Module) -> torch.Tensor:
    return torch.cat([value.reshape(-1).float() for value in network.state_dict().values()])


def test_a_run_that_was_stopped_ends_with_the_same_weights(tmp_path: Path) -> None:
    whole = train(detector_task(), CONFIG, tmp_path / "whole", report=quiet)
    train(detector_task(), CONFIG, tmp_path / "parts", report=quiet, stop_after=3)
    lines: list[str] = []
    resumed = train(detector_task(), CONFIG, tmp_path / "parts", report=lines.append)

    assert lines[0] == "going on from step 3"
    assert torch.equal(numbers_of(whole.network), numbers_of(resumed.network))
    assert [path.name for path in (tmp_path / "parts").iterdir()] == [CHECKPOINT]
    assert resumed.drives_since == ((0, ("a", "b")),)


def test_another_seed_leads_elsewhere(tmp_path: Path) -> None:
    config = replace(CONFIG, steps=2)
    one = train(detector_task(), config, tmp_path / "one", report=quiet)
    other = train(detector_task(), replace(config, seed=4), tmp_path / "other", report=quiet)

    assert not torch.equal(numbers_of(one.network), numbers_of(other.network))


def test_a_finished_run_may_be_made_longer_with_more_drives(tmp_path: Path) -> None:
    train(detector_task(("a",)), replace(CONFIG, steps=2), tmp_path, report=quiet)
    trained = train(detector_task(("a", "b")), replace(CONFIG, steps=3), tmp_path, report=quiet)

    assert trained.drives_since == ((0, ("a",)), (2, ("a", "b")))


def test_a_checkpoint_of_other_settings_or_a_damaged_one_is_refused(tmp_path: Path) -> None:
    train(detector_task(), replace(CONFIG, steps=1), tmp_path, report=quiet)

    with pytest.raises(TrainingError, match=r"other settings \(learning_rate 0.002, now 0.1\)"):
        train(detector_task(), replace(CONFIG, learning_rate=0.1), tmp_path, report=quiet)

    content = (tmp_path / CHECKPOINT).read_bytes()
    (tmp_path / CHECKPOINT).write_bytes(content[: len(content) // 2])
    with pytest.raises(TrainingError, match="Delete it to begin again"):
        train(detector_task(), CONFIG, tmp_path, report=quiet)


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        (0, 0.5),  # the first of two steps of warm-up
        (1, 1.0),
        (5, 1.0),
        (6, 1.0),  # the fall over the last 4 of 10 steps begins here
        (8, 0.5),  # half of a cosine
        (9, 0.1464),  # (1 + cos(3/4 pi)) / 2
    ],
)
def test_the_rate_warms_up_stays_and_falls(step: int, expected: float) -> None:
    config = replace(CONFIG, steps=10, learning_rate=1.0, warm_up_steps=2, fall_share=0.4)

    assert config.rate_at(step) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("change", [{"steps": 0}, {"workers": 0}, {"batch_size": 3}, {"batch_size": 0}])
def test_settings_that_make_no_sense_are_refused(change: dict[str, int]) -> None:
    with pytest.raises(TrainingError, match="share evenly"):
        replace(CONFIG, **change)


def test_a_loss_that_is_not_a_number_ends_it(tmp_path: Path) -> None:
    class Broken(DetectorTask):
        def loss(self, network: torch.nn.Module, rng: np.random.Generator, count: int) -> torch.Tensor:
            return super().loss(network, rng, count) * float("nan")

    with pytest.raises(TrainingError, match="The loss of step 0 is nan"):
        train(Broken(PICTURES, ("a",), (CROPS,), TINY), CONFIG, tmp_path, report=quiet)
    assert not (tmp_path / CHECKPOINT).exists()


def test_a_tiny_detector_learns_two_pictures(tmp_path: Path) -> None:
    config = replace(CONFIG, steps=60, batch_size=4, learning_rate=5e-3, ema_decay=0.9)
    task = detector_task()
    network = train(task, config, tmp_path, report=quiet).network

    untrained = task.new_network().eval()
    losses = [float(task.loss(each, np.random.default_rng(99), 8).detach()) for each in (untrained, network)]
    assert losses[1] < 0.85 * losses[0]


def test_a_segmentation_learns_two_pictures_by_heart(tmp_path: Path) -> None:
    task = SegmentationTask(PICTURES, ("a",), replace(CROPS, replicate_edge=True))
    config = replace(CONFIG, steps=60, learning_rate=5e-3, ema_decay=0.9)
    network = train(task, config, tmp_path, report=quiet).network

    assert float(task.loss(network, np.random.default_rng(99), 8).detach()) < 0.7  # of 1.61 when it knows nothing


def test_pictures_without_classes_are_refused() -> None:
    with pytest.raises(TrainingError, match="simulate --semantic"):
        SegmentationTask([replace(PICTURES[0], semantic=None)], ("a",), CROPS)
