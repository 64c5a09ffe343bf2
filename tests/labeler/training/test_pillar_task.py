"""The pillar network learns, and its file finds what torch finds."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")
pytest.importorskip("onnx", reason="needs onnx, of the extra `training`")

import torch

from labeler.inference import ModelError
from labeler.lidar.pillars.decode import Outputs, decode
from labeler.lidar.pillars.grouping import Grid, pillars_of
from labeler.lidar.pillars.network import PillarModel
from labeler.training.devices import CPU
from labeler.training.loop import train
from labeler.training.onnx_export import export_detector, export_pillars
from labeler.training.pillar_loss import AskedOfCells, pillar_loss
from labeler.training.pillar_network import PillarNetwork
from labeler.training.pillar_targets import PillarTargets
from labeler.training.pillar_task import PillarBatch, PillarTask
from labeler.training.task import TrainingConfig
from labeler.training.yolox_network import Yolox, YoloxShape
from tests.labeler.training.made_clouds import direction

SWEEPS = [direction((15, 3, 20), (30, -6, -90)), direction((10, -3, 160), seed=1), direction((22, 0, 60), seed=2)]
GRID = Grid(x_min_m=0, y_min_m=-12.8, cell_m=0.4, rows=96, columns=64)


def batch_of(task: PillarTask, rng: np.random.Generator, count: int, device: torch.device = CPU) -> PillarBatch:
    return task.batch(task.examples(rng, range(count)), device)


@pytest.fixture(scope="module")
def network() -> PillarNetwork:
    """A few steps old."""
    config = TrainingConfig(seed=1, steps=4, batch_size=4, workers=2, warm_up_steps=1)
    task = PillarTask(SWEEPS, ["a"], window_cells=(32, 32))
    rng = np.random.default_rng(0)
    torch.manual_seed(config.seed)
    made = task.new_network().train()
    with torch.no_grad():
        for _ in range(4):  # statistics of batch normalisation that are not those of a new one
            task.loss(made, batch_of(task, rng, 4))
    assert isinstance(made, PillarNetwork)
    return made.eval()


@pytest.mark.parametrize(("painted", "by_workers"), [(True, True), (False, True), (True, False)])
def test_it_learns(tmp_path: Path, painted: bool, by_workers: bool) -> None:
    config = TrainingConfig(seed=1, steps=12, batch_size=4, workers=2, warm_up_steps=1, learning_rate=5e-3)
    task = PillarTask(SWEEPS, ["a"], painted=painted, window_cells=(32, 32))
    lines: list[str] = []
    trained = train(task, config, tmp_path, report=lines.append, by_workers=by_workers)
    torch.manual_seed(config.seed)
    untrained = task.new_network().train()
    with torch.no_grad():
        before = float(task.loss(untrained, batch_of(task, np.random.default_rng(0), 16)))
        after = float(task.loss(trained.network.train(), batch_of(task, np.random.default_rng(0), 16)))
    assert after < 0.9 * before


@pytest.mark.parametrize("cars", [((15.0, 3.0, 20.0),), ()])
def test_a_file_finds_what_torch_finds(
    network: PillarNetwork, tmp_path: Path, cars: tuple[tuple[float, ...], ...]
) -> None:
    cloud = direction(*cars, clutter=30 if cars else 0).cloud()  # pyright: ignore[reportArgumentType]
    pillars = pillars_of(cloud, GRID)
    with torch.no_grad():
        output = network(torch.from_numpy(pillars.points), torch.from_numpy(pillars.cell), GRID)
    expected = decode(output[0].numpy(), GRID, min_score=0.0)

    export_pillars(network, tmp_path / "p.onnx", source="test", grid=GRID)
    model = PillarModel(tmp_path / "p.onnx")
    found = model.find(cloud, min_score=0.0)

    assert (model.painted, model.class_names) == (True, ("car", "truck", "bus", "motorcycle"))
    assert model.grid == GRID
    # Half-precision weights: the surest boxes are the same.
    np.testing.assert_allclose(found.score[:3], expected.score[:3], atol=0.01)
    assert (tmp_path / "p.onnx").stat().st_size < 400_000
    assert [path.name for path in tmp_path.iterdir()] == ["p.onnx"]


def test_an_unpainted_network_says_so(tmp_path: Path) -> None:
    task = PillarTask(SWEEPS, ["a"], painted=False)
    unpainted = task.new_network().eval()
    assert isinstance(unpainted, PillarNetwork)
    export_pillars(unpainted, tmp_path / "p.onnx", source="test")
    model = PillarModel(tmp_path / "p.onnx")
    assert not model.painted
    assert len(model.find(SWEEPS[0].cloud(), min_score=0.9)) == 0


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    export_detector(
        Yolox(4, YoloxShape(depth=0.33, width=0.125, depthwise=True)).eval(), tmp_path / "d.onnx", source=""
    )
    with pytest.raises(ModelError, match="does not say that it is a pillar network"):
        PillarModel(tmp_path / "d.onnx")


def test_the_loss_is_lowest_where_the_answer_is_right() -> None:
    """One car in the middle cell of nine, turned by 30 degrees."""
    yaw_rad, size_m = np.radians(30), np.array([4.5, 1.8, 1.5])
    heat = np.zeros((3, 3), np.float32)
    heat[1, 1] = 1
    box = np.array([[0.2, -0.1, 0.75, *size_m, yaw_rad]], np.float32)
    targets = PillarTargets(
        heat, np.ones((3, 3), np.bool_), np.array([4]), np.ones(1, np.float32), box, np.array([2]), 1
    )
    right = torch.zeros(1, Outputs.channels(4), 3, 3)
    right[:, Outputs.HEAT] = -8
    right[:, Outputs.HEAT, 1, 1] = 8
    right[:, Outputs.QUALITY] = 8
    right[0, Outputs.OFFSET, 1, 1] = torch.tensor([0.2, -0.1])
    right[0, Outputs.HEIGHT, 1, 1] = 0.75
    right[0, Outputs.LOG_SIZE, 1, 1] = torch.from_numpy(np.log(size_m)).float()
    right[0, Outputs.AXIS, 1, 1] = torch.tensor([np.sin(2 * yaw_rad), np.cos(2 * yaw_rad)]).float()
    right[0, Outputs.HEADING, 1, 1] = torch.tensor([np.sin(yaw_rad), np.cos(yaw_rad)]).float()
    right[0, Outputs.LOG_STD, 1, 1] = -5
    right[0, Outputs.CLASSES + 2, 1, 1] = 9
    asked = AskedOfCells.of([targets], CPU)
    lowest = float(pillar_loss(right, asked))
    for channel, change in (
        (Outputs.HEAT, -12.0), (Outputs.QUALITY, -6.0), (2, 0.5), (3, -0.5), (Outputs.HEIGHT, 0.5), (5, 0.3), (6, -0.3),
        (8, -1.0), (10, -1.0), (12, 2.0), (Outputs.CLASSES, 12.0),
    ):  # fmt: skip
        wrong = right.clone()
        wrong[0, channel, 1, 1] += change
        assert float(pillar_loss(wrong, asked)) > lowest + 0.01, channel
    false = right.clone()
    false[0, Outputs.HEAT, 0, 0] = 4
    assert float(pillar_loss(false, asked)) > lowest + 0.5
    nowhere = PillarTargets(
        heat * 0, targets.counts, np.zeros(0, np.int64), np.zeros(0, np.float32), box[:0], np.zeros(0, np.int64), 0
    )
    assert np.isfinite(float(pillar_loss(right, AskedOfCells.of([nowhere], CPU))))


def test_nothing_of_it_is_made_on_another_device_or_waits_for_a_value() -> None:
    """A meta tensor has no values: reading one, or mixing it with the CPU's, fails as it would cost time on a GPU."""
    task, meta = PillarTask(SWEEPS, ["a"], window_cells=(32, 32)), torch.device("meta")
    batch = batch_of(task, np.random.default_rng(0), 4, meta)

    loss = task.loss(task.new_network().to(meta), batch)
    loss.backward()

    assert loss.is_meta
    assert len(batch.asked.cell)
