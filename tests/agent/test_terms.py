"""Links open with a handshake: who plans for something else is refused, and both say in what they differ."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from tests.support.agent_team import toy_team
from vedette import Tree
from vedette.agent import NetworkedAgent
from vedette.agent.acquaintance import Acquaintance
from vedette.agent.networked import HELLO, Datagram
from vedette.agent.terms import Introduction, Terms, difference, encode, fingerprint_of, flat
from vedette.fusion.trust import APART
from vedette.maps import GridFrame
from vedette.maps.area import MOST_CORNERS, Area
from vedette.maps.lattice import Lattice
from vedette.missions.explore.assemble import terms_of
from vedette.missions.explore.options import ExploreOptions

TERMS = {"mission": "explore", "map.resolution": "0.1", "scheme": "token"}


def pair(theirs: Terms, ours: Terms = TERMS, apart: float = 0.0) -> list[NetworkedAgent]:
    """Two robots that reach each other, after ten seconds; the second has ``theirs``, and such a clock."""
    team, _, _ = toy_team(Tree.chain(2))
    nodes = [
        NetworkedAgent(team.agents[0], 0.0, terms=ours),
        NetworkedAgent(team.agents[1], 0.0, terms=theirs, time_of_day=lambda now: now + apart),
    ]
    for i in (0, 1):
        nodes[i].peers([1 - i], 0.0)
    for step in range(1000):
        now = 0.01 * step
        for i in (0, 1):
            for output in nodes[i].step((), now):
                deliver(nodes, i, output, now)
    return nodes


def deliver(nodes: list[NetworkedAgent], sender: int, output: object, now: float) -> None:
    """Let a datagram arrive at once, and all that it brings about."""
    if isinstance(output, Datagram):
        for answer in nodes[output.to].hear(sender, output.payload, now):
            deliver(nodes, output.to, answer, now)


def test_robots_that_agree_use_their_link_and_complain_of_nothing() -> None:
    for node in pair(dict(reversed(TERMS.items()))):
        assert node.overlay.place.size == 2
        assert node.complaints == {}


@pytest.mark.parametrize("name", TERMS)
def test_a_difference_refuses_the_link_and_both_name_field_and_values(name: str) -> None:
    here, there = pair(TERMS | {name: "other"})
    assert here.overlay.place.neighbours == there.overlay.place.neighbours == ()
    assert here.complaints == {1: f"its link is refused: {name}: other there, {TERMS[name]} here"}
    assert there.complaints == {0: f"its link is refused: {name}: {TERMS[name]} there, other here"}


YARD = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0))


@pytest.mark.parametrize(
    ("area", "said"),
    [
        (None, "area.corners.1.1: 0.0 there, nothing here"),
        (((0.0, 0.0), (4.0, 0.0), (4.0, 4.5)), "area.corners.3.2: 4.0 there, 4.5 here"),
        ((*YARD, (0.0, 4.0)), "area.corners.4.1: nothing there, 0.0 here"),
    ],
)
def test_robots_whose_areas_differ_in_one_corner_refuse_each_other_and_say_which(
    area: tuple[tuple[float, float], ...] | None, said: str
) -> None:
    """On one lattice or two: where the areas' boxes differ, so do the lattices."""
    frame = GridFrame(0.1, 60, 60)
    terms = [
        terms_of(Lattice(frame, None if corners is None else Area.of(corners)), ExploreOptions())
        for corners in (YARD, area)
    ]
    here, there = pair(terms[0], terms[1])
    assert here.overlay.place.neighbours == there.overlay.place.neighbours == ()
    assert here.complaints == {1: f"its link is refused: {said}"}
    (complaint,) = there.complaints.values()
    assert complaint.startswith(f"its link is refused: {said.partition(':')[0]}: ")
    same = pair(terms[0], dict(terms[0]))
    assert same[0].overlay.place.size == 2
    open_ground = terms_of(Lattice.open(0.1), ExploreOptions())
    assert fingerprint_of(open_ground) != fingerprint_of(terms[0])
    assert difference(open_ground, terms[0]) is not None


def test_an_area_of_as_many_corners_as_there_may_be_opens_a_link() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, MOST_CORNERS, endpoint=False)
    circle = 1e3 * np.pi * np.column_stack((np.cos(angles), np.sin(angles)))
    terms = terms_of(Lattice(GridFrame(0.1, 60, 60), Area.of(circle.tolist())), ExploreOptions())
    circle[500, 1] += 0.25
    other = terms_of(Lattice(GridFrame(0.1, 60, 60), Area.of(circle.tolist())), ExploreOptions())
    assert pair(terms, terms)[0].overlay.place.size == 2
    here, _ = pair(terms, other)
    assert here.overlay.place.size == 1
    assert "its link is refused: area.corners.501.2: " in here.complaints[1]


def test_clocks_that_are_apart_are_told_and_do_no_harm() -> None:
    here, there = pair(TERMS, apart=3.0)
    assert here.overlay.place.size == 2
    assert here.complaints == {1: "its clock is +3.0 s from this robot's"}
    assert there.complaints == {0: "its clock is -3.0 s from this robot's"}
    assert pair(TERMS, apart=0.9)[0].complaints == {}


def test_clocks_more_than_a_minute_apart_are_told_to_keep_evidence_from_being_compared() -> None:
    """A minute of the mission's time: at five times real time, twelve seconds of the clocks'."""
    for tempo, apart, much in ((1.0, 59.0, False), (1.0, 61.0, True), (5.0, 11.0, False), (5.0, 13.0, True)):
        known = Acquaintance(TERMS, lambda now: now, APART / 10.0 / tempo)
        known.hear(1, encode(Introduction(7, False, round(1000.0 * apart), dict(TERMS))), 5, 0.0)
        assert ("compared with nobody's" in known.warnings[1]) == much


def test_an_introduction_that_comes_again_late_puts_no_clock_back() -> None:
    known = Acquaintance(TERMS, lambda now: now)
    told = encode(Introduction(7, False, 10_000, dict(TERMS)))
    known.hear(1, told, 1, 10.0)
    known.hear(1, told, 1, 15.0)
    assert known.warnings == {}
    known.hear(1, encode(Introduction(8, False, 12_000, dict(TERMS))), 1, 15.0)
    assert known.warnings == {1: "its clock is -3.0 s from this robot's"}
    known.hear(1, encode(Introduction(8, False, 16_000, dict(TERMS))), 1, 16.0)
    assert known.warnings == {}


def test_an_older_version_is_told_in_one_line() -> None:
    here, there = pair(TERMS)
    (hello,) = [out for out in there.leave(10.0) if out.payload.startswith(HELLO)]
    old = [1, *msgspec.msgpack.decode(hello.payload[1:])[1:]]
    here.hear(1, HELLO + msgspec.msgpack.encode(old), 10.0)
    assert here.complaints[1] == (
        "it speaks another version of the protocol (hello: version 1, not 7); update the older"
    )
    assert here.malformed == 1


def test_terms_are_told_field_by_field() -> None:
    fields = dict(flat("map", GridFrame(0.1, 40, 30)))
    assert fields["map.resolution"] == "0.1"
    assert fields["map.rows"] == "40"
    assert dict(flat("v", [{"a": None}, 2])) == {"v.1.a": "none", "v.2": "2"}
    assert difference({"a": "1"}, {"a": "1", "b": "2"}) == "b: nothing there, 2 here"
    assert difference({"c": "1"}, {}) == "c: 1 there, nothing here"
    assert fingerprint_of({"a": "1", "b": "2"}) == fingerprint_of({"b": "2", "a": "1"}) < 2**63
