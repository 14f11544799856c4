"""What signing costs: the same team with and without keys, in bytes by kind and in CPU time."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click
import numpy as np

from bench import command
from bench.large.__main__ import world_of
from bench.table import markdown
from vedette.agent import Agent
from vedette.agent.effects import TrafficKind
from vedette.fusion.merkle import Merkle
from vedette.fusion.trust import Trust
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.net.credentials import credentials
from vedette.net.keys import issue_team
from vedette.net.notary import CertifiedNotary
from vedette.sim.datagrams import Datagrams
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.faults import Schedule
from vedette.sim.network import Network, Spawn
from vedette.sim.overlaid import OverlaidNetwork
from vedette.sim.simulation import random_streams
from vedette.sim.starts import choose_starts
from vedette.sim.worlds import office
from vedette.team import Most, PlatformSpec

MOST = 600.0  # a mission may last [s]
PARTS: dict[str, tuple[tuple[type, str], ...]] = {
    "signing": ((CertifiedNotary, "sign"),),
    "checking": ((CertifiedNotary, "check"), (CertifiedNotary, "admit")),
    "trees of roots": ((Merkle, "with_leaves"),),
}
ADDED = TrafficKind.FUSION, TrafficKind.BEACONS
JUDGING = {"judging whom to believe": ((Trust, "see"), (Trust, "out"))}


@dataclass
class Meter:
    """CPU time by what it is spent on [s], and how often; of the outermost call alone."""

    spent: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    calls: dict[str, int] = field(default_factory=lambda: defaultdict(int))

    @contextmanager
    def on(self, parts: dict[str, tuple[tuple[type, str], ...]]) -> Iterator[None]:
        """Time these methods meanwhile."""
        before = [(cls, name, getattr(cls, name)) for names in parts.values() for cls, name in names]
        for what, names in parts.items():
            for cls, name in names:
                setattr(cls, name, self._timed(what, getattr(cls, name)))
        try:
            yield
        finally:
            for cls, name, method in before:
                setattr(cls, name, method)

    def _timed(self, what: str, method: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*given: Any, **named: Any) -> Any:
            began = time.thread_time()
            try:
                return method(*given, **named)
            finally:
                self.spent[what] += time.thread_time() - began
                self.calls[what] += 1

        return timed


class KeyedTeam(ExploreSimulation):
    """A simulated team on links that lose nothing, with keys or without."""

    def __init__(self, world: World, robots: int, seed: int, keys: list[Path] | None, **body: Any) -> None:
        """Bring it to life at starts that follow from the seed; ``keys``: a folder for each robot."""
        self.keys, self.now = keys, 0.0
        specs = [PlatformSpec(name=f"robot-{i + 1}", **body) for i in range(robots)]
        starts = choose_starts(world, specs, np.random.default_rng([seed, 1]), None)
        super().__init__(world, specs, starts, ExploreSetup(seed=seed, max_time=MOST, faults=Schedule(())))

    def _explorer(self, robot: int, boot: int) -> Agent:
        notary = None
        if self.keys is not None:
            own = credentials(self.keys[robot], datetime.now(UTC))
            notary = CertifiedNotary(own, "bench", lambda: self.now)
        made = partial(assemble, self.lattice, self.specs[robot], self.setup.options, robot, boot)
        return made(robots=len(self.specs), most=Most.of(self.specs), notary=notary)

    def _overlaid(self, spawn: Spawn, walls: World | None) -> Network:
        n, setup = len(self.specs), self.setup
        datagrams = Datagrams(n, random_streams(setup.seed, n)[n], (setup.link_delay, setup.link_delay))
        datagrams.set_links(np.zeros((n, n)))
        return OverlaidNetwork(spawn, self.field, datagrams)


@dataclass(frozen=True)
class Cost:
    """What one mission took."""

    time: float  # simulated [s]
    sent: dict[TrafficKind, int]  # bytes
    planning: float  # CPU time [s]
    spent: dict[str, float]  # CPU time on parts [s]
    calls: dict[str, int]


def play(side: tuple[float, float], robots: int, seed: int, keys: list[Path] | None) -> Cost:
    """Play one mission in an office of these sides [m]."""
    world = office(np.random.default_rng([seed, 5]), *side)
    meter, team = Meter(), KeyedTeam(world, robots, seed, keys)
    with meter.on(PARTS | JUDGING):
        team.run(lambda: None)
    sent = {kind: sum(each) for kind, each in team.network.bytes_sent.items()}
    return Cost(team.now, sent, sum(team.clock.planning.values()), meter.spent, meter.calls)


def measure(side: tuple[float, float], robots: int, seed: int) -> tuple[Cost, Cost]:
    """Return what a team costs without keys, and with."""
    with TemporaryDirectory(prefix="vedette-bench-") as folder:
        keys = issue_team("bench", Path(folder) / "keys", robots, datetime.now(UTC))
        return play(side, robots, seed, None), play(side, robots, seed, keys)


def share(plain: Cost, signed: Cost) -> float:
    """Return which part of all bytes signing adds: what is negotiated differs with the mission, not by it."""
    kinds = [kind for kind in signed.sent if kind is not TrafficKind.NEGOTIATION]
    rest = sum(plain.sent[kind] for kind in kinds) / plain.time
    more = sum(signed.sent[kind] for kind in kinds) / signed.time - rest
    return more * signed.time / sum(signed.sent.values())


def table(costs: Sequence[tuple[int, int, Cost, Cost]]) -> str:
    """Return a row a mission."""
    rows = []
    for robots, seed, plain, signed in costs:
        total = sum(signed.spent[part] for part in PARTS)
        rows.append(
            [
                f"{robots}",
                f"{seed}",
                *(f"{(signed.sent[k] / signed.time - plain.sent[k] / plain.time):+.0f}" for k in ADDED),
                f"{sum(signed.sent.values()) / signed.time:.0f}",
                f"{100 * share(plain, signed):.1f} %",
                *(f"{1e3 * signed.spent[part]:.0f}" for part in (*PARTS, *JUDGING)),
                f"{1e3 * plain.planning:.0f}",
                f"{100 * total / plain.planning:.0f} %",
                f"{100 * total / (robots * signed.time):.3f} %",
            ]
        )
    header = ["robots", "seed", "fusion", "beacons", "all bytes/s", "added", "sign", "check", "roots"]
    return markdown([*header, "judge", "planning ms", "of planning", "of a core"], rows, "r" * 13)


@click.command()
@command.robots_option("3,5", least=2)
@click.option("--world", default="14x12", show_default=True, help="Office [m].")
@command.seeds_option("0-2")
def signing(robots: tuple[int, ...], world: str, seeds: tuple[int, ...]) -> None:
    """Measure what signing adds to teams in an office: bytes, and CPU time by part."""
    side = world_of(world)
    costs = [(n, seed, *measure(side, n, seed)) for n in robots for seed in seeds]
    click.echo(table(costs), nl=False)


if __name__ == "__main__":
    command.run(signing, "python -m bench.signing")
