import sys
from typing import Any

import pytest

from labeler.carla.connection import connect, import_carla, version_of
from labeler.carla.errors import CarlaError
from tests.labeler.carla.fake_carla import Server, module_of


def connected(server: Server) -> Any:
    return connect(module_of(server), "sim", 2000, timeout_s=5)


@pytest.mark.parametrize(
    ("text", "numbers", "shows_actor_ids", "vehicle_tags"),
    [
        ("0.9.12", (0, 9, 12), False, (10,)),  # the paper's: no instance camera, one tag for all vehicles
        ("0.9.13-dirty", (0, 9, 13), False, (10,)),  # a build with changes
        ("0.9.14", (0, 9, 14), False, (14, 15, 16, 18)),  # a tag for each kind of vehicle
        ("0.9.16", (0, 9, 16), True, (14, 15, 16, 18)),  # actors' numbers in the instance camera
    ],
)
def test_what_versions_can_do(
    text: str, numbers: tuple[int, ...], shows_actor_ids: bool, vehicle_tags: tuple[int, ...]
) -> None:
    version = version_of(text)
    assert (version.numbers, version.shows_actor_ids, version.vehicle_tags) == (numbers, shows_actor_ids, vehicle_tags)


def test_a_version_without_numbers() -> None:
    with pytest.raises(CarlaError, match="'4f2c1ab'"):
        version_of("4f2c1ab")


def test_a_server_of_the_clients_version() -> None:
    client, version = connected(Server("0.9.15"))
    assert client.get_world() is not None
    assert version.text == "0.9.15"


def test_no_server() -> None:
    server = Server()
    server.broken_calls = ("get_server_version",)
    with pytest.raises(CarlaError, match="No CARLA server answers at sim:2000") as raised:
        connected(server)
    assert "--host" in str(raised.value)


@pytest.mark.parametrize("version", ["0.9.11", "0.10.0"])
def test_a_server_that_is_not_supported(version: str) -> None:
    with pytest.raises(CarlaError, match=r"0\.9\.12 to 0\.9\.16 are supported"):
        connected(Server(version))


def test_a_client_of_another_version() -> None:
    server = Server("0.9.15")
    server.client_version = "0.9.16"
    with pytest.raises(CarlaError, match=r"of version 0\.9\.15, the installed client of 0\.9\.16"):
        connected(server)


def test_no_client_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "carla", None)
    with pytest.raises(CarlaError, match=r"hindsight-labeler\[carla\]"):
        import_carla()
