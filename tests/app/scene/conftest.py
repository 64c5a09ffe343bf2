"""A small synthetic street, and the real app with 3D views of it behind a real server."""

import socket
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

import numpy as np
import pytest
import uvicorn
from fastapi import FastAPI

from app.errors import install_error_handlers
from app.scene.endpoints import router
from app.scene.manager import SceneManager
from app.scene.types import SceneBox, SceneSource
from app.security import install_security
from labeler.drive.types import Calibration, Camera, Sweep
from labeler.geometry.se3 import se3

FRONT = Camera(
    name="front",
    width_px=800,
    height_px=400,
    calibration=Calibration(
        intrinsics=np.array([[400.0, 0.0, 400.0], [0.0, 400.0, 200.0], [0.0, 0.0, 1.0]]),
        ego_SE3_camera=se3([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [1.5, 0.0, 1.4]),
    ),
)


@dataclass
class Street:
    """Ten frames: frame i has i + 1 points, and one box, of identity 3, at x = 10 + i. It notes what was asked for."""

    frame_count: int = 10
    cameras: tuple[Camera, ...] = (FRONT, Camera(name="blind", width_px=8, height_px=4, calibration=None))
    asked_sweeps: list[int] = field(default_factory=list)
    asked_boxes: list[int] = field(default_factory=list)

    def sweep(self, frame_index: int) -> Sweep | None:
        self.asked_sweeps.append(frame_index)
        points = frame_index + 1
        xyz_m = np.tile(np.array([[5.0, 1.0, -0.3]], np.float32), (points, 1))
        return Sweep(timestamp_ns=frame_index, xyz_m=xyz_m, intensity=np.ones(points, np.float32))

    def boxes(self, frame_index: int) -> list[SceneBox]:
        self.asked_boxes.append(frame_index)
        return [SceneBox((10.0 + frame_index, 2.0, 0.5), (6.0, 3.0, 3.0), 0.1, 3, "truck", 0.9)]


@pytest.fixture
def street() -> Street:
    return Street()


@dataclass(frozen=True)
class Server:
    """The app under uvicorn on a free port of loopback."""

    host: str
    scenes: SceneManager
    stop: Callable[[], None]

    @property
    def origin(self) -> str:
        return f"http://{self.host}"


def make_app(scenes: SceneManager) -> FastAPI:
    """An app that has nothing but 3D views, put together as app.main does."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        app.state.scenes = scenes
        yield
        scenes.close()

    app = FastAPI(lifespan=lifespan)
    install_error_handlers(app)
    app.include_router(router)
    install_security(app)
    return app


@pytest.fixture
def sources(street: Street) -> dict[int, SceneSource]:
    """The drives of the server, by id; tests may add more."""
    return {1: street}


@pytest.fixture
def server(sources: dict[int, SceneSource]) -> Iterator[Server]:
    scenes = SceneManager(lambda drive_id: sources[drive_id], max_scenes=2)
    config = uvicorn.Config(make_app(scenes), host="127.0.0.1", port=0, log_level="error", ws_per_message_deflate=False)
    running = _NotifyingServer(config)
    thread = threading.Thread(target=running.run, daemon=True)
    thread.start()
    assert running.ready.wait(10)
    port = running.servers[0].sockets[0].getsockname()[1]

    def stop() -> None:
        running.should_exit = True
        thread.join(10)
        assert not thread.is_alive()

    yield Server(f"127.0.0.1:{port}", scenes, stop)
    stop()


class _NotifyingServer(uvicorn.Server):
    """Says when it listens, so that nobody has to poll."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.ready = threading.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready.set()
