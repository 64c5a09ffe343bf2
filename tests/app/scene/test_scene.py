"""One open view: what is drawn, and that the latest request wins."""

import threading
from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
import pytest

from app.scene.canvas import label_text
from app.scene.errors import FrameNotFound
from app.scene.palette import faded, identity_color, scene_palette
from app.scene.scene import Scene
from app.scene.tone import line_colors
from app.scene.types import SceneBox, SceneSource, SceneView, Theme
from labeler.drive.errors import DriveFileError
from labeler.drive.types import Sweep


@pytest.fixture
def scene(street: SceneSource) -> Iterator[Scene]:
    opened = Scene(street, SceneView(0))
    assert opened.wait_until_drawn(10)
    yield opened
    opened.close()


def node(scene: Scene, name: str) -> object:
    return scene.viewer.server.scene.get_handle_by_name(name)


def prop(scene: Scene, name: str, prop_name: str) -> Any:
    return getattr(node(scene, name), prop_name)


def test_the_first_view_is_drawn(scene: Scene) -> None:
    points = prop(scene, "/sweep", "points")
    assert points.dtype == np.float32
    assert points.tolist() == [pytest.approx([5.0, 1.0, -0.3])]
    assert prop(scene, "/boxes/edges", "points").shape == (13, 2, 3)
    assert node(scene, "/cameras/front") is not None
    assert node(scene, "/cameras/blind") is None  # no calibration, no place
    assert node(scene, "/ground") is not None
    assert node(scene, "/ego/edges") is not None


def test_a_new_view_replaces_the_points_and_the_boxes(scene: Scene) -> None:
    scene.show(SceneView(4))
    assert scene.wait_until_drawn(10)
    assert len(prop(scene, "/sweep", "points")) == 5
    assert prop(scene, "/boxes/faces", "batched_positions").tolist() == [[14.0, 2.0, 0.5]]


def test_the_selected_identity_is_thick_and_named(scene: Scene) -> None:
    scene.show(SceneView(0, identity_id=3))
    assert scene.wait_until_drawn(10)
    assert node(scene, "/boxes") is None
    assert prop(scene, "/selected/edges", "thickness") > prop(scene, "/ego/edges", "thickness")
    assert prop(scene, "/selected/faces", "batched_colors").tolist() == [list(identity_color(3))]
    assert prop(scene, "/selected_label", "text") == "#3 truck 0.90"
    scene.show(SceneView(0, identity_id=None))
    assert scene.wait_until_drawn(10)
    assert node(scene, "/selected") is None
    assert node(scene, "/selected_label") is None


def test_the_others_stand_back_while_one_is_selected(street: SceneSource) -> None:
    class TwoCars:
        cameras, frame_count, sweep = street.cameras, 1, street.sweep

        def boxes(self, frame_index: int) -> list[SceneBox]:
            return [
                SceneBox((10.0, y, 0.5), (4.0, 2.0, 1.6), 0.0, number, "car", None) for number, y in ((1, 2), (2, 6))
            ]

    scene = Scene(TwoCars(), SceneView(0, identity_id=1))
    try:
        assert scene.wait_until_drawn(10)
        pale = faded(identity_color(2), scene_palette(Theme.DARK).background)
        assert (
            prop(scene, "/boxes/edges", "colors")[0, 0].tolist() == line_colors(np.array([pale], np.uint8))[0].tolist()
        )
    finally:
        scene.close()


def test_the_theme_changes_the_points(scene: Scene) -> None:
    dark = prop(scene, "/sweep", "colors").tolist()
    scene.show(SceneView(0, theme=Theme.LIGHT))
    assert scene.wait_until_drawn(10)
    assert prop(scene, "/sweep", "colors").tolist() != dark


@pytest.mark.parametrize("frame_index", [-1, 10])
def test_a_frame_that_is_not_there_is_refused(scene: Scene, frame_index: int) -> None:
    with pytest.raises(FrameNotFound, match="frames 0 to 9"):
        scene.show(SceneView(frame_index))


class SlowStreet:
    """Holds the reading of frame 0 until it is let go."""

    def __init__(self, street: SceneSource) -> None:
        self._street = street
        self.cameras, self.frame_count = street.cameras, street.frame_count
        self.drawn_boxes: list[int] = []
        self.is_reading, self.let_go = threading.Event(), threading.Event()

    def sweep(self, frame_index: int) -> Sweep | None:
        if frame_index == 0:
            self.is_reading.set()
            assert self.let_go.wait(10)
        return self._street.sweep(frame_index)

    def boxes(self, frame_index: int) -> list[SceneBox]:
        self.drawn_boxes.append(frame_index)
        return list(self._street.boxes(frame_index))


def test_the_latest_view_wins(street: SceneSource) -> None:
    slow = SlowStreet(street)
    scene = Scene(slow, SceneView(0))
    try:
        assert slow.is_reading.wait(10)
        for frame_index in (1, 2, 3):
            scene.show(SceneView(frame_index))  # returns at once although the thread is busy
        assert not scene.wait_until_drawn(0)
        slow.let_go.set()
        assert scene.wait_until_drawn(10)
        assert slow.drawn_boxes == [0, 3]
        assert len(prop(scene, "/sweep", "points")) == 4
    finally:
        slow.let_go.set()
        scene.close()


def test_the_next_sweeps_are_read_ahead(street: SceneSource) -> None:
    class Counting:
        """Says when frame 2 was read, which only reading ahead of frame 0 does."""

        cameras, frame_count, boxes = street.cameras, street.frame_count, street.boxes
        asked: ClassVar[list[int]] = []
        two_was_read = threading.Event()

        def sweep(self, frame_index: int) -> Sweep | None:
            self.asked.append(frame_index)
            if frame_index == 2:
                self.two_was_read.set()
            return street.sweep(frame_index)

    source = Counting()
    scene = Scene(source, SceneView(0))
    try:
        assert source.two_was_read.wait(10)
        scene.show(SceneView(1))
        assert scene.wait_until_drawn(10)
        assert source.asked[:3] == [0, 1, 2]
        assert source.asked.count(1) == 1  # it was there already
    finally:
        scene.close()


def test_a_broken_sweep_is_an_empty_one(street: SceneSource, caplog: pytest.LogCaptureFixture) -> None:
    class Broken:
        cameras, frame_count, boxes = street.cameras, 2, street.boxes

        def sweep(self, frame_index: int) -> Sweep | None:
            raise DriveFileError(f"sweep {frame_index} is cut short")

    scene = Scene(Broken(), SceneView(0))
    try:
        assert scene.wait_until_drawn(10)
        assert prop(scene, "/sweep", "points").shape == (0, 3)
        assert prop(scene, "/boxes/edges", "points").shape == (13, 2, 3)
        assert "sweep 0 is cut short" in caplog.text
    finally:
        scene.close()


def test_a_failure_does_not_end_the_thread(street: SceneSource, caplog: pytest.LogCaptureFixture) -> None:
    class Forgetful:
        cameras, frame_count, sweep = street.cameras, street.frame_count, street.sweep

        def boxes(self, frame_index: int) -> list[SceneBox]:
            if frame_index == 0:
                raise OSError("the store is gone")
            return list(street.boxes(frame_index))

    scene = Scene(Forgetful(), SceneView(0))
    try:
        assert scene.wait_until_drawn(10)
        assert "the store is gone" in caplog.text
        scene.show(SceneView(1))
        assert scene.wait_until_drawn(10)
        assert len(prop(scene, "/sweep", "points")) == 2
    finally:
        scene.close()


@pytest.mark.parametrize(
    ("identity_id", "score", "text"),
    [(7, 0.876, "#7 car 0.88"), (None, 0.5, "car 0.50"), (0, None, "#0 car")],  # 0 is an id like any other
)
def test_labels_say_what_is_known(identity_id: int | None, score: float | None, text: str) -> None:
    assert label_text(SceneBox((0, 0, 0), (1, 1, 1), 0.0, identity_id, "car", score)) == text
