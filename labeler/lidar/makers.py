"""How 3D boxes are made of what the cameras of one frame see: one protocol, and the methods that a configuration names.

A maker gets the sweep, made ready once, and what each camera contributes. It answers with the boxes of each camera
direction by itself, in the ego frame at the frame's time, each belonging to one of that camera's detections.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Protocol

from labeler.detection.types import Detections
from labeler.errors import HindsightError
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.scores import PixelScores
from labeler.lidar.painting.view import View
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D


class LidarError(HindsightError):
    """The LiDAR step can't be set up as asked for."""


@dataclass(frozen=True, eq=False)
class CameraInput:
    """What one camera contributes to a frame: where it is, what was detected in its image, and a segmentation of it
    where there is one."""

    view: View
    detections: Detections
    scores: PixelScores | None = None


class BoxMaker(Protocol):
    """Makes the 3D boxes of each camera direction of one frame. ``takes_paint``: it needs a segmentation."""

    @property
    def takes_paint(self) -> bool: ...

    def boxes(self, scene: Scene, cameras: Mapping[str, CameraInput]) -> dict[str, Boxes3D]:
        """The boxes of every camera by name, in order of its detections, at most one for each."""
        ...


_MAKERS = {
    "clusters": "labeler.lidar.cluster_boxes:ClusterBoxMaker",
    "pillars": "labeler.lidar.pillars.maker:PillarBoxMaker",
}
"""Where each maker is: loaded when it is chosen."""


def takes_paint(config: LidarConfig) -> bool:
    """Whether the maker needs a segmentation, without which it has no boxes of its own. LidarError or ModelError when
    it can't be used."""
    maker = open_box_maker(config, class_names=())
    return maker.takes_paint


def open_box_maker(config: LidarConfig, *, class_names: tuple[str, ...]) -> BoxMaker:
    """The maker that ``config.method`` names, for detections whose ``class_id`` counts in ``class_names``.

    LidarError for a method that does not exist, ModelError for a network that can't be used."""
    place = _MAKERS.get(config.method)
    if place is None:
        raise LidarError(f"There is no method {config.method!r} for 3D boxes. Choose one of: {', '.join(_MAKERS)}.")
    module, _, name = place.partition(":")
    make: Callable[..., BoxMaker] = getattr(import_module(module), name)
    return make(config, class_names=class_names)
