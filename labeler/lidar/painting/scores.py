"""What a segmentation says about the classes that a detector knows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

_VEHICLES = ("car", "truck", "bus", "train", "motorcycle", "bicycle")
_PEOPLE = ("person", "rider", "pedestrian")


class PixelScores(Protocol):
    """Segmentation of one image: how surely a pixel shows each of its classes."""

    @property
    def class_names(self) -> tuple[str, ...]: ...

    def sums_at(self, pixels: NDArray[np.floating], groups: Sequence[Sequence[int]]) -> NDArray[np.float32]:
        """(N, G) scores in 0..1 of (N, 2) pixels: for each group of classes, the sum of theirs."""
        ...


def scores_of_classes(
    scores: PixelScores, pixels: NDArray[np.floating], class_names: Sequence[str], *, unknown: float = 1.0
) -> NDArray[np.float32]:
    """(N, K) how surely each of (N, 2) pixels shows each of K classes; ``unknown`` for one that the segmentation does
    not know. Classes of vehicles, and "vehicle", stand for one another.
    """
    groups = [
        tuple(plane for plane, known in enumerate(scores.class_names) if known.lower() in _meaning(name))
        for name in class_names
    ]
    known_groups = sorted({group for group in groups if group})  # all vehicles are one: looked up once
    found = np.minimum(scores.sums_at(pixels, known_groups), np.float32(1))
    shown = np.full((len(pixels), len(class_names)), unknown, np.float32)
    for number, group in enumerate(groups):
        if group:
            shown[:, number] = found[:, known_groups.index(group)]
    return shown


def _meaning(name: str) -> frozenset[str]:
    """The classes of a segmentation that show an object of a detector's class. Detectors call a truck car and a car
    truck, so all classes of vehicles speak for each of them."""
    if name in (*_VEHICLES, "vehicle"):
        return frozenset((*_VEHICLES, "vehicle"))
    return frozenset(_PEOPLE) if name in _PEOPLE else frozenset((name,))
