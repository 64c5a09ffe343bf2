"""One open 3D view: a private viewer, what is drawn in it, and the thread that draws.

Asking for a view costs nothing and never waits: it replaces the one that waited before (latest wins), and the scene's
thread loads and draws it. When nothing waits, the thread reads the next frames' sweeps ahead.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from app.scene.canvas import SceneCanvas
from app.scene.errors import FrameNotFound
from app.scene.shapes import PointCloud, ground_height_m, point_cloud
from app.scene.types import SceneSource, SceneView
from app.scene.viewer import PrivateViewer
from labeler.errors import HindsightError

_log = logging.getLogger(__name__)

_READ_AHEAD = 2
_KEPT_SWEEPS = 8  # at most 16 bytes x 120,000 points each


class Scene:
    """A 3D view of one drive. Thread-safe. ``close`` must be called in the end."""

    def __init__(self, source: SceneSource, view: SceneView) -> None:
        """Start the viewer and ask for the first view. ViewerFailed, FrameNotFound."""
        self._source = source
        self._require_frame(view)
        self._viewer = PrivateViewer()
        self._canvas = SceneCanvas(self._viewer.server, source.cameras)
        self._sweeps: OrderedDict[int, PointCloud] = OrderedDict()
        self._changed = threading.Condition()
        self._wanted: SceneView | None = view
        self._last_view = view
        self._drawing = False
        self._closed = False
        self._connections = 0
        self._used_at = time.monotonic()
        self._thread = threading.Thread(target=self._run, name="scene", daemon=True)
        self._thread.start()

    @property
    def viewer(self) -> PrivateViewer:
        """Where the proxy connects to."""
        return self._viewer

    @property
    def view(self) -> SceneView:
        """The view asked for last."""
        with self._changed:
            return self._last_view

    @property
    def last_use(self) -> tuple[bool, float]:
        """Whether a page is connected now, and when anything was last asked of the scene (monotonic seconds).

        The order of these is the order in which scenes are spared."""
        with self._changed:
            return self._connections > 0, self._used_at

    def show(self, view: SceneView) -> None:
        """Ask for a view; returns at once. FrameNotFound when the drive has no such frame."""
        self._require_frame(view)
        with self._changed:
            self._wanted = view
            self._last_view = view
            self._used_at = time.monotonic()
            self._changed.notify_all()

    def wait_until_drawn(self, timeout_s: float) -> bool:
        """Wait until no view is waiting or being drawn. False when the time ran out."""
        with self._changed:
            return self._changed.wait_for(lambda: self._wanted is None and not self._drawing, timeout_s)

    @contextmanager
    def connection(self) -> Iterator[None]:
        """Marks a page as connected for as long as it is: the scene is in use."""
        with self._changed:
            self._connections += 1
            self._used_at = time.monotonic()
        try:
            yield
        finally:
            with self._changed:
                self._connections -= 1
                self._used_at = time.monotonic()

    def close(self) -> None:
        """Stop drawing, disconnect the page and free the port. Safe to call again."""
        with self._changed:
            if self._closed:
                return
            self._closed = True
            self._wanted = None
            self._changed.notify_all()
        self._thread.join()
        self._viewer.close()

    def _require_frame(self, view: SceneView) -> None:
        count = self._source.frame_count
        if not 0 <= view.frame_index < count:
            raise FrameNotFound(f"The drive has frames 0 to {count - 1}, not {view.frame_index}.")

    def _run(self) -> None:
        while (view := self._next_view()) is not None:
            self._attempt(self._draw, view)
            with self._changed:
                self._drawing = False
                self._changed.notify_all()
            self._attempt(self._read_ahead, view)

    def _attempt(self, step: Callable[[SceneView], None], view: SceneView) -> None:
        try:
            step(view)
        except Exception:  # the edge of the thread: nobody above could say it, and the next view may work
            _log.exception("frame %d could not be drawn in the 3D view", view.frame_index)

    def _next_view(self) -> SceneView | None:
        """The next view to draw, waiting for one; None when the scene was closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._wanted is not None or self._closed)
            view, self._wanted = self._wanted, None
            self._drawing = view is not None
            return view

    def _draw(self, view: SceneView) -> None:
        points = self._points(view.frame_index)
        boxes = self._source.boxes(view.frame_index)
        self._canvas.draw(view, points, boxes, ground_m=ground_height_m(points.xyz_m))

    def _points(self, frame_index: int) -> PointCloud:
        """The frame's points: kept ones, or read now. A sweep that can't be read is drawn as none."""
        if frame_index in self._sweeps:
            self._sweeps.move_to_end(frame_index)
            return self._sweeps[frame_index]
        try:
            points = point_cloud(self._source.sweep(frame_index))
        except HindsightError as error:
            _log.warning("the 3D view shows frame %d without points: %s", frame_index, error)
            points = point_cloud(None)
        self._sweeps[frame_index] = points
        while len(self._sweeps) > _KEPT_SWEEPS:
            self._sweeps.popitem(last=False)
        return points

    def _read_ahead(self, view: SceneView) -> None:
        first = view.frame_index + 1
        for ahead in range(first, min(first + _READ_AHEAD, self._source.frame_count)):
            with self._changed:
                if self._wanted is not None or self._closed:
                    return
            self._points(ahead)
