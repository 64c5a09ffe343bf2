"""What surfaces are made of: how a LiDAR's beam comes back from them, and how the renderer shades them."""

from enum import IntEnum


class Material(IntEnum):
    """What a triangle is made of, as a LiDAR sees it."""

    ASPHALT = 0
    MARKING = 1
    PAVING = 2
    GRASS = 3
    WALL = 4
    GLASS = 5
    METAL = 6
    PAINT = 7
    RUBBER = 8
    PLASTIC = 9
    FOLIAGE = 10
    WOOD = 11


REFLECTIVITY: dict[Material, float] = {
    Material.ASPHALT: 0.10,
    Material.MARKING: 0.55,
    Material.PAVING: 0.28,
    Material.GRASS: 0.35,
    Material.WALL: 0.40,
    Material.GLASS: 0.06,
    Material.METAL: 0.50,
    Material.PAINT: 0.45,
    Material.RUBBER: 0.04,
    Material.PLASTIC: 0.12,
    Material.FOLIAGE: 0.42,
    Material.WOOD: 0.25,
}
"""The share of near-infrared light (905 nm) that comes back diffusely: plausible round figures for the usual
materials, not measurements."""


class Semantic(IntEnum):
    """What a pixel shows: the classes of semantic segmentation."""

    OTHER = 0
    ROAD = 1
    BUILDING = 2
    VEGETATION = 3
    VEHICLE = 4


SEMANTIC_OF: dict[Material, Semantic] = {
    Material.ASPHALT: Semantic.ROAD,
    Material.MARKING: Semantic.ROAD,
    Material.GRASS: Semantic.VEGETATION,
    Material.WALL: Semantic.BUILDING,
    Material.FOLIAGE: Semantic.VEGETATION,
    Material.WOOD: Semantic.VEGETATION,
}
"""What is made of a material, where its surface does not say otherwise; all that is not named is other. What belongs
to a vehicle is vehicle, whatever it is made of."""


class Shading(IntEnum):
    """How the renderer colours a vertex's surface."""

    PLAIN = 0
    """Its own colour; where its paint share is above 0 times the instance's paint."""
    CUTOUT = 1
    """A texture with holes, as leaves have."""
    BODY = 2
    """A texture whose alpha is the share of the instance's paint."""
    FACADE = 3
    """A texture that covers, with windows that reflect."""
    LIGHT = 4
    """A lamp that shines in the instance's paint colour."""
    ASPHALT = 5
    MARKING = 6
    PAVING = 7
    GRASS = 8
