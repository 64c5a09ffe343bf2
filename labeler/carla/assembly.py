"""Puts together what the sensors deliver for one frame.

CARLA calls back in threads of its own: the readings of one frame come in any order, and one of an earlier frame may
come after them. So readings are kept by their frame's number until all sensors have delivered it.
"""

import threading
from collections.abc import Mapping, Sequence
from typing import Any

from labeler.carla.errors import CarlaError


class FrameAssembly:
    """Collects the readings of ``sensors``. Readings of frames before the one last taken are dropped."""

    def __init__(self, sensors: Sequence[str]) -> None:
        self._sensors = tuple(sensors)
        self._changed = threading.Condition()
        self._readings: dict[int, dict[str, Any]] = {}
        self._newest: dict[str, int] = {}
        self._taken = -1

    def receive(self, sensor: str, reading: Any) -> None:
        """A sensor has measured something. May be called in any thread."""
        with self._changed:
            frame = int(reading.frame)
            self._newest[sensor] = max(frame, self._newest.get(sensor, frame))
            if frame > self._taken:
                self._readings.setdefault(frame, {})[sensor] = reading
                self._changed.notify_all()

    def take(self, frame: int, *, timeout_s: float) -> Mapping[str, Any]:
        """The readings of all sensors for a frame, by sensor. CarlaError, which names the sensors that have not
        delivered, when that takes longer than ``timeout_s``."""
        with self._changed:
            whole = self._changed.wait_for(lambda: len(self._readings.get(frame, {})) == len(self._sensors), timeout_s)
            if not whole:
                raise CarlaError(self._complaint(frame, timeout_s))
            readings = self._readings[frame]
            self._taken = frame
            self._readings = {number: kept for number, kept in self._readings.items() if number > frame}
            return readings

    def _complaint(self, frame: int, timeout_s: float) -> str:
        here = self._readings.get(frame, {})
        missing = [self._last_heard(sensor) for sensor in self._sensors if sensor not in here]
        return (
            f"CARLA has not delivered frame {frame} of {', '.join(missing)} within {timeout_s:g} s. "
            "The server may be overloaded or out of graphics memory: try smaller images, or a longer --timeout."
        )

    def _last_heard(self, sensor: str) -> str:
        newest = self._newest.get(sensor)
        return f"{sensor} (nothing yet)" if newest is None else f"{sensor} (newest: frame {newest})"
