"""Vehicles that spread over a few points: a small timed mission for the real agent and the real simulator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.support.agent_team import FloatCodec
from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.agent.events import Pose, Sensed
from vedette.agent.flight import FlightPlan, start_step
from vedette.agent.mates import Mate
from vedette.forbidden import NOWHERE, Forbidden
from vedette.fusion import ReplicatedEvidence
from vedette.negotiation import Chooser
from vedette.outcome import Outcome
from vedette.problem import Coverage
from vedette.sim.planted import PlantedTree
from vedette.sim.setup import Setup
from vedette.sim.simulation import Simulation
from vedette.sim.vehicles import Vehicles
from vedette.team import PlatformSpec
from vedette.vehicle import drive, turn_sequences

Float = NDArray[np.float64]
POINTS = 12
SPEED, TURN_RATE = 5.0, 0.5  # [m/s], [rad/s]
STEP, STEPS = 1.0, 4  # [s], of a plan
LEAD = 0.7  # from freezing to the start of a plan, at least [s]
SIGHT = 30.0  # a point this far away is missed with probability 1 - 1/e [m]


@dataclass(frozen=True, eq=False)
class Belief:
    """What a round plans on: what each point is worth, and the step that plans start with."""

    start: int
    worth: Float  # (POINTS,)


@dataclass(frozen=True)
class Turns:
    """A strategy."""

    start: int
    turn_rates: tuple[float, ...]  # [rad/s]


@dataclass(eq=False)
class Spreading:
    """See points, each the nearer the surer; ``vedette.agent.mission.FlightMission``."""

    fusion: ReplicatedEvidence
    points: Float  # (POINTS, 2) [m]
    worth: Float  # (POINTS,)
    codec: FloatCodec = field(default_factory=FloatCodec)
    strategy: Turns | None = None
    ends_at: float = np.inf  # [s]
    seen: list[Sensed] = field(default_factory=list)
    t0s: list[float] = field(default_factory=list)  # of the rounds frozen [s]
    departures: dict[int, Pose] = field(default_factory=dict)  # by start step
    values: list[float] = field(default_factory=list)  # of the decisions
    against: Float | None = None  # others' impact at the last reply
    forbidden: Forbidden = NOWHERE

    def __post_init__(self) -> None:
        self._coverage = Coverage()
        self._index: dict[Turns, int] = {}
        self._impacts: list[Float] = []

    @property
    def platform(self) -> Spreading:
        """Itself."""
        return self

    @property
    def objective(self) -> Spreading:
        """Itself."""
        return self

    def observe(self, seen: Any, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Keep it."""
        assert isinstance(seen, Sensed)
        self.seen.append(seen)

    def publish(self, now: float) -> None:
        """Nothing is known but the points."""

    def notes(self) -> list[tuple[int, int, int]]:
        """Nothing to tell."""
        return []

    def hear_notes(self, notes: Sequence[tuple[int, int, int]]) -> None:
        """Nothing to hear."""

    def freeze(self, t0: float) -> Belief:
        """Plan from the first step that can be made in time."""
        self.t0s.append(t0)
        return Belief(start_step(t0, LEAD, STEP), self.worth)

    def prepare(self, belief: Belief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """Fly every sequence of turns from where the vehicle will be."""
        self.departures[belief.start] = pose
        turns = turn_sequences(TURN_RATE, STEPS)
        ways = drive((pose.x, pose.y, pose.heading), turns, SPEED, STEP)[..., :2]
        away = np.hypot(*(ways[:, :, None, :] - self.points).transpose(3, 0, 1, 2)).min(axis=1)
        self._impacts = list(-np.expm1(-((away / SIGHT) ** 2)))
        self._index = {Turns(belief.start, tuple(row)): k for k, row in enumerate(turns.tolist())}
        if self.strategy is not None:
            left = self.strategy.turn_rates[max(belief.start - self.strategy.start, 0) :]
            self.strategy = Turns(belief.start, left + (0.0,) * (STEPS - len(left)))

    def _chooser(self, belief: Belief, strategy: Turns | None) -> Chooser[Float, Float]:
        start = None if strategy is None else self._index[strategy]
        return Chooser(self._coverage, belief.worth, self._impacts, start=start)

    def impact(self, belief: Belief, strategy: Turns | None) -> Float:
        """Miss probability of each point."""
        return self._chooser(belief, strategy).impact

    def reply(self, belief: Belief, others: Float, current: Turns | None) -> Turns | None:
        """As a chooser replies."""
        self.against = others
        chooser = self._chooser(belief, current)
        chooser.reply(others)
        return list(self._index)[chooser.index] if chooser.index is not None else None

    def nothing(self, belief: Belief) -> Float:
        """No sighting."""
        return self._coverage.nothing(belief.worth)

    def combine(self, a: Float, b: Float) -> Float:
        """Misses multiply."""
        return self._coverage.combine(a, b)

    def value(self, belief: Belief, impact: Float) -> float:
        """Worth seen."""
        return self._coverage.value(belief.worth, impact)

    def price(self, impact: Float) -> float:
        """Return nothing: all is free."""
        return 0.0

    def gross(self, belief: Belief, impact: Float) -> float:
        """Return the value."""
        return self.value(belief, impact)

    def slack(self, belief: Belief, base: Float) -> float:
        """Of the sequences."""
        return self._chooser(belief, None).slack(base)

    def reach(self, now: float) -> None:
        """Anywhere."""

    def admit(self, belief: Belief, impact: Float, robots: int) -> None:
        """As many points as there are can be claimed."""

    def nothing_left(self, value: float, now: float) -> bool:
        """When the time is up."""
        self.values.append(value)
        return now >= self.ends_at

    def start(self, belief: Belief) -> float:
        """Of the start step [s]."""
        return belief.start * STEP

    def plan(self) -> FlightPlan | None:
        """The turns."""
        if self.strategy is None:
            return None
        return FlightPlan(self.strategy.start * STEP, STEP, np.array(self.strategy.turn_rates))


class Flown:
    """What every vehicle's sensor notes at the end of each step: its true pose."""

    def __init__(self) -> None:
        """No pose yet."""
        self.poses: dict[tuple[int, int], Float] = {}  # by vehicle and step

    def __call__(self, i: int, pose: Float, now: float) -> object:
        """Note the pose; the step itself is what is told."""
        step = round(now / STEP)
        assert abs(now - step * STEP) < 1e-6
        self.poses[i, step] = pose
        return step


@dataclass
class FlightTeam:
    """A team at a common start, its simulation, and what its sensors noted."""

    simulation: Simulation
    vehicles: Vehicles
    missions: list[Spreading]
    flown: Flown

    def run(self) -> Outcome:
        """To the end."""
        return self.simulation.run(lambda: None)

    def fall_silent(self) -> None:
        """From now on no message arrives, though all are on one tree."""
        network = self.simulation.network
        assert isinstance(network, PlantedTree)
        network.wires.delay = np.inf

    def behaviour(self, i: int) -> FlightBehaviour:
        """Of a vehicle."""
        behaviour = self.simulation.agents[i].behaviour
        assert isinstance(behaviour, FlightBehaviour)
        return behaviour


def flight_team(
    n: int, ends_at: float = np.inf, over: Callable[[float], Outcome | None] = lambda now: None, **setup: Any
) -> FlightTeam:
    """``n`` vehicles at the middle of three groups of points, planning anew every second."""
    rng = np.random.default_rng(0)
    groups = 60.0 * np.array([(1.0, 0.0), (-0.5, 0.87), (-0.5, -0.87)])
    points = groups.repeat(POINTS // 3, axis=0) + rng.normal(0.0, 4.0, (POINTS, 2))
    spec = PlatformSpec(speed=SPEED, turn_rate=TURN_RATE)
    missions = [
        Spreading(ReplicatedEvidence(i, 1, (1, 1), 1), points, np.ones(POINTS), ends_at=ends_at)
        for i in range(n)
    ]
    agents = [
        Agent(i, 1, spec, FlightBehaviour(mission, SPEED, TURN_RATE), pace=Pace.each(STEP))
        for i, mission in enumerate(missions)
    ]
    flown = Flown()
    poses = [(float(i), 0.0, 0.5 * i) for i in range(n)]
    vehicles = Vehicles(poses, SPEED, TURN_RATE, STEP, flown, over)
    simulation = Simulation(lambda i, boot: agents[i], vehicles, Setup(**{"max_time": 30.0, **setup}))
    return FlightTeam(simulation, vehicles, missions, flown)
