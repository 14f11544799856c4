"""Exploring teams with one member that lies of its own, or in others' names; all of it follows from a seed.

``python -m tests.support.liars MODE ROBOTS FIRST LAST [SCHEME]`` plays many, and the same teams with that
member dead.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from tests.support.misbehaving import Dead
from tests.support.notaries import PlainNotary
from vedette.agent import Agent, NetworkedAgent, messages
from vedette.agent.effects import Send
from vedette.agent.messages import Evidence, Negotiate
from vedette.agent.networked import Output
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.views import MOST_STOPS
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.trust import Comparison
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import SparseMisses
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.disc import cells_under
from vedette.maps.swept import most_cells_swept
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.evidence import CLAMP
from vedette.missions.explore.exploring import Exploring
from vedette.negotiation import messages as negotiation
from vedette.outcome import Outcome
from vedette.sim.datagrams import Datagrams
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.faults import Schedule, Timeline
from vedette.sim.network import Network, Spawn
from vedette.sim.overlaid import OverlaidNetwork
from vedette.sim.simulation import random_streams
from vedette.sim.starts import choose_starts
from vedette.sim.worlds import office
from vedette.team import Most, PlatformSpec

AT_MOST = 600.0  # a mission may last [s]


class Liar(Exploring):
    """Says what is not so of all that is within its lidar's range."""

    says = 0  # log-odds

    def publish(self, now: float) -> None:
        """Lie, and publish."""
        near = cells_under(self.frame, *self._at, self.spec.range) if np.isfinite(self._at[0]) else ()
        lies = self._lies(np.asarray(near, np.int64))
        if len(lies):
            self.own.log_odds.put(lies, np.full(len(lies), self.says, np.int8))
            self.own._note(lies)
        super().publish(now)

    def _lies(self, near: NDArray[np.int64]) -> NDArray[np.int64]:
        return near[self.own.log_odds.take(near) != self.says]


class Occupied(Liar):
    """Everything is a wall, but for where somebody may stand."""

    says = CLAMP


class Free(Liar):
    """There are no walls."""

    says = -CLAMP


class Far(Liar):
    """There is a free place far away."""

    says = -CLAMP

    def _lies(self, near: NDArray[np.int64]) -> NDArray[np.int64]:
        there = near + 300 * self.frame.cols
        return super()._lies(there[there < self.frame.rows * self.frame.cols])


class Notes(Exploring):
    """All frontiers have been visited in vain."""

    def _own_notes(self) -> list[tuple[int, int, int]]:
        belief = getattr(self, "_belief", None)
        if belief is None:
            return []
        starts = belief.frontier_starts
        middles = belief.frame.centres(belief.frontier_cells[(starts[:-1] + starts[1:]) // 2])
        return [(round(100 * x), round(100 * y), self._unknown_at(np.array((x, y)))) for x, y in middles]

    def freeze(self, t0: float) -> Any:
        """Remember where there are frontiers."""
        self._belief = super().freeze(t0)
        return self._belief


class Claims(Exploring):
    """It will soon see as much as can be believed of it: the whole of what is worth most."""

    def __post_init__(self) -> None:
        super().__post_init__()
        honest = self.platform.impact

        def impact(belief: Any, strategy: Any) -> Any:
            honest(belief, strategy)
            return largest_claim(belief, self.most)

        self.platform.impact = impact  # type: ignore[method-assign]


def largest_claim(belief: Any, most: Most) -> SparseMisses:
    """Return the planning cells of most worth, as many and as early as one robot may claim."""
    side, edges = belief.planning.resolution, belief.layers.edges
    worth = belief.weights.window
    order = np.argsort(-worth.ravel(), kind="stable")
    order = order[worth.ravel()[order] > 0]
    discs = MOST_STOPS * most_cells_swept(most.range, 0.0, side)
    by = np.minimum(most_cells_swept(most.range, most.speed * edges, side), discs).astype(int)
    chosen = order[: by[-1]]
    layer = np.searchsorted(by, np.arange(len(chosen)), side="right")
    row, col = np.divmod(chosen, worth.shape[1])
    cells = (row + belief.first[0]) * belief.planning.cols + col + belief.first[1]
    keys = (cells * LAYERS + layer).astype(np.uint32)
    at = np.argsort(keys)
    return SparseMisses(keys[at], np.full(len(keys), 64, np.uint8))


class BoastingObjective(MappingObjective):
    """Adds the largest claim there can be to whatever is added up."""

    belief: Any = None
    most: Most | None = None

    def combine(self, a: Any, b: Any) -> Any:
        """Add up too much."""
        added = super().combine(a, b)
        return added if self.belief is None else super().combine(added, largest_claim(self.belief, self.most))


class Sums(Exploring):
    """Tells more than the sum of what it has heard, and signs that it is the sum."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.objective = self._boast = BoastingObjective()
        self._boast.most = self.most

    def freeze(self, t0: float) -> Any:
        """Boast of what is to be seen in this round."""
        self._boast.belief = super().freeze(t0)
        return self._boast.belief


class Inflating(NetworkedAgent):
    """Tells more than the sum, and signs an account by which it has told nothing that can be checked."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message, rounds = messages.decode(send.payload), self.agent.rounds
        if isinstance(message, Negotiate) and rounds.round is not None:
            mission, belief = self.agent.mission, rounds.round.belief
            said = negotiation.decode(message.data, mission.codec)
            if getattr(said, "mu", None) is not None:
                more = mission.objective.combine(said.mu, largest_claim(belief, mission.most))
                data = negotiation.encode(structs.replace(said, mu=more), mission.codec)
                send = replace(send, payload=messages.encode(structs.replace(message, data=data)))
        return super()._say(send, now)


class Poisoning(NetworkedAgent):
    """Changes what it passes on of others."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message = messages.decode(send.payload)
        if isinstance(message, Evidence):
            codec = self.agent.mission.fusion._codec
            payload = codec.decode(message.data)
            sections = [
                (key, replace(delta, values=5 - delta.values) if key[0] != self.agent.robot else delta)
                for key, delta in payload.sections
            ]
            data = codec.encode(replace(payload, sections=sections))
            send = replace(send, payload=messages.encode(Evidence(data)))
        return super()._say(send, now)


@dataclass(frozen=True)
class Mode:
    """What one member does."""

    explorer: type[Exploring] = Exploring
    program: type[NetworkedAgent] = NetworkedAgent
    unbounded: bool = False
    between: bool = False  # others, on a chain: a lie of one who has something to add up


MODES: Mapping[str, Mode] = {
    "dead": Mode(program=Dead),
    "dead between": Mode(program=Dead, between=True),
    "occupied": Mode(Occupied),
    "free": Mode(Free),
    "far": Mode(Far, unbounded=True),
    "notes": Mode(Notes),
    "claim": Mode(Claims),
    "poison": Mode(program=Poisoning),
    "sum": Mode(Sums, between=True),
    "inflate": Mode(program=Inflating, between=True),
    "honest": Mode(),
}


class LyingTeam(ExploreSimulation):
    """A team whose evidence is signed, and whose last member lies; honest are all the others."""

    def __init__(
        self, world: World, specs: list[PlatformSpec], setup: ExploreSetup, mode: Mode, liar: int
    ) -> None:
        """Bring it to life at starts that follow from the seed."""
        self.mode, self.liar, self.now = mode, liar, 0.0
        self.worst = Comparison(0, 0, 0)
        self.named: dict[int, float] = {}  # when each robot was first complained of by somebody honest [s]
        starts = choose_starts(world, specs, np.random.default_rng([setup.seed, 1]), None)
        super().__init__(world, specs, starts, setup)

    def _explorer(self, robot: int, boot: int) -> Agent:
        explorer = self.mode.explorer if robot == self.liar else Exploring
        return assemble(
            self.lattice,
            self.specs[robot],
            self.setup.options,
            robot,
            boot,
            robots=len(self.specs),
            most=Most.of(self.specs),
            explorer=explorer,
            notary=PlainNotary(robot, lambda: self.now),
        )

    def _overlaid(self, spawn: Spawn, walls: World | None) -> Network:
        n, setup = len(self.specs), self.setup
        datagrams = Datagrams(n, random_streams(setup.seed, n)[n], (setup.link_delay, setup.link_delay))
        away = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
        datagrams.set_links((away > 1).astype(float) if self.mode.between else np.zeros((n, n)))
        self.lives: dict[int, NetworkedAgent] = {}
        timeline = Timeline(Schedule(()), n)
        return OverlaidNetwork(spawn, self.field, datagrams, timeline=timeline, live=self._live)

    def _live(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        program = self.mode.program if i == self.liar else NetworkedAgent
        self.lives[i] = program(agent, now, lease=lease, admitted=len(self.specs))
        return self.lives[i]

    @property
    def honest(self) -> list[int]:
        """All but the liar."""
        return [i for i in self.living if i != self.liar]

    @property
    def over(self) -> Outcome | None:
        """When the honest are done."""
        if all(self.network.agents[i].done for i in self.honest):
            return Outcome.COMPLETE
        return Outcome.TIME_LIMIT if self.now >= self.setup.max_time else None

    def _tick(self) -> None:
        super()._tick()
        for i in self.honest:
            for robot in self.lives[i].complaints:
                self.named.setdefault(robot, self.now)

    def look(self) -> None:
        """Note how far two of the honest contradict each other, as if all they say stood for ever."""
        fusion = self.missions[self.honest[0]].fusion
        assert isinstance(fusion, SignedEvidence)
        for (a, b), tally in fusion.contradictions(1 << 40).items():
            if self.liar not in (a, b) or self.mode is MODES["honest"]:
                self.worst = max(self.worst, tally)

    # -- how it went ---------------------------------------------------------------------------------

    def looked(self) -> NDArray[np.bool_]:
        """Return ``(R, C)`` where the honest have looked themselves."""
        return np.any([self.missions[i].own.log_odds.window(*self._window) != 0 for i in self.honest], axis=0)

    def wrong(self) -> float:
        """Return the share of wrong cells where the honest have looked, at worst on anybody's map.

        Walls count as right one cell off, as in a mission's summary.
        """
        looked = self.looked()
        inner = (
            self.world.solid & np.pad(self.world.solid, 1)[2:, 1:-1] & np.pad(self.world.solid, 1)[:-2, 1:-1]
        )
        worst = 0.0
        for i in self.honest:
            shown = self._shown(i)
            bad = ((shown == OCCUPIED) & ~_widened(self.world.solid)) | ((shown == FREE) & inner & looked)
            worst = max(worst, float((bad & looked).sum() / looked.sum()))
        return worst

    def known(self) -> float:
        """Return how many cells the honest know, the least of them; of what is free [m^2]."""
        return min(float(((self._shown(i) != UNKNOWN) & ~self.world.solid).sum()) for i in self.honest)

    def _shown(self, i: int) -> NDArray[np.uint8]:
        return self.missions[i].fusion.classes.window(*self._window)

    @property
    def _window(self) -> tuple[slice, slice]:
        """Where the world lies in the lattice."""
        here, there = self.world.frame, self.lattice.frame
        row = round((here.origin_y - there.origin_y) / here.resolution)
        col = round((here.origin_x - there.origin_x) / here.resolution)
        return slice(row, row + here.rows), slice(col, col + here.cols)


def _widened(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    rows, cols = solid.shape
    padded = np.pad(solid, 1)
    return np.any([padded[i : i + rows, j : j + cols] for i in range(3) for j in range(3)], axis=0)


@dataclass(frozen=True)
class Ending:
    """How a team's mission went for those that are honest."""

    outcome: Outcome
    time: float  # [s]
    known: float
    wrong: float  # share of cells
    named: Mapping[int, float]  # when who was first complained of [s]
    liar: int
    out: frozenset[int]  # not believed, by anybody honest
    worst: Comparison  # how far two of the honest contradicted each other at most


def play(mode: str, robots: int, seed: int, scheme: str | None = None, **fields: Any) -> Ending:
    """Play one mission."""
    rng = np.random.default_rng([seed, 5])
    world = office(rng, 14.0, 12.0)
    liar, how = int(rng.integers(robots)), MODES[mode]
    if how.between:
        liar = robots // 2
    setup = ExploreSetup(
        seed=seed, max_time=AT_MOST, faults=Schedule(()), unbounded=how.unbounded, scheme=scheme
    )
    specs = [PlatformSpec(name=f"robot-{i + 1}", **fields) for i in range(robots)]
    team = LyingTeam(world, specs, setup, how, liar)
    outcome = team.run(team.look, 5.0)
    fusions = [team.missions[i].fusion for i in team.honest]
    out = frozenset[int]().union(*(each.out for each in fusions if isinstance(each, SignedEvidence)))
    return Ending(outcome, team.now, team.known(), team.wrong(), team.named, liar, out, team.worst)


@cache
def without(mode: str, robots: int, seed: int, scheme: str | None = None) -> Ending:
    """Play the same team with that member dead."""
    return play("dead between" if MODES[mode].between else "dead", robots, seed, scheme)


def main(mode: str, robots: int, first: int, last: int, scheme: str | None = None) -> None:
    """Print a line a mission."""
    for seed in range(first, last):
        began = time.monotonic()
        dead, ending = without(mode, robots, seed, scheme), play(mode, robots, seed, scheme)
        named = ending.named.get(ending.liar)
        others = sorted(set(ending.named) - {ending.liar})
        print(
            f"{mode} {robots} seed {seed}: {ending.outcome.value} after {ending.time:.1f} s, "
            f"{ending.time / dead.time:.2f} of dead's {dead.time:.1f}; "
            f"known {ending.known / dead.known:.4f}; "
            f"wrong {100 * ending.wrong:.2f} % (dead {100 * dead.wrong:.2f} %); "
            f"liar {ending.liar} named {named}; others named {others}; out {sorted(ending.out)}; "
            f"honest {tuple(ending.worst)}; {time.monotonic() - began:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:5]), *sys.argv[5:6])
