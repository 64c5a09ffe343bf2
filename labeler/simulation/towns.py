"""The kinds of town that can be generated: how wide their blocks are, how high and how dense they are built, how green
they are. A layout draws its numbers from one of these descriptions and from a seed."""

from dataclasses import dataclass

from labeler.simulation.errors import SimulationError


@dataclass(frozen=True)
class TownStyle:
    """What a town looks like. Pairs are (least, most); lengths in metres; shares between 0 and 1.

    ``blocks`` is the number of blocks along x and along y; ``block_m`` the distance between the centre lines of
    neighbouring streets. ``storeys`` counts the ground floor. ``facades`` names the facades that may appear
    (see ``labeler.simulation.facades``)."""

    name: str
    blocks: tuple[int, int]
    block_m: tuple[float, float]
    storeys: tuple[int, int]
    building_width_m: tuple[float, float]
    sidewalk_m: float
    front_garden_m: tuple[float, float]
    gap_share: float
    gap_m: tuple[float, float]
    gable_share: float
    facades: tuple[str, ...]
    tree_spacing_m: float
    tree_share: float
    parking_share: float


TOWNS: dict[str, TownStyle] = {
    style.name: style
    for style in (
        TownStyle(
            name="grid",
            blocks=(4, 4),
            block_m=(78.0, 128.0),
            storeys=(2, 8),
            building_width_m=(11.0, 26.0),
            sidewalk_m=3.6,
            front_garden_m=(0.0, 0.0),
            gap_share=0.18,
            gap_m=(2.0, 9.0),
            gable_share=0.15,
            facades=("brick", "plaster", "concrete", "glass", "stone"),
            tree_spacing_m=12.0,
            tree_share=0.65,
            parking_share=0.85,
        ),
        TownStyle(
            name="grid-small",
            blocks=(2, 2),
            block_m=(76.0, 96.0),
            storeys=(2, 5),
            building_width_m=(9.0, 18.0),
            sidewalk_m=3.2,
            front_garden_m=(0.0, 0.0),
            gap_share=0.25,
            gap_m=(2.0, 8.0),
            gable_share=0.3,
            facades=("brick", "plaster", "stone"),
            tree_spacing_m=11.0,
            tree_share=0.7,
            parking_share=0.85,
        ),
        TownStyle(
            name="avenues",
            blocks=(3, 3),
            block_m=(112.0, 168.0),
            storeys=(5, 14),
            building_width_m=(18.0, 38.0),
            sidewalk_m=5.5,
            front_garden_m=(0.0, 3.0),
            gap_share=0.22,
            gap_m=(4.0, 14.0),
            gable_share=0.0,
            facades=("glass", "concrete", "stone", "plaster"),
            tree_spacing_m=9.5,
            tree_share=0.9,
            parking_share=0.8,
        ),
        TownStyle(
            name="suburb",
            blocks=(3, 3),
            block_m=(84.0, 120.0),
            storeys=(1, 3),
            building_width_m=(9.0, 15.0),
            sidewalk_m=2.6,
            front_garden_m=(4.0, 7.0),
            gap_share=0.95,
            gap_m=(4.0, 11.0),
            gable_share=0.85,
            facades=("plaster", "brick"),
            tree_spacing_m=10.0,
            tree_share=0.75,
            parking_share=0.7,
        ),
    )
}


def town_style(name: str) -> TownStyle:
    """The town called ``name``. SimulationError names the towns there are when there is no such town."""
    style = TOWNS.get(name)
    if style is None:
        raise SimulationError(f"there is no town called {name!r}; choose one of {', '.join(sorted(TOWNS))}")
    return style
