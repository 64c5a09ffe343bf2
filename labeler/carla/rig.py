"""The sensors of the recording car: the same roof rig as that of simulated drives, as CARLA's sensors.

The ego frame's origin is that of CARLA's vehicle: on the ground, below the middle of the car. Each direction has a
camera for colours and, at the same place, one or two that tell which vehicle each pixel shows.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from labeler.carla.assembly import FrameAssembly
from labeler.carla.borrowed_world import BorrowedWorld
from labeler.carla.config import CarlaConfig
from labeler.carla.connection import CarlaVersion
from labeler.carla.coordinates import SENSOR_SE3_CAMERA, to_carla
from labeler.geometry.se3 import invert_se3, se3
from labeler.simulation.rig import FIELD_OF_VIEW_DEG, Rig

LIDAR = "lidar"
COLOURS, INSTANCES, DEPTH, SEMANTICS = "rgb", "instance_segmentation", "depth", "semantic_segmentation"
_LIDAR_UPPER_DEG, _LIDAR_LOWER_DEG = 10.0, -25.0
_LIDAR_NOISE_M = 0.02
_LIDAR_DROPOUT = 0.05


def rig_of(ego: Any, config: CarlaConfig) -> Rig:
    """The rig on the roof of a ``carla.Vehicle``."""
    box = ego.bounding_box
    return Rig.on_roof(
        rear_axle_m=0.0,
        height_m=box.location.z + box.extent.z,
        width_px=config.width_px,
        height_px=config.height_px,
    )


def camera_kinds(version: CarlaVersion) -> tuple[str, ...]:
    """The kinds of cameras that each direction has."""
    return (COLOURS, INSTANCES) if version.shows_actor_ids else (COLOURS, DEPTH, SEMANTICS)


def sensor_name(kind: str, camera: str) -> str:
    """How a camera of a kind is called, in messages too."""
    return f"{camera} camera ({kind})"


def attach_sensors(
    carla: Any, borrowed: BorrowedWorld, rig: Rig, version: CarlaVersion, config: CarlaConfig
) -> FrameAssembly:
    """Fix all sensors to the ego car; what they measure comes to the assembly, by :func:`sensor_name` or LIDAR."""
    library = borrowed.world.get_blueprint_library()
    kinds = camera_kinds(version)
    names = [sensor_name(kind, view.camera) for view in rig.views for kind in kinds]
    assembly = FrameAssembly([*names, LIDAR])
    for view in rig.views:
        place = _place(carla, view.ego_SE3_camera @ invert_se3(SENSOR_SE3_CAMERA))
        for kind in kinds:
            blueprint = _with(library.find(f"sensor.camera.{kind}"), _camera_attributes(config))
            name = sensor_name(kind, view.camera)
            borrowed.attach(blueprint, place, lambda reading, name=name: assembly.receive(name, reading))
    blueprint = _with(library.find("sensor.lidar.ray_cast"), _lidar_attributes(config))
    place = _place(carla, se3(np.eye(3), rig.lidar_m))
    borrowed.attach(blueprint, place, lambda reading: assembly.receive(LIDAR, reading))
    return assembly


def _camera_attributes(config: CarlaConfig) -> dict[str, float]:
    """Motion blur and lens flares exist in cameras for colours only, and no object is where they show it."""
    return {
        "image_size_x": config.width_px,
        "image_size_y": config.height_px,
        "fov": FIELD_OF_VIEW_DEG,
        "sensor_tick": 0.0,
        "motion_blur_intensity": 0.0,
        "lens_flare_intensity": 0.0,
    }


def _lidar_attributes(config: CarlaConfig) -> dict[str, float]:
    """One whole turn each interval."""
    return {
        "channels": config.lidar_channels,
        "range": config.distance_m,
        "points_per_second": math.ceil(config.lidar_channels * config.lidar_columns / config.interval_s),
        "rotation_frequency": 1 / config.interval_s,
        "upper_fov": _LIDAR_UPPER_DEG,
        "lower_fov": _LIDAR_LOWER_DEG,
        "sensor_tick": 0.0,
        "noise_stddev": _LIDAR_NOISE_M,
        "dropoff_general_rate": _LIDAR_DROPOUT,
    }


def _with(blueprint: Any, attributes: Mapping[str, float]) -> Any:
    """The blueprint with those of the attributes that it has."""
    for name, value in attributes.items():
        if blueprint.has_attribute(name):
            blueprint.set_attribute(name, str(value))
    return blueprint


def _place(carla: Any, ego_SE3_sensor: Any) -> Any:
    location, rotation = to_carla(ego_SE3_sensor)
    return carla.Transform(carla.Location(**location), carla.Rotation(**rotation))
