"""Training learns, stops, and goes on as if it had not stopped."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

import torch

from labeler.training.crops import CropConfig
from labeler.training.detector import Crops, DetectorTask
from labeler.training.devices import CPU, device_of, workers_for
from labeler.training.errors import TrainingError
from labeler.training.loop import train
from labeler.training.recipes import Device
from labeler.training.segmenter import SegmentationTask
from labeler.training.state import CHECKPOINT, kept_workers
from labeler.training.task import Task, TrainingConfig
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


def loss_of(task: Task[Any, Any], network: torch.nn.Module, count: int = 8) -> float:
    """On the same examples each time."""
    with torch.no_grad():
        return float(task.loss(network, task.batch(task.examples(np.random.default_rng(99), range(count)), CPU)))


@pytest.mark.parametrize("by_workers", [True, False])  # as on the CPU, and as on a GPU
def test_a_run_that_was_stopped_ends_with_the_same_weights(tmp_path: Path, by_workers: bool) -> None:
    whole = train(detector_task(), CONFIG, tmp_path / "whole", report=quiet, by_workers=by_workers)
    train(detector_task(), CONFIG, tmp_path / "parts", report=quiet, by_workers=by_workers, stop_after=3)
    lines: list[str] = []
    resumed = train(detector_task(), CONFIG, tmp_path / "parts", report=lines.append, by_workers=by_workers)

    assert lines[0] == "going on from step 3"
    assert torch.equal(numbers_of(whole.network), numbers_of(resumed.network))
    assert [path.name for path in (tmp_path / "parts").iterdir()] == [CHECKPOINT]
    assert resumed.drives_since == ((0, ("a", "b")),)


def test_gradients_of_the_whole_batch_are_those_of_one_worker(tmp_path: Path) -> None:
    """With one worker both ways see the same examples at once, so they learn the same."""
    config = replace(CONFIG, workers=1)
    networks = [
        train(detector_task(), config, tmp_path / str(by_workers), report=quiet, by_workers=by_workers).network
        for by_workers in (True, False)
    ]

    assert not any(network.training for network in networks)
    assert torch.equal(numbers_of(networks[0]), numbers_of(networks[1]))


def test_a_run_goes_on_the_other_way_and_says_where_it_was(tmp_path: Path) -> None:
    train(detector_task(), CONFIG, tmp_path, report=quiet, by_workers=False, stop_after=3)
    assert kept_workers(tmp_path) == 2
    assert train(detector_task(), CONFIG, tmp_path, report=quiet).devices_since == ((0, "cpu"),)


def test_every_kind_of_crop_is_dealt_out_however_many_workers_share_a_batch() -> None:
    rng = np.random.default_rng(0)
    shares = [detector_task().examples(rng, range(number, number + 1)) for number in range(4)]

    assert [share[0].image.shape for share in shares] == [(64, 96, 3), (96, 128, 3)] * 2


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a GPU")
def test_a_gpu_that_is_not_there_is_said_to_be_missing() -> None:
    assert device_of(Device.CPU) == CPU
    with pytest.raises(TrainingError, match=r"needs an NVIDIA GPU that torch can use.*Leave it out"):
        device_of(Device.CUDA)


def test_workers_beside_a_gpu_share_a_batch_evenly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labeler.training.devices.os.sched_getaffinity", lambda _: set(range(16)), raising=False)
    # One core is kept free; 15 divide 30, and of what divides 64 or 8, 8 is the most below; 7 is a prime.
    assert [workers_for(batch) for batch in (30, 64, 8, 7, 17, 1)] == [15, 8, 8, 7, 1, 1]
    monkeypatch.setattr("labeler.training.devices.os.sched_getaffinity", lambda _: {0})
    assert workers_for(8) == 1


@pytest.mark.parametrize("task", [detector_task(), SegmentationTask(PICTURES, ("a",), CROPS)])
def test_nothing_of_a_loss_is_made_on_another_device_or_waits_for_a_value(task: Task[Any, Any]) -> None:
    """A meta tensor has no values: reading one, or mixing it with the CPU's, fails as it would cost time on a GPU."""
    meta = torch.device("meta")
    batch = task.batch(task.examples(np.random.default_rng(0), range(4)), meta)

    loss = task.loss(task.new_network().to(meta), batch)
    loss.backward()

    assert loss.is_meta


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


@pytest.mark.parametrize("by_workers", [True, False])
def test_a_loss_that_is_not_a_number_ends_it(tmp_path: Path, by_workers: bool) -> None:
    class Broken(DetectorTask):
        def loss(self, network: torch.nn.Module, batch: Sequence[Crops]) -> torch.Tensor:
            return super().loss(network, batch) * float("nan")

    with pytest.raises(TrainingError, match="The loss of step 0 is nan"):
        train(Broken(PICTURES, ("a",), (CROPS,), TINY), CONFIG, tmp_path, report=quiet, by_workers=by_workers)
    assert not (tmp_path / CHECKPOINT).exists()


def test_weights_that_are_not_numbers_are_not_kept(tmp_path: Path) -> None:
    class Broken(DetectorTask):
        def loss(self, network: torch.nn.Module, batch: Sequence[Crops]) -> torch.Tensor:
            loss = super().loss(network, batch)
            return loss.detach() + 0 * (loss - loss.detach()).sqrt()  # finite, but not its gradient

    with pytest.raises(TrainingError, match="Weights after step 1 are not finite"):
        train(Broken(PICTURES, ("a",), (CROPS,), TINY), replace(CONFIG, steps=1), tmp_path, report=quiet)
    assert not (tmp_path / CHECKPOINT).exists()


def test_a_tiny_detector_learns_two_pictures(tmp_path: Path) -> None:
    config = replace(CONFIG, steps=60, batch_size=4, learning_rate=5e-3, ema_decay=0.9)
    task = detector_task()
    network = train(task, config, tmp_path, report=quiet).network

    assert loss_of(task, network) < 0.85 * loss_of(task, task.new_network().eval())


def test_a_segmentation_learns_two_pictures_by_heart(tmp_path: Path) -> None:
    task = SegmentationTask(PICTURES, ("a",), replace(CROPS, replicate_edge=True))
    config = replace(CONFIG, steps=60, learning_rate=5e-3, ema_decay=0.9)
    network = train(task, config, tmp_path, report=quiet, by_workers=False).network

    assert loss_of(task, network) < 0.7  # of 1.61 when it knows nothing


def test_pictures_without_classes_are_refused() -> None:
    with pytest.raises(TrainingError, match="simulate --semantic"):
        SegmentationTask([replace(PICTURES[0], semantic=None)], ("a",), CROPS)
