"""Which scenes are open."""

import time
from collections.abc import Iterator

import psutil
import pytest

from app.scene.errors import SceneNotFound
from app.scene.manager import SceneManager
from app.scene.types import SceneSource, SceneView


@pytest.fixture
def scenes(street: SceneSource) -> Iterator[SceneManager]:
    manager = SceneManager(lambda _: street, max_scenes=2, idle_s=600)
    yield manager
    manager.close()


def is_open(scenes: SceneManager, scene_id: str) -> bool:
    try:
        scenes.get(scene_id)
    except SceneNotFound:
        return False
    return True


def listening_ports() -> set[int]:
    connections = psutil.Process().net_connections(kind="tcp")
    return {c.laddr.port for c in connections if c.status == psutil.CONN_LISTEN}


def test_the_least_recently_used_gives_way(scenes: SceneManager) -> None:
    first, second = scenes.open(1, SceneView(0)), scenes.open(1, SceneView(0))
    scenes.get(first).show(SceneView(1))  # now the second was used least recently
    third = scenes.open(1, SceneView(0))
    assert [is_open(scenes, key) for key in (first, second, third)] == [True, False, True]


def test_one_with_a_page_is_spared(scenes: SceneManager) -> None:
    watched, unwatched = scenes.open(1, SceneView(0)), scenes.open(1, SceneView(0))
    with scenes.get(watched).connection():
        scenes.get(unwatched).show(SceneView(1))  # used later, but nobody looks
        scenes.open(1, SceneView(0))
        assert is_open(scenes, watched)
        assert not is_open(scenes, unwatched)


def test_idle_ones_are_closed_unless_a_page_is_connected(scenes: SceneManager) -> None:
    watched, unwatched = scenes.open(1, SceneView(0)), scenes.open(1, SceneView(0))
    with scenes.get(watched).connection():
        scenes.close_idle(time.monotonic() + 599)
        assert is_open(scenes, unwatched)
        scenes.close_idle(time.monotonic() + 601)
        assert is_open(scenes, watched)
        assert not is_open(scenes, unwatched)


def test_closing_frees_every_port_and_opens_no_more(street: SceneSource) -> None:
    scenes = SceneManager(lambda _: street)
    ids = [scenes.open(1, SceneView(0)) for _ in range(2)]
    ports = {scenes.get(key).viewer.port for key in ids}
    assert ports <= listening_ports()
    scenes.close()
    assert not ports & listening_ports()
    before = listening_ports()
    late = scenes.open(1, SceneView(0))
    assert not is_open(scenes, late)
    assert listening_ports() == before


def test_a_closed_scene_is_gone_and_closing_it_again_is_fine(scenes: SceneManager) -> None:
    key = scenes.open(1, SceneView(0))
    port = scenes.get(key).viewer.port
    scenes.close_scene(key)
    scenes.close_scene(key)
    assert not is_open(scenes, key)
    assert port not in listening_ports()


def test_ids_cannot_be_guessed(scenes: SceneManager) -> None:
    first, second = scenes.open(1, SceneView(0)), scenes.open(1, SceneView(0))
    assert first != second
    assert min(len(first), len(second)) >= 32  # 24 random bytes in base64


def test_what_is_wrong_with_a_drive_reaches_the_caller() -> None:
    def no_such_drive(drive_id: int) -> SceneSource:
        raise LookupError(f"no drive {drive_id}")

    scenes = SceneManager(no_such_drive)
    with pytest.raises(LookupError, match="no drive 5"):
        scenes.open(5, SceneView(0))
    scenes.close()
