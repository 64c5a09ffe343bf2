import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import main
from labeler.drive.registry import open_drive
from tests.labeler.carla.fake_carla import Server, module_of

SMALL = ["--vehicles", "2", "--frames", "1", "--width", "64", "--height", "64", "--lidar-channels", "8"]


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    made = Server()
    monkeypatch.setitem(sys.modules, "carla", module_of(made))
    yield made
    made.close()


def test_a_recording(server: Server, tmp_path: Path) -> None:
    pytest.importorskip("embreex", reason="needs embreex, of the extras `carla` and `simulation`")
    result = CliRunner().invoke(main, ["record-carla", str(tmp_path / "drive"), *SMALL])
    assert result.exit_code == 0
    assert "1 frames of CARLA 0.9.16" in result.stderr
    assert len(open_drive(tmp_path / "drive").frames) == 1


def test_ctrl_c_says_what_is_kept(server: Server, tmp_path: Path) -> None:
    pytest.importorskip("embreex", reason="needs embreex, of the extras `carla` and `simulation`")
    server.fail_at_frame, server.error = 41, KeyboardInterrupt()
    result = CliRunner().invoke(main, ["record-carla", str(tmp_path / "drive"), *SMALL])
    assert result.exit_code == 130
    assert "Stopped. Nothing was recorded." in result.stderr
    assert server.actors == {}


def test_without_the_client(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "carla", None)
    result = CliRunner().invoke(main, ["record-carla", str(tmp_path / "drive")])
    assert result.exit_code == 1
    assert "pip install 'hindsight-labeler[carla]'" in result.stderr


def test_an_interval_that_physics_cannot_follow(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["record-carla", str(tmp_path / "drive"), "--interval", "0.5"])
    assert result.exit_code == 2
