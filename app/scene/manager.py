"""Which 3D views are open: at most a few, none forgotten."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable

from app.scene.errors import SceneNotFound
from app.scene.scene import Scene
from app.scene.types import SceneSource, SceneView

SourceOpener = Callable[[int], SceneSource]


class SceneManager:
    """Opens, finds and closes scenes. Thread-safe; ``close`` it when the app shuts down.

    ``open_source`` gives the content of a drive by its id, and raises when there is none. Beyond ``max_scenes`` the
    least recently used scene is closed, those without a connected page first. A scene without a page that nobody has
    asked anything of for ``idle_s`` seconds is closed as well.
    """

    def __init__(self, open_source: SourceOpener, *, max_scenes: int = 4, idle_s: float = 600.0) -> None:
        self._open_source = open_source
        self._max_scenes = max_scenes
        self._idle_s = idle_s
        self._lock = threading.Lock()
        self._scenes: dict[str, Scene] = {}
        self._closing = threading.Event()
        self._watch: threading.Thread | None = None

    def open(self, drive_id: int, view: SceneView) -> str:
        """Open a scene of a drive and return its id, which can't be guessed.

        Raises what ``open_source`` raises, FrameNotFound, ViewerFailed."""
        scene = Scene(self._open_source(drive_id), view)
        scene_id = secrets.token_urlsafe(24)
        with self._lock:
            if self._closing.is_set():
                surplus = [scene]
            else:
                surplus = self._take_least_recently_used(self._max_scenes - 1)
                self._scenes[scene_id] = scene
                self._start_watch()
        _close_all(surplus)
        return scene_id

    def get(self, scene_id: str) -> Scene:
        """The open scene of that id. SceneNotFound when there is none."""
        with self._lock:
            scene = self._scenes.get(scene_id)
        if scene is None:
            raise SceneNotFound("This 3D view is no longer open. Reload the page to open it again.")
        return scene

    def close_scene(self, scene_id: str) -> None:
        """Close one scene; nothing happens when it is closed already."""
        with self._lock:
            scene = self._scenes.pop(scene_id, None)
        _close_all([scene] if scene else [])

    def close_idle(self, now: float) -> None:
        """Close the scenes without a page that were last used before ``now - idle_s`` (monotonic seconds)."""
        limit = (False, now - self._idle_s)
        with self._lock:
            idle = [key for key, scene in self._scenes.items() if scene.last_use < limit]
            scenes = [self._scenes.pop(key) for key in idle]
        _close_all(scenes)

    def close(self) -> None:
        """Close every scene, and open none any more."""
        self._closing.set()
        with self._lock:
            scenes = list(self._scenes.values())
            self._scenes.clear()
            watch = self._watch
        _close_all(scenes)
        if watch is not None:
            watch.join()

    def _take_least_recently_used(self, allowed: int) -> list[Scene]:
        by_use = sorted(self._scenes, key=lambda key: self._scenes[key].last_use)
        return [self._scenes.pop(key) for key in by_use[: max(0, len(by_use) - allowed)]]

    def _start_watch(self) -> None:
        if self._watch is None:
            self._watch = threading.Thread(target=self._close_idle_ones, name="scene-watch", daemon=True)
            self._watch.start()

    def _close_idle_ones(self) -> None:
        while not self._closing.wait(self._idle_s / 4):
            self.close_idle(time.monotonic())


def _close_all(scenes: list[Scene]) -> None:
    for scene in scenes:
        scene.close()
