"""Where CARLA's client is installed: the fake has only what the real one has, and both reckon frames alike.

No server is needed for this.
"""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.carla.coordinates import parent_SE3_child, size_of, to_carla
from labeler.carla.vehicles import actor_SE3_body
from labeler.geometry.se3 import transform_points
from tests.labeler.carla import fake_carla

carla: Any = pytest.importorskip("carla", reason="needs CARLA's client, of the extra `carla`")

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
SINGLE_PRECISION_M = 1e-3
angles = st.floats(-179, 179)
places = st.floats(-500, 500)


@pytest.mark.parametrize(
    ("fake", "real"),
    [
        (fake_carla.Client, "Client"),
        (fake_carla.World, "World"),
        (fake_carla.TrafficManager, "TrafficManager"),
        (fake_carla.Settings, "WorldSettings"),
        (fake_carla.Blueprint, "ActorBlueprint"),
        (fake_carla.Blueprints, "BlueprintLibrary"),
        (fake_carla.Transform, "Transform"),
        (fake_carla.BoundingBox, "BoundingBox"),
        (fake_carla.Image, "Image"),
    ],
)
def test_the_fake_has_nothing_that_the_client_lacks(fake: type, real: str) -> None:
    own = {name for name in (*vars(fake), *getattr(fake, "__annotations__", {})) if not name.startswith("_")}
    assert own
    assert own <= set(dir(getattr(carla, real)))


@given(places, places, places, angles, st.floats(-89, 89), angles)
def test_motions_agree(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> None:
    place, turn = carla.Location(x=x, y=y, z=z), carla.Rotation(roll=roll, pitch=pitch, yaw=yaw)
    transform = carla.Transform(place, turn)
    ours = parent_SE3_child(transform)
    assert np.allclose(ours, MIRROR @ np.array(transform.get_matrix()) @ MIRROR, atol=SINGLE_PRECISION_M)
    location, rotation = to_carla(ours)
    again = carla.Transform(carla.Location(**location), carla.Rotation(**rotation))
    assert np.allclose(again.get_matrix(), transform.get_matrix(), atol=SINGLE_PRECISION_M)


@given(places, places, angles, st.floats(-89, 89), angles)
def test_corners_of_boxes_agree(x: float, y: float, roll: float, pitch: float, yaw: float) -> None:
    transform = carla.Transform(carla.Location(x=x, y=y), carla.Rotation(roll=roll, pitch=pitch, yaw=yaw))
    box = carla.BoundingBox(carla.Location(0.1, 0.2, 0.7), carla.Vector3D(2.0, 1.0, 0.75))
    signs = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (0.0, 1.0)])
    ours_m = transform_points(parent_SE3_child(transform) @ actor_SE3_body(box), signs * np.array(size_of(box.extent)))
    theirs_m = np.array([[corner.x, -corner.y, corner.z] for corner in box.get_world_vertices(transform)])
    nearest_m = np.linalg.norm(ours_m[:, None] - theirs_m[None], axis=2).min(axis=1)
    assert nearest_m.max() < SINGLE_PRECISION_M
