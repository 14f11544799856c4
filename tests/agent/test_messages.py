"""Whatever neighbours send never stops an agent: it is taken in, ignored, or dropped and counted."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.agent_team import Team, nested_kind, toy, toy_team
from vedette import Tree
from vedette.agent import messages
from vedette.agent.effects import TrafficKind
from vedette.agent.events import Message, Pose, Scan, Sensed
from vedette.agent.mates import MOST_MATES
from vedette.agent.messages import Beacon

BEACON = Beacon(1, 1, 1, 1100, 100, 0, 0, 20, 50, (0, 0, 100, 0))


def recorded() -> tuple[Team, list[bytes]]:
    """A team of three between two rounds, and all payloads that its middle robot was sent in the first."""
    team, _, _ = toy_team(Tree.chain(3))
    team.run_round()
    return team, [messages.encode(post.message) for post in team.log if post.to == 1]


@settings(deadline=None, max_examples=100)
@given(payload=st.binary(max_size=60))
def test_random_bytes_are_dropped_and_counted(payload: bytes) -> None:
    team, _, _ = toy_team(Tree.chain(2))
    team.tell(0, Message(1, payload))
    assert team.agents[0].dropped == 1


def test_every_truncation_of_every_message_is_dropped_and_counted() -> None:
    team, payloads = recorded()
    agent = team.agents[1]
    for payload in payloads:
        for size in range(len(payload)):
            before = agent.dropped
            team.tell(1, Message(0, payload[:size]))
            assert agent.dropped == before + 1
    assert agent.rounds.decisions == 1


@settings(deadline=None, max_examples=40)
@given(data=st.data())
def test_a_round_outlives_changed_repeated_and_reordered_messages(data: st.DataObject) -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run(data.draw(st.sampled_from([0.05, 0.16, 0.2, 0.25, 0.3, 0.4])))
    payloads = [(post.sender, messages.encode(post.message)) for post in team.log if post.to == 1]
    for _ in range(8):
        sender, payload = data.draw(st.sampled_from(payloads))
        if data.draw(st.booleans()):
            changed = bytearray(payload)
            changed[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
            payload = bytes(changed)
        team.tell(1, Message(sender, payload))
    before = team.decisions()
    team.run(10.0)
    assert all(now > then for now, then in zip(team.decisions(), before, strict=True))


json_like = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.binary(max_size=8),
    lambda inner: st.lists(inner, max_size=12),
    max_leaves=10,
)


@settings(deadline=None, max_examples=80)
@given(tag=st.integers(0, 9), fields=st.lists(json_like, max_size=11))
def test_fields_of_wrong_types_or_out_of_range_never_raise(tag: int, fields: list[object]) -> None:
    team, _, _ = toy_team(Tree.chain(2))
    team.run(0.3)
    team.tell(0, Message(1, msgspec.msgpack.encode([tag, *fields])))
    team.run(0.2)


@settings(deadline=None, max_examples=80)
@given(tag=st.integers(0, 5), fields=st.lists(json_like, max_size=4), at=st.sampled_from([0.05, 0.2, 0.3]))
def test_negotiation_of_wrong_types_or_out_of_range_never_raises(
    tag: int, fields: list[object], at: float
) -> None:
    team, _, _ = toy_team(Tree.chain(2))
    team.run(at)
    data = msgspec.msgpack.encode([tag, *fields])
    team.tell(0, Message(1, messages.encode(messages.Negotiate(*team.agents[0].rounds.stamp, data))))
    team.run(0.5)


def test_counts_as_large_as_the_wire_allows_never_raise() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run_until(lambda: any(nested_kind(post) == "Gather" for post in team.log))
    most = 2**64 - 1
    impact = np.ones(12).tobytes()
    tally = [most, most, 1.0, 1.0, most, 1.0]
    for sender in (0, 2):
        for message in ([0, impact, most, 1.0], [1, impact, tally], [4, [1.0, None, most, True, most], most]):
            data = msgspec.msgpack.encode(message)
            stamp = team.agents[1].rounds.stamp
            team.tell(1, Message(sender, messages.encode(messages.Negotiate(*stamp, data))))
    team.run(10.0)
    assert min(team.decisions()) >= 1


def test_a_malformed_negotiation_message_that_comes_early_does_not_stop_the_agent() -> None:
    team, _, _ = toy_team(Tree.star(3))
    root = team.agents[0]
    team.run_until(lambda: toy(root).prepared == 1)
    bad = messages.Negotiate(*root.rounds.stamp, b"nonsense")
    out_of_place = messages.Negotiate(*root.rounds.stamp, msgspec.msgpack.encode([3, None]))
    for message in (bad, out_of_place):
        team.tell(0, Message(1, messages.encode(message)))
    assert root.dropped == 0
    team.run(2.0)
    assert root.dropped == 2
    assert min(team.decisions()) >= 1


def test_a_robot_that_is_no_neighbour_is_ignored() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run_round()
    agent = team.agents[0]
    before = len(team.log), agent.rounds.stamp, len(agent.mates.all())
    for message in (
        BEACON,
        messages.Call(1),
        messages.Begin(1, 99, 1),
        messages.Freeze(1, 99, 0, 0, 2),
        messages.Evidence(b"x"),
    ):
        team.tell(0, Message(2, messages.encode(message)))
    assert agent.dropped == 0
    assert agent.rounds.stamp == before[1]
    assert [p for p in team.log[before[0] :] if p.traffic is not TrafficKind.BEACONS and p.sender == 0] == []


@pytest.mark.parametrize("message", [messages.Begin(1, 99, 1), messages.Freeze(1, 1, 0, 0, 2)])
def test_only_the_parent_begins_and_freezes_a_round(message: messages.Wire) -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run_round()
    for child, parent in ((1, 0), (2, 1)):
        stamp = team.agents[parent].rounds.stamp
        team.tell(parent, Message(child, messages.encode(message)))
        assert team.agents[parent].rounds.stamp == stamp
    team.run(6.0)
    assert min(team.decisions()) >= 2


def test_a_repeated_freeze_does_not_change_the_belief_of_the_round() -> None:
    team, _, _ = toy_team(Tree.chain(2))
    child = team.agents[1]
    team.run_until(lambda: toy(child).prepared == 1)
    before = child.rounds.round
    assert before is not None
    belief = before.belief
    toy(child).belief = belief + 1.0
    team.tell(1, Message(0, messages.encode(messages.Freeze(*child.rounds.stamp, 0, 12345, 2))))
    assert child.rounds.round is before
    assert before.belief is belief
    assert toy(child).prepared == 1


@pytest.mark.parametrize(
    "change",
    [
        {"path": (0, 10**6)},
        {"path": (0,) * 5000},
        {"radius": 0},
        {"speed": 0},
        {"x": 2**40},
        {"robot": -1},
        {"slowed": -1},
        {"sequence": -5},
    ],
)
def test_a_beacon_out_of_range_is_dropped(change: dict[str, int]) -> None:
    team, _, _ = toy_team(Tree.chain(2))
    team.tell(0, Message(1, messages.encode(msgspec.structs.replace(BEACON, **change))))
    assert team.agents[0].dropped == 1
    assert team.agents[0].mates.all() == []


def test_a_beacon_tells_where_a_mate_is_how_large_and_where_it_goes() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run(0.5)
    mates = team.agents[0].mates.all()
    assert [(mate.robot, mate.x, mate.y, mate.radius, mate.speed) for mate in mates] == [
        (1, 11.0, 1.0, 0.2, 0.5),
        (2, 21.0, 1.0, 0.2, 0.5),
    ]


def test_an_older_beacon_that_a_mate_passes_on_is_no_news_and_goes_no_farther() -> None:
    team, _, _ = toy_team(Tree.chain(4))
    newer = msgspec.structs.replace(BEACON, robot=0, sequence=1000, x=7)
    older = msgspec.structs.replace(BEACON, robot=0, sequence=999, x=9)
    for beacon in (newer, older, newer):
        team.tell(2, Message(1, messages.encode(beacon)))
    passed_on = [post.message for post in team.log if post.sender == 2 and post.to == 3]
    assert passed_on == [newer]
    assert team.agents[2].mates.all()[0].x == 0.07


def test_a_robot_maps_only_when_its_mates_have_been_heard_or_after_a_while() -> None:
    scan = Scan(np.zeros(1), np.ones(1))
    heard, _, _ = toy_team(Tree.chain(2))
    heard.tell(0, Pose(1.0, 1.0, 0.0), scan)
    assert toy(heard.agents[0]).observed == 0
    heard.run(0.3)
    assert toy(heard.agents[0]).observed == 1  # the held scan
    deaf, _, _ = toy_team(Tree.chain(2), lose=lambda post: post.traffic is TrafficKind.BEACONS)
    for _ in range(40):
        deaf.tell(0, Pose(1.0, 1.0, 0.0), scan)
        deaf.run(0.1)
    assert 5 <= toy(deaf.agents[0]).observed <= 15


def test_what_any_other_sensor_saw_reaches_the_mission_as_a_scan_does() -> None:
    team, _, _ = toy_team(Tree.chain(1))
    agent = team.agents[0]
    team.tell(0, Sensed("too early, for no pose has come", 0.0))
    assert toy(agent).observed == 0
    team.run(0.2)
    before = toy(agent).observed
    team.tell(0, Sensed("something", team.now))
    assert toy(agent).observed == before + 1


def test_team_mates_beyond_the_largest_team_are_dropped_and_counted_and_those_known_stay_up_to_date() -> None:
    team, _, _ = toy_team(Tree.chain(2))
    agent = team.agents[0]
    for robot in range(1, MOST_MATES + 11):
        team.tell(0, Message(1, messages.encode(msgspec.structs.replace(BEACON, robot=robot))))
    assert agent.dropped == 11  # a team has robots 0 to 1023
    assert [mate.robot for mate in agent.mates.all()] == list(range(1, MOST_MATES))
    team.tell(0, Message(1, messages.encode(msgspec.structs.replace(BEACON, sequence=2, x=1500))))
    assert agent.dropped == 11
    assert agent.mates.all()[0].x == 15.0
