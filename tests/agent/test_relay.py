"""Beacons passed on over a tree: at once to whoever is near, now and then to everybody, in batches."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.agent import messages
from vedette.agent.effects import Send, TrafficKind
from vedette.agent.intents import HORIZON
from vedette.agent.mates import SILENT, Mates
from vedette.agent.messages import MOST_TOLD, Beacon, Beacons
from vedette.agent.relay import AFAR, EARLY, Relay, nearby
from vedette.negotiation import Tree

PERIOD = 0.3  # of beacons, as ticks of 0.1 s make it [s]
SIGHT, SPEED = 8.0, 0.5  # [m], [m/s]


def beacon(robot: int, sequence: int, x: float, y: float) -> bytes:
    return messages.encode(Beacon(robot, 1, sequence, round(x * 100), round(y * 100), 0, 0, 20, 50, ()))


@dataclass
class Team:
    """Robots that do nothing but beacon, over a tree on which a message takes no time."""

    tree: Tree
    near: float = nearby(SIGHT, SPEED)
    mates: list[Mates] = field(init=False)
    relays: list[Relay] = field(init=False)
    sent: int = 0

    def __post_init__(self) -> None:
        self.mates = [Mates() for _ in range(self.tree.n)]
        self.relays = [Relay(self.near) for _ in range(self.tree.n)]

    def beacon(self, places: NDArray[np.float64], sequence: int, now: float) -> None:
        """Let everybody beacon, ``places`` ``(n, 2)`` [m], and pass on what it hears."""
        wave = []
        for robot, relay in enumerate(self.relays):
            links = tuple(self.tree.neighbours(robot))
            relay.look(self.mates[robot].all(), links, now)
            own = beacon(robot, sequence, *places[robot])
            wave += [(robot, Send(link, TrafficKind.BEACONS, own)) for link in links]
        while wave:
            self.sent += len(wave)
            for sender, send in wave:
                self._hear(send.to, sender, send.payload, now)
            wave = [(robot, send) for robot, relay in enumerate(self.relays) for send in relay.pass_on()]

    def _hear(self, robot: int, sender: int, payload: bytes, now: float) -> None:
        message = messages.decode(payload)
        for told in message.told if isinstance(message, Beacons) else [payload]:
            each = messages.decode_beacon(told)
            if each.robot != robot and self.mates[robot].hear(each, now, sender):
                links = self.tree.neighbours(robot)
                self.relays[robot].hear(each.robot, told, sender, links, now)


@pytest.mark.parametrize("seed", range(5))
def test_who_is_near_is_always_told_the_newest_and_nobody_seems_silent(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 24
    team = Team(Tree.balanced(n))
    places = rng.uniform(0.0, 60.0, (n, 2))
    headings = rng.uniform(0.0, 2 * np.pi, n)
    were = []
    for sequence in range(80):
        now = sequence * PERIOD
        were.append(places.copy())
        team.beacon(places, sequence, now)
        away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
        for robot, mates in enumerate(team.mates):
            for mate in mates.all():
                place = np.round((mate.x, mate.y), 2)
                age = next(k for k, was in enumerate(were[::-1]) if (was[mate.robot].round(2) == place).all())
                near = away[robot, mate.robot] <= max(SIGHT, 2 * HORIZON)
                assert age == 0 if near else age * PERIOD < SILENT - PERIOD
        headings += rng.normal(0.0, 0.3, n)
        places += SPEED * PERIOD * np.column_stack((np.cos(headings), np.sin(headings)))
    everything = 2 * (n - 1) * n * 80 / 2  # each beacon over each link, one by one
    assert team.sent < everything / 3


def test_beacons_of_a_robot_afar_go_on_once_in_a_while() -> None:
    team = Team(Tree.chain(3))
    places = np.array(((0.0, 0.0), (30.0, 0.0), (60.0, 0.0)))
    heard = set()
    for sequence in range(41):
        team.beacon(places, sequence, sequence * PERIOD)
        heard.update(mate.heard for mate in team.mates[2].all() if mate.robot == 0)
    gaps = np.diff(sorted(heard))[4:]  # once it is known who is where
    assert (gaps >= AFAR - EARLY).all()
    assert (gaps < AFAR + PERIOD).all()


def test_without_a_bound_on_what_is_near_everything_goes_on_at_once() -> None:
    team = Team(Tree.chain(3), near=np.inf)
    for sequence in range(5):
        team.beacon(np.array(((0.0, 0.0), (500.0, 0.0), (9000.0, 0.0))), sequence, sequence * PERIOD)
        assert [mate.heard for mate in team.mates[2].all()] == [sequence * PERIOD] * 2


def test_many_beacons_are_one_message_each_as_it_was_sent() -> None:
    relay = Relay()
    told = [beacon(robot, 1, robot, 0.0) for robot in range(2, MOST_TOLD + 3)]
    for robot, each in enumerate(told, start=2):
        relay.hear(robot, each, 1, (1, 7), 0.0)
    sends = relay.pass_on()
    assert [send.to for send in sends] == [7, 7]
    first, last = (messages.decode(send.payload) for send in sends)
    assert isinstance(first, Beacons)
    assert list(first.told) == told[:MOST_TOLD]
    assert messages.encode(last) == told[MOST_TOLD]
    assert relay.pass_on() == []
