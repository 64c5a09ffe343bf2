"""A town's numbers: where things stand, and what must never overlap."""

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.geometry.boxes_3d import corners_of
from labeler.simulation.blocks import Rectangle
from labeler.simulation.dimensions import BAY_DEPTH_M, HALF_CARRIAGEWAY_M, LANE_WIDTH_M, STOP_LINE_M
from labeler.simulation.errors import SimulationError
from labeler.simulation.layout import ParkingSlot, TownLayout
from labeler.simulation.towns import TOWNS

TOWN_NAMES = sorted(TOWNS)


def footprint(slot: ParkingSlot) -> Rectangle:
    size = np.array([[slot.length_m, slot.width_m, 1.0]])
    corners = corners_of(np.array([[slot.x_m, slot.y_m, 0.0]]), size, np.array([slot.yaw_rad]))[0, :, :2]
    low, high = np.round(corners.min(axis=0), 6), np.round(corners.max(axis=0), 6)
    return Rectangle(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def street_rectangles(layout: TownLayout) -> list[Rectangle]:
    half_m = HALF_CARRIAGEWAY_M
    west, east, south, north = (float(line) for line in (layout.x_m[0], layout.x_m[-1], layout.y_m[0], layout.y_m[-1]))
    columns = [Rectangle(float(x) - half_m, south - half_m, float(x) + half_m, north + half_m) for x in layout.x_m]
    rows = [Rectangle(west - half_m, float(y) - half_m, east + half_m, float(y) + half_m) for y in layout.y_m]
    return columns + rows


@pytest.fixture(scope="module", params=TOWN_NAMES)
def layout(request: pytest.FixtureRequest) -> TownLayout:
    return TownLayout.generate(5, town=request.param)


def test_the_smallest_town_by_hand() -> None:
    layout = TownLayout.generate(0, town="grid-small", blocks=(1, 1))

    assert layout.junctions[0, 0].x_m == 0.0
    assert layout.junctions[0, 0].y_m == 0.0
    # four bends; every street in both directions
    assert sorted(layout.junctions) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert len(layout.edges) == 8
    assert [junction.signalised for junction in layout.junctions.values()] == [False] * 4
    assert layout.signals == ()
    assert layout.crossings == ()
    assert len(layout.blocks) == 1 + 4


@pytest.mark.parametrize(
    ("junction", "approaches"),
    [
        ((0, 0), (2, 3)),  # the south-west bend: traffic comes in heading west and south
        ((1, 0), (0, 2, 3)),  # on the southern edge nobody comes from the south
        ((0, 1), (1, 2, 3)),  # on the western edge nobody comes from the west
        ((1, 1), (0, 1, 2, 3)),  # the middle
        ((2, 2), (0, 1)),  # the north-east bend
    ],
)
def test_approaches_of_a_junction(junction: tuple[int, int], approaches: tuple[int, ...]) -> None:
    layout = TownLayout.generate(1, blocks=(2, 2))

    assert layout.junctions[junction].approaches == approaches
    served = tuple(signal.approach for signal in layout.signals if signal.junction_id == junction)
    assert served == (approaches if len(approaches) >= 3 else ())


@pytest.mark.parametrize(
    ("approach", "start", "end"),
    [
        (0, (STOP_LINE_M, -5.25), (-STOP_LINE_M, -5.25)),  # eastwards: the right lane lies to the south
        (1, (5.25, STOP_LINE_M), (5.25, -STOP_LINE_M)),  # northwards: to the east
        (2, (-STOP_LINE_M, 5.25), (STOP_LINE_M, 5.25)),  # westwards: to the north
        (3, (-5.25, -STOP_LINE_M), (-5.25, STOP_LINE_M)),  # southwards: to the west
    ],
)
def test_the_right_lane_runs_between_the_stop_lines(
    approach: int, start: tuple[float, float], end: tuple[float, float]
) -> None:
    layout = TownLayout.generate(2, blocks=(2, 2))
    edge = next(e for e in layout.edges if e.approach == approach and e.end.junction_id == (1, 1))

    line = edge.lane_center_m(0)

    np.testing.assert_allclose(line[0] - (edge.start.x_m, edge.start.y_m), start)
    np.testing.assert_allclose(line[1] - (edge.end.x_m, edge.end.y_m), end)
    np.testing.assert_allclose(np.abs(edge.lane_center_m(1) - line).max(), LANE_WIDTH_M)


def test_a_lane_that_does_not_exist() -> None:
    with pytest.raises(ValueError, match="lane 2 does not exist"):
        TownLayout.generate(0).edges[0].lane_center_m(2)


def test_every_signal_faces_its_approach(layout: TownLayout) -> None:
    assert layout.signals
    for signal in layout.signals:
        junction = layout.junctions[signal.junction_id]
        heading = np.array([math.cos(signal.heading_rad), math.sin(signal.heading_rad)])
        right = np.array([heading[1], -heading[0]])
        to_stop = np.array(signal.stop_line_m) - (junction.x_m, junction.y_m)
        to_pole = np.array([signal.x_m, signal.y_m]) - (junction.x_m, junction.y_m)
        assert to_stop @ heading == pytest.approx(-STOP_LINE_M)
        assert to_stop @ right == pytest.approx(LANE_WIDTH_M)  # the middle of two lanes
        # the pole stands on the far right corner, off the carriageway
        assert to_pole @ heading > HALF_CARRIAGEWAY_M
        assert to_pole @ right > HALF_CARRIAGEWAY_M
        for x_m, y_m, green_m in signal.heads_m:
            ahead = (np.array([x_m, y_m]) - signal.stop_line_m) @ heading
            assert ahead > STOP_LINE_M
            assert green_m > 2.2


def test_each_approach_has_one_signal_and_poles_stand_apart(layout: TownLayout) -> None:
    served = [(signal.junction_id, signal.approach) for signal in layout.signals]
    places = {(signal.x_m, signal.y_m) for signal in layout.signals}

    assert len(set(served)) == len(served)
    assert len(places) == len(layout.signals)


def test_no_building_stands_on_a_street_a_bay_or_another_building(layout: TownLayout) -> None:
    streets = street_rectangles(layout) + list(layout.bays)
    for building in layout.buildings:
        assert not any(building.area.overlaps(street) for street in streets)
    for one, other in combinations(layout.buildings, 2):
        assert not one.area.overlaps(other.area)


def test_sidewalks_are_free_of_buildings(layout: TownLayout) -> None:
    for bay in layout.bays:
        grown = Rectangle(bay.x0_m - 2.5, bay.y0_m - 2.5, bay.x1_m + 2.5, bay.y1_m + 2.5)
        assert not any(building.area.overlaps(grown) for building in layout.buildings)


def test_parking_slots_lie_in_bays_beside_the_lanes_and_apart(layout: TownLayout) -> None:
    streets = street_rectangles(layout)
    footprints = [footprint(slot) for slot in layout.slots]
    assert footprints
    for area in footprints:
        assert not any(area.overlaps(street) for street in streets)
        assert any(
            bay.x0_m <= area.x0_m + 1e-6 and bay.y0_m <= area.y0_m + 1e-6
            and area.x1_m <= bay.x1_m + 1e-6 and area.y1_m <= bay.y1_m + 1e-6
            for bay in layout.bays
        )  # fmt: skip
    for one, other in combinations(footprints, 2):
        assert not one.overlaps(other)


def test_parked_cars_look_along_the_lane_beside_them(layout: TownLayout) -> None:
    for slot in layout.slots:
        heading = np.array([math.cos(slot.yaw_rad), math.sin(slot.yaw_rad)])
        left = np.array([-heading[1], heading[0]])
        beside = np.array([[slot.x_m, slot.y_m]]) + left * (BAY_DEPTH_M / 2 + 2.0)
        assert layout.on_carriageway(beside)[0]
        assert not layout.on_carriageway(np.array([[slot.x_m, slot.y_m]]))[0]


def test_trees_and_lamps_stand_off_streets_and_bays(layout: TownLayout) -> None:
    places = np.array([(thing.x_m, thing.y_m) for thing in (*layout.trees, *layout.lamps, *layout.furniture)])
    assert not layout.on_carriageway(places).any()
    for bay in layout.bays:
        inside = (places > (bay.x0_m, bay.y0_m)) & (places < (bay.x1_m, bay.y1_m))
        assert not inside.all(axis=1).any()


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0.0, 0.0), True),  # a junction
        ((0.0, HALF_CARRIAGEWAY_M + 20.0), True),  # between junctions
        ((HALF_CARRIAGEWAY_M - 0.1, 40.0), True),  # just inside of the kerb
        ((HALF_CARRIAGEWAY_M + 0.1, 40.0), False),  # just outside
        ((-HALF_CARRIAGEWAY_M - 0.1, 0.0), False),  # beyond the town's first street
    ],
)
def test_on_carriageway(point: tuple[float, float], expected: bool) -> None:
    layout = TownLayout.generate(3, blocks=(1, 1))

    assert bool(layout.on_carriageway(np.array([point]))[0]) is expected


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**31), town=st.sampled_from(TOWN_NAMES))
def test_the_same_seed_gives_the_same_town(seed: int, town: str) -> None:
    one, other = (TownLayout.generate(seed, town=town, blocks=(1, 2)) for _ in range(2))

    assert one.buildings == other.buildings
    assert one.slots == other.slots
    assert one.trees == other.trees
    assert (np.diff(one.x_m) >= TOWNS[town].block_m[0] - 0.5).all()


def test_seeds_differ() -> None:
    assert TownLayout.generate(1).buildings != TownLayout.generate(2).buildings


@pytest.mark.parametrize(
    ("seed", "town", "blocks", "message"),
    [
        (0, "atlantis", None, "no town called 'atlantis'; choose one of avenues, grid, grid-small, suburb"),
        (-1, "grid", None, "seed -1"),
        (0, "grid", (0, 3), "0 x 3"),
    ],
)
def test_what_makes_no_town(seed: int, town: str, blocks: tuple[int, int] | None, message: str) -> None:
    with pytest.raises(SimulationError, match=message):
        TownLayout.generate(seed, town=town, blocks=blocks)
