"""Real SUMO on the smallest town."""

import math
import xml.etree.ElementTree as ET

import pytest

from labeler.simulation.layout import Approach, TownLayout
from labeler.simulation.road_network import RoadNetwork, SignalProgram, build_road_network

pytest.importorskip("sumo", reason="needs eclipse-sumo, of the extra `simulation`")

LAYOUT = TownLayout.generate(3, town="grid-small")


@pytest.fixture(scope="module")
def network(tmp_path_factory: pytest.TempPathFactory) -> RoadNetwork:
    return build_road_network(LAYOUT, tmp_path_factory.mktemp("network"))


def test_each_edge_leads_on_to_all_streets_but_the_one_it_came_from(network: RoadNetwork) -> None:
    for edge in LAYOUT.edges:
        expected = {other.name for other in LAYOUT.edges if other.start == edge.end and other.end != edge.start}
        assert set(network.following[edge.name]) == expected


def test_lanes_lie_and_end_where_the_town_draws_them(network: RoadNetwork) -> None:
    drawn = {edge.name: edge for edge in LAYOUT.edges}
    lanes = [lane for edge in ET.parse(network.file).getroot().findall("edge") for lane in edge]
    checked = 0
    for lane in lanes:
        name, _, number = lane.get("id", "").rpartition("_")
        if name not in drawn:
            continue
        last = [float(value) for value in lane.get("shape", "").split()[-1].split(",")]
        center_m = drawn[name].lane_center_m(int(number))[1]
        off_m = math.dist(last, center_m)
        # the lane goes on in the same line: over the crossing, or up to the bend
        reach_m = 8.5 if drawn[name].end.signalised else 7.0
        assert off_m == pytest.approx(12.3 - reach_m, abs=0.01)
        checked += 1
    assert checked == 2 * len(LAYOUT.edges)
    offsets = [
        offset for edge in ET.parse(network.file).getroot().findall("edge") for offset in edge.iter("stopOffset")
    ]
    assert {offset.get("value") for offset in offsets} == {"4.000"}  # to 12.5 m from the middle, where the line begins
    assert len(offsets) == len(LAYOUT.edges)


def test_every_signal_has_a_program_in_which_crossing_streets_are_never_open_at_once(network: RoadNetwork) -> None:
    signals = {(signal.junction_id, signal.approach) for signal in LAYOUT.signals}
    assert {(one.junction_id, approach) for one in network.programs for approach in one.lamps} == signals
    for program in network.programs:
        assert len({len(lamps) for lamps in program.lamps.values()} | {len(program.ends_s)}) == 1
        for phase in range(len(program.ends_s)):
            open_axes = {approach % 2 for approach, lamps in program.lamps.items() if lamps[phase] != "red"}
            assert len(open_axes) <= 1
        for lamps in program.lamps.values():
            assert {"red", "yellow", "green"} == set(lamps)


def test_no_link_may_go_while_its_lamp_is_red(network: RoadNetwork) -> None:
    approach_of: dict[str, Approach] = {edge.name: edge.approach for edge in LAYOUT.edges}
    junction_of = {junction.name: junction.junction_id for junction in LAYOUT.junctions.values()}
    states = {
        logic.get("id", ""): [phase.get("state", "") for phase in logic.findall("phase")]
        for logic in ET.parse(network.signals_file).getroot().findall("tlLogic")
    }
    programs = {program.junction_id: program for program in network.programs}
    links = 0
    for connection in ET.parse(network.file).getroot().findall("connection"):
        signal = connection.get("tl")
        if signal is None:
            continue
        lamps = programs[junction_of[signal]].lamps[approach_of[connection.get("from", "")]]
        for state, lamp in zip(states[signal], lamps, strict=True):
            link = state[int(connection.get("linkIndex", "-1"))]
            assert lamp == "green" or link not in "Gg"
        links += 1
    assert links > 20


@pytest.mark.parametrize(
    ("time_s", "lamp"),
    [
        (0.0, "green"),
        (9.9, "green"),
        (10.0, "yellow"),  # a phase begins at its very second
        (13.0, "red"),
        (29.9, "red"),
        (30.0, "green"),  # the cycle begins anew
        (71.0, "yellow"),
    ],
)
def test_lamp_at(time_s: float, lamp: str) -> None:
    program = SignalProgram((0, 0), (10.0, 13.0, 30.0), {0: ("green", "yellow", "red")})
    assert program.lamp_at(0, time_s) == lamp
