"""The true vehicles of a CARLA world: what kind each is, its size, and where it is at a frame."""

from collections.abc import Mapping
from typing import Any
from uuid import UUID, uuid5

import numpy as np
from numpy.typing import NDArray

from labeler.carla.coordinates import parent_SE3_child, pose_of, size_of
from labeler.geometry.se3 import invert_se3, se3
from labeler.simulation.solids import Solid
from labeler.simulation.truth import Target

_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
_SIDES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
_TRIANGLES = np.array([half for a, b, c, d in _SIDES for half in ((a, b, c), (a, c, d))])
_KIND_BY_WORD = {
    "carlacola": "truck",
    "firetruck": "truck",
    "european_hgv": "truck",
    "cybertruck": "truck",
    "fusorosa": "bus",
}
"""Models whose kind a server older than 0.9.14 does not tell, or not as COCO would name it."""
_KIND_BY_BASE_TYPE = {"car": "car", "van": "car", "truck": "truck", "bus": "bus", "motorcycle": "motorcycle"}
_BICYCLES = ("crossbike", "omafiets", "century", "bicycle")


def category_of(type_id: str, attributes: Mapping[str, str]) -> str | None:
    """car, truck, bus or motorcycle, as COCO names it; None for a bicycle. ``type_id`` is a blueprint's name."""
    words = type_id.split(".")
    for word in words:
        if word in _KIND_BY_WORD:
            return _KIND_BY_WORD[word]
    base_type = attributes.get("base_type", "").lower()
    if base_type == "bicycle" or any(word in _BICYCLES for word in words):
        return None
    if int(attributes.get("number_of_wheels", "4")) == 2:
        return "motorcycle"
    return _KIND_BY_BASE_TYPE.get(base_type, "car")


class VehicleTruth:
    """Makes the targets of frames. Actors keep their ``track_uuid`` for the whole recording.

    The body's frame of a target is that of its 3D box: the origin is the middle of the box's lower side, which CARLA
    does not have to put below the actor's own origin."""

    def __init__(self, ego_id: int, recording: UUID) -> None:
        self._ego_id, self._recording = ego_id, recording
        self._solids: dict[tuple[float, float, float], Solid] = {}

    def targets(self, world: Any, snapshot: Any) -> list[Target]:
        """All vehicles of a ``carla.World`` but the ego car, at a ``carla.WorldSnapshot``, by number. Bicycles, actors
        without a size, and those that are not in the snapshot are left out."""
        ego_SE3_world = invert_se3(parent_SE3_child(snapshot.find(self._ego_id).get_transform()))
        targets: list[Target] = []
        for actor in sorted(world.get_actors().filter("vehicle.*"), key=lambda actor: int(actor.id)):
            seen = snapshot.find(actor.id)
            category = category_of(actor.type_id, actor.attributes)
            size_m = size_of(actor.bounding_box.extent)
            if actor.id == self._ego_id or seen is None or category is None or min(size_m) <= 0:
                continue
            world_SE3_actor = parent_SE3_child(seen.get_transform())
            targets.append(
                Target(
                    vehicle_id=int(actor.id),
                    track_uuid=str(uuid5(self._recording, str(actor.id))),
                    category=category,
                    solid=self._solid(size_m),
                    size_m=size_m,
                    ego_SE3_body=ego_SE3_world @ world_SE3_actor @ actor_SE3_body(actor.bounding_box),
                )
            )
        return targets

    def _solid(self, size_m: tuple[float, float, float]) -> Solid:
        """A box of that size, made once."""
        if size_m not in self._solids:
            triangles_m = (_CORNERS * np.array(size_m))[_TRIANGLES]
            self._solids[size_m] = Solid(triangles_m, np.ones(len(triangles_m)))
        return self._solids[size_m]


def actor_SE3_body(box: Any) -> NDArray[np.float64]:
    """(4, 4) from the middle of the lower side of a ``carla.BoundingBox`` to the frame of its actor."""
    return pose_of(box.location, box.rotation) @ se3(np.eye(3), [0.0, 0.0, -box.extent.z])
