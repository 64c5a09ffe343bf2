"""The streets of a town as a SUMO network: written as plain XML, joined by netconvert, and read back.

SUMO works out which lane may turn where, who yields to whom, and the programs of the signals. One change is made to
these: SUMO lets traffic turn right while the lamp that everyone sees is red; here all links of an approach obey its one
lamp, so that nobody seems to run a red light.
"""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from labeler.simulation.dimensions import LANE_WIDTH_M, LANES_EACH_WAY, STOP_LINE_M, STOP_LINE_WIDTH_M
from labeler.simulation.layout import Approach, JunctionId, TownLayout
from labeler.simulation.sumo import run_sumo

SPEED_LIMIT_MPS = 13.9
_CYCLE_S = 44
_STRAIGHT, _BACK, _RIGHT = 0, 2, 3
"""Quarter turns to the left from one edge to the next."""
_CORNER_RADIUS_M = 1.5
"""Small, so that who turns right goes around the corner of the kerb and not over it."""
_JUNCTION_REACH_M = LANES_EACH_WAY * LANE_WIDTH_M + _CORNER_RADIUS_M

Lamp = Literal["red", "yellow", "green"]


@dataclass(frozen=True)
class SignalProgram:
    """The fixed program of one junction's signals, which starts anew after each cycle; it begins at time 0.

    ``ends_s`` are the times within the cycle at which the phases end; ``lamps`` says what each approach shows in each
    phase."""

    junction_id: JunctionId
    ends_s: tuple[float, ...]
    lamps: Mapping[Approach, tuple[Lamp, ...]]

    def lamp_at(self, approach: Approach, time_s: float) -> Lamp:
        """What the signal of an approach shows at a time of the simulation."""
        in_cycle_s = time_s % self.ends_s[-1]
        phase = next((k for k, end_s in enumerate(self.ends_s) if in_cycle_s < end_s - 1e-6), 0)
        return self.lamps[approach][phase]


@dataclass(frozen=True)
class RoadNetwork:
    """A network that SUMO can drive on. ``following`` names the edges that may follow each edge, in order of name;
    ``without_right_turns`` those that a long vehicle should take, which would cut the corner: all where none is left.
    ``signals_file`` holds the programs; SUMO has to load it beside the network."""

    file: Path
    signals_file: Path
    following: Mapping[str, tuple[str, ...]]
    without_right_turns: Mapping[str, tuple[str, ...]]
    programs: tuple[SignalProgram, ...]


def build_road_network(layout: TownLayout, folder: Path) -> RoadNetwork:
    """Write the network of ``layout`` into ``folder`` and read it back. SimulationError when SUMO can't make it."""
    nodes, edges, file = folder / "town.nod.xml", folder / "town.edg.xml", folder / "town.net.xml"
    connections = folder / "town.con.xml"
    _write_xml(connections, "connections", "connection", _connections(layout))
    _write_xml(nodes, "nodes", "node", [_node(layout, junction_id) for junction_id in layout.junctions])
    _write_xml(edges, "edges", "edge", [_edge(layout, index) for index in range(len(layout.edges))], _stop_at_line())
    run_sumo(
        "netconvert",
        {
            "node-files": str(nodes),
            "edge-files": str(edges),
            "connection-files": str(connections),
            "output-file": str(file),
            "offset.disable-normalization": "true",
            "no-turnarounds": "true",
            "tls.cycle.time": str(_CYCLE_S),
            "junctions.internal-link-detail": "16",
            "precision": "3",
        },
    )
    return _read_network(layout, file)


def _node(layout: TownLayout, junction_id: JunctionId) -> dict[str, str]:
    junction = layout.junctions[junction_id]
    return {
        "id": junction.name,
        "x": f"{junction.x_m:.3f}",
        "y": f"{junction.y_m:.3f}",
        "type": "traffic_light" if junction.signalised else "priority",
        "radius": str(_CORNER_RADIUS_M),
    }


def _edge(layout: TownLayout, index: int) -> dict[str, str]:
    edge = layout.edges[index]
    return {
        "id": edge.name,
        "from": edge.start.name,
        "to": edge.end.name,
        "numLanes": str(LANES_EACH_WAY),
        "width": str(LANE_WIDTH_M),
        "speed": str(SPEED_LIMIT_MPS),
        "spreadType": "right",
    }


def _connections(layout: TownLayout) -> list[dict[str, str]]:
    """Which lane leads to which. Who turns right takes the far lane, which keeps the body clear of the corner."""
    rows: list[dict[str, str]] = []
    for start in layout.edges:
        ways_on = {(edge.approach - start.approach) % 4: edge for edge in layout.edges if edge.start == start.end}
        for turn, end in sorted(ways_on.items()):
            if turn == _BACK:
                continue
            if turn == _RIGHT:
                lanes = [(0, 1)]
            elif turn == _STRAIGHT or (_STRAIGHT not in ways_on and _RIGHT not in ways_on):
                lanes = [(0, 0), (1, 1)]
            else:
                lanes = [(1, 1)]
            for from_lane, to_lane in lanes:
                row = {"from": start.name, "to": end.name, "fromLane": str(from_lane), "toLane": str(to_lane)}
                rows.append(row)
    return rows


def _stop_at_line() -> ET.Element:
    """Lanes reach up to the junction; vehicles wait before the stop line, ahead of the crossing."""
    return ET.Element("stopOffset", {"value": f"{STOP_LINE_M + STOP_LINE_WIDTH_M / 2 - _JUNCTION_REACH_M:.3f}"})


def _write_xml(file: Path, root: str, tag: str, rows: list[dict[str, str]], inside: ET.Element | None = None) -> None:
    tree = ET.Element(root)
    for row in rows:
        element = ET.SubElement(tree, tag, row)
        if inside is not None:
            element.append(inside)
    ET.ElementTree(tree).write(file, encoding="utf-8", xml_declaration=True)


def _read_network(layout: TownLayout, file: Path) -> RoadNetwork:
    root = ET.parse(file).getroot()
    edges = {edge.name: edge for edge in layout.edges}
    following: dict[str, set[str]] = {name: set() for name in edges}
    links: dict[str, dict[Approach, _Links]] = {}
    for connection in root.findall("connection"):
        start, end = connection.get("from", ""), connection.get("to", "")
        if start not in edges or end not in edges:
            continue
        following[start].add(end)
        signal = connection.get("tl")
        if signal is not None:
            of_approach = links.setdefault(signal, {}).setdefault(edges[start].approach, _Links([], []))
            of_approach.every.append(int(connection.get("linkIndex", "0")))
            if connection.get("dir") == "s":
                of_approach.straight.append(int(connection.get("linkIndex", "0")))
    logics = {logic.get("id", ""): logic for logic in root.findall("tlLogic")}
    junctions = {junction.name: junction.junction_id for junction in layout.junctions.values()}
    for name in links:
        _obey_one_lamp(logics[name], links[name])
    signals_file = file.with_name("town.add.xml")
    _write_signals(signals_file, [logics[name] for name in sorted(links)])
    return RoadNetwork(
        file=file,
        signals_file=signals_file,
        following={name: tuple(sorted(ends)) for name, ends in following.items()},
        without_right_turns={
            name: tuple(sorted(end for end in ends if (edges[end].approach - edges[name].approach) % 4 != _RIGHT))
            or tuple(sorted(ends))
            for name, ends in following.items()
        },
        programs=tuple(_program(junctions[name], logics[name], links[name]) for name in sorted(links)),
    )


@dataclass(frozen=True)
class _Links:
    """The links of one approach by their place in a signal's state: all of them, and those that lead straight on."""

    every: list[int]
    straight: list[int]

    def lamp(self, state: str) -> Lamp:
        """What the approach's head shows: the state of the way straight on, else the strictest of all."""
        shown = {state[link].lower() for link in self.straight or self.every}
        if "r" in shown:
            return "red"
        return "yellow" if "y" in shown else "green"


def _obey_one_lamp(logic: ET.Element, links: Mapping[Approach, _Links]) -> None:
    """Change the states of a program so that no link of an approach may go on while its lamp is red or yellow."""
    for phase in logic.findall("phase"):
        state = phase.get("state", "")
        changed = list(state)
        for of_approach in links.values():
            lamp = of_approach.lamp(state)
            for link in of_approach.every:
                if lamp == "red" or (lamp == "yellow" and changed[link] in "Gg"):
                    changed[link] = lamp[0]
        phase.set("state", "".join(changed))


def _write_signals(file: Path, logics: list[ET.Element]) -> None:
    tree = ET.Element("additional")
    for logic in logics:
        logic.set("programID", "one-lamp")
        tree.append(logic)
    ET.ElementTree(tree).write(file, encoding="utf-8", xml_declaration=True)


def _program(junction_id: JunctionId, logic: ET.Element, links: Mapping[Approach, _Links]) -> SignalProgram:
    phases = logic.findall("phase")
    ends_s: list[float] = []
    for phase in phases:
        ends_s.append((ends_s[-1] if ends_s else 0.0) + float(phase.get("duration", "0")))
    return SignalProgram(
        junction_id=junction_id,
        ends_s=tuple(ends_s),
        lamps={
            approach: tuple(of_approach.lamp(phase.get("state", "")) for phase in phases)
            for approach, of_approach in sorted(links.items())
        },
    )
