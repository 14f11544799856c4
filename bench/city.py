"""``python -m bench.city``: what a team sends and holds beside its negotiation, up to a thousand robots.

Robots stand at one density on a square that grows, on a tree of links between near ones, and wander. Beacons
are passed on by the robots' own relays. Evidence is what one robot holds of all others, and takes in when
each of them has news.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import minimum_spanning_tree

from bench import command
from bench.table import figure, markdown
from vedette.agent import messages
from vedette.agent.effects import Send, TrafficKind
from vedette.agent.mates import Mates
from vedette.agent.messages import Beacon, Beacons
from vedette.agent.relay import Relay, nearby
from vedette.fusion import ReplicatedEvidence
from vedette.fusion.link import RESEND_AFTER
from vedette.kernels.tiles import CELLS, SIDE, TiledGrid, Tiling
from vedette.negotiation import Tree
from vedette.record.files import write_text

GROUND = 100.0  # m2 a robot
SIGHT, SPEED = 8.0, 0.5  # of every robot [m], [m/s]
PERIOD = 0.25  # of beacons [s]
SETTLING = 1.25  # until it is known who is where [s]
SPAN = 1.0  # that beacons are counted for: all go on once in it at least [s]
PATH = (40, 10, 80, 30, 120, 60, 160, 100)  # as beaconed: a few metres of way [cm]
TILES = 20  # of 3.2 m at 0.1 m, that each robot has seen: twice its ground
FRESH = 1  # of them that changes between two tellings
HELD = 3  # bytes a cell that a contributor has seen
HOP = 0.02  # that a message takes on a link [s]


@dataclass(frozen=True)
class CityRow:
    """What one robot of so many sends, holds and waits for."""

    robots: int
    plain: float  # beacons over a link, each at once and by itself, both ways [kB/s]
    thinned: float  # the same, as relays pass them on [kB/s]
    messages: float  # of these, over a link, both ways [1/s]
    held: float  # replicated evidence in one robot's memory [MB]
    news: float  # evidence over a link, each way, when everybody has news [kB]
    merging: float  # CPU to take that in [s]
    sweep: float  # time of one sweep over the tree [s]


@dataclass
class Beaconing:
    """Robots that beacon and pass on what they hear; links take no time."""

    tree: Tree
    near: float  # [m]
    mates: list[Mates] = field(init=False)
    relays: list[Relay] = field(init=False)
    messages: int = 0  # sent
    size: int = 0  # of them [B]

    def __post_init__(self) -> None:
        self.mates = [Mates(self.tree.n) for _ in range(self.tree.n)]
        self.relays = [Relay(self.near) for _ in range(self.tree.n)]

    def beacon(self, places: NDArray[np.float64], sequence: int, now: float) -> None:
        """Let everybody beacon from its place, ``(n, 2)`` [m], and pass on what it hears."""
        wave = []
        for robot, (x, y) in enumerate((100.0 * places).round().astype(int).tolist()):
            links = tuple(self.tree.neighbours(robot))
            self.relays[robot].look(self.mates[robot].all(), links, now)
            own = messages.encode(Beacon(robot, 1, sequence, x, y, 0, 0, 20, 50, PATH))
            wave += [(robot, Send(link, TrafficKind.BEACONS, own)) for link in links]
        while wave:
            for sender, send in wave:
                self.messages += 1
                self.size += len(send.payload)
                self._hear(send.to, sender, send.payload, now)
            wave = [(robot, send) for robot, relay in enumerate(self.relays) for send in relay.pass_on()]

    def _hear(self, robot: int, sender: int, payload: bytes, now: float) -> None:
        message = messages.decode(payload)
        for told in message.told if isinstance(message, Beacons) else [payload]:
            beacon = messages.decode_beacon(told)
            if beacon.robot != robot and self.mates[robot].hear(beacon, now, sender):
                self.relays[robot].hear(beacon.robot, told, sender, self.tree.neighbours(robot), now)


@click.command()
@command.robots_option("16,64,256,1024", least=2)
@command.out_option("the table")
def city(robots: tuple[int, ...], out: Path) -> None:
    """Measure beacons, replicated evidence and the time of a sweep as a team and its ground grow."""
    folder = command.results_folder(out)
    rows = []
    for n in robots:
        rows.append(city_row(n))
        click.echo(f"{n} robots: {rows[-1]}", err=True)
    text = city_table(rows)
    write_text(folder / "city.md", text)
    click.echo(text)


def city_row(n: int) -> CityRow:
    """Return what there is to say of a team of ``n``."""
    rng = np.random.default_rng(n)
    places = rng.uniform(0.0, (n * GROUND) ** 0.5, (n, 2))
    tree = tree_between_near(places)
    beaconing = Beaconing(tree, nearby(SIGHT, SPEED))
    headings = rng.uniform(0.0, 2.0 * np.pi, n)
    for sequence in range(round((SETTLING + SPAN) / PERIOD)):
        now = sequence * PERIOD
        if now == SETTLING:
            beaconing.messages = beaconing.size = 0
        beaconing.beacon(places, sequence, now)
        places += SPEED * PERIOD * np.column_stack((np.cos(headings), np.sin(headings)))
    one = len(messages.encode(Beacon(n, 1, 100, 10000, 10000, 3000, 0, 20, 50, PATH)))
    links = n - 1
    return CityRow(
        n,
        plain=n * one / PERIOD / 1e3,
        thinned=beaconing.size / SPAN / links / 1e3,
        messages=beaconing.messages / SPAN / links,
        **evidence_of(n, rng),
        sweep=2 * links * HOP,
    )


def tree_between_near(places: NDArray[np.float64]) -> Tree:
    """Return the tree of least total length over ``(n, 2)`` places [m]."""
    away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
    edges = minimum_spanning_tree(csr_array(away)).tocoo()
    return Tree.from_edges(zip(edges.row.tolist(), edges.col.tolist(), strict=True))


def evidence_of(n: int, rng: np.random.Generator) -> dict[str, float]:
    """Return what one robot holds of all ``n`` robots' evidence, and what news of each of them take.

    All tell robot 0, who tells robot 1.
    """
    across = int(np.ceil((n * TILES) ** 0.5))
    shape = across * SIDE, across * SIDE
    team = [ReplicatedEvidence(robot, 1, shape, 0) for robot in range(n)]
    grounds = [TiledGrid(Tiling(*shape), np.int8) for _ in team]
    teller, hearer = team[:2]
    teller.set_neighbours(range(1, n))
    for other in team[1:]:
        other.set_neighbours([0])
    for tiles, now in ((TILES, 0.0), (FRESH, 0.5 * RESEND_AFTER)):  # all they have seen by and by; then news
        for robot, (evidence, own) in enumerate(zip(team, grounds, strict=True)):
            own.write(robot * TILES + np.arange(tiles), _walls(rng, tiles))
            evidence.publish(own, None, None)
            if robot > 1:
                _tell_first(evidence, robot, teller, now)
        size, took = _exchange(teller, hearer, now)
    return {"held": n * TILES * CELLS * HELD / 1e6, "news": size / 1e3, "merging": took}


def _walls(rng: np.random.Generator, tiles: int) -> NDArray[np.int8]:
    """Return ``(tiles, 1024)`` log-odds of a wall across each tile, with free cells to one side of it."""
    cells = np.zeros((tiles, SIDE, SIDE), np.int8)
    for tile, (row, width) in zip(cells, rng.integers(1, SIDE, (tiles, 2)), strict=True):
        tile[row, :width] = 10
        tile[:row, :width] = -10
    return cells.reshape(tiles, -1)


def _tell_first(evidence: ReplicatedEvidence, robot: int, teller: ReplicatedEvidence, now: float) -> None:
    """Let a robot tell robot 0 all that it has to; it hears nothing but the greeting that it waits for."""
    if now == 0.0:
        greeting = teller.outgoing(robot, now)
        assert greeting is not None
        evidence.receive(0, greeting, now)
    told = evidence.outgoing(0, now)  # None: its tile has come out as it was
    if told is not None:
        teller.receive(robot, told, now)


def _exchange(teller: ReplicatedEvidence, hearer: ReplicatedEvidence, now: float) -> tuple[int, float]:
    """Let robots 0 and 1 tell each other all; return the bytes to 1, and its CPU time to take them in [s]."""
    size, took, quiet = 0, 0.0, 0
    while quiet < 2:
        quiet = 0
        for sender, name, receiver, to in ((teller, 0, hearer, 1), (hearer, 1, teller, 0)):
            payload = sender.outgoing(to, now)
            if payload is None:
                quiet += 1
                continue
            began = time.process_time()
            receiver.receive(name, payload, now)
            if receiver is hearer:
                size, took = size + len(payload), took + time.process_time() - began
    return size, took


def city_table(rows: Sequence[CityRow]) -> str:
    """Return a line a team."""
    header = (
        "robots", "beacons one by one [kB/s a link]", "as relayed [kB/s]", "messages [1/s]",
        "evidence held [MB]", "news of all [kB a link]", "to take in [s]", "a sweep [s]",
    )  # fmt: skip
    cells = [
        (
            str(row.robots),
            *map(figure, (row.plain, row.thinned, row.messages, row.held, row.news, row.merging, row.sweep)),
        )
        for row in rows
    ]
    return markdown(header, cells, "r" * len(header))


if __name__ == "__main__":
    command.run(city, "bench.city")
