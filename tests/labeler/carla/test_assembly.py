import threading
from types import SimpleNamespace
from typing import Any

import pytest

from labeler.carla.assembly import FrameAssembly
from labeler.carla.errors import CarlaError

SOON_S = 0.02


def reading(frame: int, what: str = "") -> Any:
    return SimpleNamespace(frame=frame, what=what)


def test_readings_in_another_order_than_the_sensors() -> None:
    assembly = FrameAssembly(["left", "right"])
    assembly.receive("right", reading(7, "r"))
    assembly.receive("left", reading(7, "l"))
    taken = assembly.take(7, timeout_s=SOON_S)
    assert (taken["left"].what, taken["right"].what) == ("l", "r")


def test_readings_of_other_frames_are_not_mixed_in() -> None:
    """One sensor is a frame ahead, and the other one repeats the frame before."""
    assembly = FrameAssembly(["left", "right"])
    for sensor, frame in (("left", 7), ("left", 8), ("right", 6), ("right", 7), ("right", 6)):
        assembly.receive(sensor, reading(frame, f"{sensor} {frame}"))
    assert [one.what for one in assembly.take(7, timeout_s=SOON_S).values()] == ["left 7", "right 7"]
    assembly.receive("right", reading(8, "right 8"))
    assert {one.what for one in assembly.take(8, timeout_s=SOON_S).values()} == {"left 8", "right 8"}


def test_late_readings_of_taken_frames_are_dropped() -> None:
    assembly = FrameAssembly(["only"])
    assembly.receive("only", reading(7))
    assembly.take(7, timeout_s=SOON_S)
    assembly.receive("only", reading(7))
    with pytest.raises(CarlaError, match="frame 7"):
        assembly.take(7, timeout_s=SOON_S)


def test_a_reading_from_another_thread_is_waited_for() -> None:
    assembly = FrameAssembly(["only"])
    thread = threading.Thread(target=assembly.receive, args=("only", reading(3, "late")))
    thread.start()
    assert assembly.take(3, timeout_s=10)["only"].what == "late"
    thread.join()


def test_the_missing_sensors_are_named() -> None:
    assembly = FrameAssembly(["front", "rear", "lidar"])
    assembly.receive("front", reading(9))
    assembly.receive("rear", reading(8))
    with pytest.raises(CarlaError) as raised:
        assembly.take(9, timeout_s=SOON_S)
    assert "rear (newest: frame 8), lidar (nothing yet) within 0.02 s" in str(raised.value)
    assert "front" not in str(raised.value)
