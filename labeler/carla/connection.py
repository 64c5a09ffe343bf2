"""Reaches a CARLA server through its Python client, which the extra ``carla`` brings.

The client must be of the server's version. Servers 0.9.12 to 0.9.16 are known; they differ in what their cameras tell:
only from 0.9.16 on does the instance segmentation camera show the numbers of actors, and 0.9.14 gave each kind of
vehicle a semantic tag of its own.
"""

import importlib
import re
from dataclasses import dataclass
from typing import Any

from labeler.carla.errors import CarlaError

INSTALL_COMMAND = "pip install 'hindsight-labeler[carla]'"
OLDEST, NEWEST = (0, 9, 12), (0, 9, 16)
_ACTOR_IDS_SINCE, _VEHICLE_TAGS_SINCE = (0, 9, 16), (0, 9, 14)


@dataclass(frozen=True)
class CarlaVersion:
    """A server's version as it tells it, and its three numbers."""

    text: str
    numbers: tuple[int, int, int]

    @property
    def shows_actor_ids(self) -> bool:
        """Whether pixels of the instance segmentation camera hold the numbers of actors."""
        return self.numbers >= _ACTOR_IDS_SINCE

    @property
    def vehicle_tags(self) -> tuple[int, ...]:
        """Semantic tags of cars, trucks, buses and motorcycles."""
        return (14, 15, 16, 18) if self.numbers >= _VEHICLE_TAGS_SINCE else (10,)


def import_carla() -> Any:
    """CARLA's client module. CarlaError, which names the extra, when it can't be loaded."""
    try:
        return importlib.import_module("carla")
    except ImportError as error:
        raise CarlaError(
            f"CARLA's Python client can't be loaded ({error}). Install it: {INSTALL_COMMAND} brings a client for CARLA "
            "0.9.16; for another server, install the wheel of its PythonAPI/carla/dist."
        ) from error


def connect(carla: Any, host: str, port: int, *, timeout_s: float) -> tuple[Any, CarlaVersion]:
    """A ``carla.Client`` and the server's version. CarlaError when no server answers, when it is of a version that is
    not supported, or of another one than the client."""
    client = carla.Client(host, port)
    client.set_timeout(timeout_s)
    try:
        told = str(client.get_server_version())
    except RuntimeError as error:
        raise CarlaError(
            f"No CARLA server answers at {host}:{port} ({error}). Start it there (CarlaUE4.sh -RenderOffScreen), or "
            "name another one with --host and --port."
        ) from error
    server = version_of(told)
    mine = version_of(str(client.get_client_version()))
    if not OLDEST <= server.numbers <= NEWEST:
        raise CarlaError(f"The CARLA server at {host}:{port} is of version {told}; 0.9.12 to 0.9.16 are supported.")
    if mine.numbers != server.numbers:
        raise CarlaError(
            f"The CARLA server at {host}:{port} is of version {server.text}, the installed client of {mine.text}. "
            "Install the wheel of the server's PythonAPI/carla/dist."
        )
    return client, server


def version_of(text: str) -> CarlaVersion:
    """From what a server or client says, such as ``0.9.15`` or ``0.9.13-dirty``. CarlaError where it has no number."""
    found = re.match(r"(\d+)\.(\d+)\.(\d+)", text)
    if found is None:
        raise CarlaError(
            f"CARLA says that its version is {text!r}, which is no number. Use a release, 0.9.12 to 0.9.16."
        )
    return CarlaVersion(text, (int(found[1]), int(found[2]), int(found[3])))
