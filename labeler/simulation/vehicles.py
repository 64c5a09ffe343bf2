"""The fleet: every model of vehicle that may drive or park in a simulated town.

A model's frame has x forward, y to the left and z up, with the middle of its bounding box on the z axis and its wheels
on z = 0. So a vehicle's 3D box is centred at height ``size_m[2] / 2`` above the place where the model is put.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from labeler.simulation.car_body import DETAILS, car_mesh
from labeler.simulation.car_pictures import draw_car
from labeler.simulation.car_shapes import CAR_SHAPES
from labeler.simulation.heavy_vehicles import BUS_SHAPES, TRUCK_SHAPES, bus_meshes, truck_meshes
from labeler.simulation.meshes import Mesh
from labeler.simulation.motorcycles import motorcycle_mesh
from labeler.simulation.textures import TextureSet
from labeler.simulation.wheels import draw_rim

Category = Literal["car", "truck", "bus", "motorcycle"]
Paint = tuple[float, float, float]

_CAR_PAINTS: tuple[Paint, ...] = (
    (0.80, 0.80, 0.80), (0.72, 0.73, 0.74), (0.50, 0.51, 0.52), (0.020, 0.020, 0.022), (0.05, 0.055, 0.06),
    (0.18, 0.19, 0.20), (0.35, 0.36, 0.37), (0.45, 0.02, 0.02), (0.02, 0.06, 0.28), (0.04, 0.16, 0.38),
    (0.30, 0.28, 0.22), (0.02, 0.12, 0.06), (0.60, 0.38, 0.03), (0.25, 0.02, 0.03), (0.10, 0.22, 0.30),
    (0.42, 0.16, 0.03),
)  # fmt: skip
_HEAVY_PAINTS: tuple[Paint, ...] = (
    (0.80, 0.80, 0.80), (0.72, 0.06, 0.05), (0.75, 0.50, 0.04), (0.06, 0.24, 0.60), (0.12, 0.42, 0.16),
    (0.55, 0.60, 0.65),
)  # fmt: skip


@dataclass(frozen=True)
class VehicleModel:
    """One model. ``size_m`` is (length, width, height) of its bounding box, mirrors included.

    ``details`` are its meshes from near to far. ``front_axle_m`` and ``rear_axle_m`` are x of the foremost and the
    rearmost axle. ``paints`` are the linear RGB paints it may have. ``rider`` says whether a person sits on it, which
    is so for motorcycles that drive; ``parks`` whether it may stand empty."""

    name: str
    category: Category
    size_m: tuple[float, float, float]
    details: tuple[Mesh, ...]
    front_axle_m: float
    rear_axle_m: float
    paints: tuple[Paint, ...]
    rider: bool = False

    @property
    def mesh(self) -> Mesh:
        """The finest mesh."""
        return self.details[0]

    @property
    def collision_mesh(self) -> Mesh:
        """What a LiDAR hits: the middle level of detail."""
        return self.details[1]

    @property
    def parks(self) -> bool:
        return not self.rider

    @property
    def drives(self) -> bool:
        """Motorcycles don't drive by themselves."""
        return self.rider or self.category != "motorcycle"


def fleet(seed: int, textures: TextureSet | None = None) -> tuple[VehicleModel, ...]:
    """The models that follow from ``seed``; their pictures are added to ``textures``."""
    layers = TextureSet() if textures is None else textures
    rng = np.random.default_rng([seed, 2])
    rims = [draw_rim(layers, spokes) for spokes in (5, 7, 10)]
    steel_rim = draw_rim(layers, 8, steel=True)
    models = [*_cars(layers, rng, rims, steel_rim), *_heavy(layers, rng, steel_rim), *_motorcycles(rng, rims[1])]
    return tuple(models)


def _cars(textures: TextureSet, rng: np.random.Generator, rims: list[int], steel_rim: int) -> list[VehicleModel]:
    models: list[VehicleModel] = []
    for style in CAR_SHAPES:
        for number in range(2):
            shape = style.varied(rng)
            rim = steel_rim if shape.body == "van" else rims[int(rng.integers(len(rims)))]
            layers = draw_car(textures, shape, rng, rim)
            details = tuple(car_mesh(shape, layers, detail) for detail in range(DETAILS))
            category: Category = "truck" if shape.category == "truck" else "car"
            axles = (shape.front_axle_m, shape.rear_axle_m)
            models.append(_model(f"{shape.style}-{number}", category, details, axles, _CAR_PAINTS))
    return models


def _heavy(textures: TextureSet, rng: np.random.Generator, rim: int) -> list[VehicleModel]:
    models: list[VehicleModel] = []
    for shape in BUS_SHAPES:
        details = bus_meshes(textures, shape, rng, rim)
        models.append(_model(f"{shape.style}-0", "bus", details, shape.axles_m, _HEAVY_PAINTS))
    for shape in TRUCK_SHAPES:
        details = truck_meshes(textures, shape, rng, rim)
        models.append(_model(f"{shape.style}-0", "truck", details, shape.axles_m, _HEAVY_PAINTS))
    return models


def _motorcycles(rng: np.random.Generator, rim: int) -> list[VehicleModel]:
    models: list[VehicleModel] = []
    for style in ("motorcycle", "scooter"):
        for rider in (True, False):
            look = int(rng.integers(1 << 16))
            details = tuple(
                motorcycle_mesh(rim, np.random.default_rng(look), detail, rider=rider, scooter=style == "scooter")
                for detail in range(DETAILS)
            )
            name = f"{style}-ridden" if rider else f"{style}-parked"
            models.append(_model(name, "motorcycle", details, (0.71, -0.71), _CAR_PAINTS, rider=rider))
    return models


def _model(
    name: str, category: Category, details: tuple[Mesh, ...], axles_m: tuple[float, ...], paints: tuple[Paint, ...],
    *, rider: bool = False,
) -> VehicleModel:  # fmt: skip
    """Moves the meshes so that their bounding box is centred and stands on the ground."""
    low, high = details[0].bounds_m
    middle = (low + high) / 2
    offset = -np.array([middle[0], middle[1], low[2]])
    moved = tuple(mesh.placed(offset) for mesh in details)
    length_m, width_m, height_m = (float(side) for side in high - low)
    front_m, rear_m = max(axles_m) + float(offset[0]), min(axles_m) + float(offset[0])
    return VehicleModel(name, category, (length_m, width_m, height_m), moved, front_m, rear_m, paints, rider)
