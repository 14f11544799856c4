"""A simulated mission in the hands of a caller: stepped or run, looked into, followed and recorded."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Generic, Self, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.agent.events import Event
from vedette.agent.orders import NoGo, Order, OrderBook, Priority
from vedette.interrupt import ending_on_ctrl_c
from vedette.outcome import Outcome
from vedette.record.folder import OutputFolder
from vedette.record.log import Sink
from vedette.record.mcap import Place
from vedette.sim.orders import OrderAt
from vedette.sim.simulation import Simulation
from vedette.sim.views import figures, state
from vedette.sim.watched import Watched

RECORD = "run.mcap"
SnapshotT = TypeVar("SnapshotT")
StrategyT = TypeVar("StrategyT")
ImpactT = TypeVar("ImpactT")
ReportT = TypeVar("ReportT")
Recorder = Callable[[Place], AbstractContextManager[Sink[SnapshotT]]]  # opens a run record


@dataclass(frozen=True, eq=False)
class Deciding(Generic[StrategyT, ImpactT]):
    """What a robot has decided, and what it is about to."""

    strategy: StrategyT  # of the last decision, as far as it is not carried out yet
    impact: ImpactT | None  # that the team reckons with; None: nothing has been decided yet
    rounds: int  # decisions so far
    pending: bool  # a round is going on
    proposed: StrategyT | None  # in that round, so far; None: the robot does not negotiate yet


@dataclass(eq=False)
class Followers(Generic[SnapshotT]):
    """All who follow a mission, as one sink."""

    sinks: list[Sink[SnapshotT]] = field(default_factory=list)
    last: SnapshotT | None = None

    def update(self, snapshot: SnapshotT) -> None:
        """Hand a snapshot on, and keep it."""
        self.last = snapshot
        for sink in self.sinks:
            sink.update(snapshot)


@dataclass(frozen=True, eq=False)
class ProgressSink(Generic[SnapshotT]):
    """A function as a sink."""

    tell: Callable[[SnapshotT], object]

    def update(self, snapshot: SnapshotT) -> None:
        """Call it."""
        self.tell(snapshot)


class StepwiseMission(ABC, Generic[SnapshotT, StrategyT, ImpactT, ReportT]):
    """One mission of one domain; nothing happens before its first step.

    As a context manager it closes its record, whatever ends the block.
    """

    def __init__(
        self,
        simulation: Simulation,
        watched: Watched[ReportT],
        followers: Followers[SnapshotT],
        recorder: Recorder[SnapshotT],
        record: str | Path | None,
        inputs: Sequence[Path],
    ) -> None:
        """Take a mission whose followers are told of; ``record``: the folder for its ``run.mcap``."""
        self.inputs = tuple(inputs)  # files that it has been read from
        self._running, self._watched, self._followers = simulation, watched, followers
        self._simulation, self._recorder = simulation, recorder
        self._stopped = self._begun = False
        self._open = ExitStack()
        self._folder = None if record is None else OutputFolder.make(Path(record), True, "", inputs)

    # -- going on -----------------------------------------------------------------------------------

    def step(self, ticks: int = 1) -> Outcome | None:
        """Live through so many ticks of 0.1 s, the first time also the moment 0; return ``over``."""
        if self._folder is not None:
            folder, self._folder = self._open.enter_context(self._folder), None
            self._followers.sinks += [
                self._open.enter_context(self._recorder(lambda: folder / RECORD)),
                folder,
            ]
        for _ in range(ticks if self._begun else ticks + 1):
            self._begun = True
            if self._watched.step() is not None:
                self.finish()
                break
        return self.over

    def play(self, sinks: Sequence[Sink[SnapshotT]] = ()) -> ReportT:
        """Step to the end, which the first Ctrl-C brings about in good order; ``sinks`` follow."""
        self._followers.sinks += sinks
        with self, ending_on_ctrl_c(self.stop):
            while self.step() is None:
                pass
        return self.finish()

    def stop(self) -> None:
        """End what is going on at the end of its tick, as interrupted; a signal handler may call it."""
        self._stopped = True
        self._running.stop()

    def finish(self) -> ReportT:
        """Return what the mission leaves; one that is not over is interrupted, its record closed."""
        report = self._watched.report
        self.close()
        return report

    def close(self) -> None:
        """Close the record; what has been recorded is whole."""
        self._open.close()

    def __enter__(self) -> Self:
        """Return the mission."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the record."""
        self.close()

    # -- orders -------------------------------------------------------------------------------------

    def order(self, order: Order) -> None:
        """Give the team an order, from the next tick on; any thread may.

        Raises:
            InputError: it makes no sense.
        """
        known: list[NoGo | Priority] = []
        for book in self.books:
            areas: list[NoGo | Priority] = [*book.all_of(NoGo), *book.all_of(Priority)]
            known += map(self._running.as_meant, areas)
        self._check_order(OrderAt(self.now, order), known)
        self._running.order(order)

    @property
    def books(self) -> list[OrderBook]:
        """The orders that each robot holds."""
        return [agent.orders for agent in self._agents]

    @abstractmethod
    def _check_order(self, given: OrderAt, known: Sequence[NoGo | Priority]) -> None:
        """Raise InputError for an order that makes no sense, where there are some areas already."""

    # -- looking at it ------------------------------------------------------------------------------

    @property
    def over(self) -> Outcome | None:
        """How the mission ended; None: it goes on."""
        return self._watched.over

    @property
    def stopped(self) -> bool:
        """Whether it has been told to end."""
        return self._stopped

    @property
    def now(self) -> float:
        """Simulated time [s]."""
        return self._simulation.now

    @property
    def alive(self) -> NDArray[np.bool_]:
        """``(n,)`` who lives."""
        return self._simulation.field.alive.copy()

    @property
    def poses(self) -> NDArray[np.float64]:
        """``(n, 3)`` where everybody truly is: x, y, heading [m, m, rad], team frame."""
        return np.array([self._simulation.pose(i) for i in range(len(self._agents))])

    @property
    def states(self) -> tuple[str, ...]:
        """Everybody's word for what it does."""
        return tuple(state(self._simulation, i) for i in range(len(self._agents)))

    @property
    def counts(self) -> tuple[tuple[int, int], ...]:
        """Of each robot, the rounds that it has ended with a decision, and what it has sent [byte]."""
        counted = [figures(self._simulation, i, 0.0) for i in range(len(self._agents))]
        return tuple((each.rounds.rounds, each.bytes.total) for each in counted)

    @property
    def observed(self) -> tuple[tuple[Event, ...], ...]:
        """What each robot was told of the world in the last tick: its ``Pose``, then what its sensors saw.

        That is a ``Scan`` of a lidar, or ``Sensed`` by another sensor, where it was time for one.
        """
        return tuple(tuple(self._simulation.sensed.get(i, ())) for i in range(len(self._agents)))

    @property
    def deciding(self) -> tuple[Deciding[StrategyT, ImpactT], ...]:
        """What each robot has decided, and is about to."""
        return tuple(_deciding(agent) for agent in self._agents)

    @property
    def snapshot(self) -> SnapshotT | None:
        """The mission as it was logged last, plans and figures included; None: it has not begun."""
        return self._followers.last

    @property
    def _agents(self) -> list[Agent]:
        return self._simulation.agents

    @property
    def _first(self) -> int:
        """The first robot that lives; without any, the first."""
        return next(iter(self._simulation.living), 0)

    def _beside(self, simulation: Simulation) -> None:
        """Let another simulation take over: it is what ``stop`` ends, even before it begins."""
        self._running = simulation
        if self._stopped:
            simulation.stop()

    @abstractmethod
    def result(self) -> object:
        """Return how it went: the figures, and the arrays; a mission that goes on is interrupted."""


def _deciding(agent: Agent) -> Deciding[StrategyT, ImpactT]:
    rounds, participant = agent.rounds, None
    if rounds.round is not None:
        participant = rounds.round.participant
    proposed = None if participant is None else participant.strategy
    return cast(
        Deciding[StrategyT, ImpactT],
        Deciding(agent.mission.strategy, rounds.impact, rounds.decisions, rounds.busy, proposed),
    )
