"""What a mission costs, apart from all that is simulated: wall time, and CPU time of planning."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from vedette.agent.effects import Job
from vedette.agent.rounds import Rounds
from vedette.record.summary import Spread, Timing

T = TypeVar("T")


@dataclass
class Clock:
    """Wall time of a run, and the CPU time that its robots spend on planning.

    CPU time is the thread's own: what others do at the same time, in this process or another, does not
    count.
    """

    started: float = 0.0
    planning: dict[tuple[int, int, int], float] = field(default_factory=dict)  # robot, epoch, round: [s]
    answers: list[float] = field(default_factory=list)  # a negotiation message, each [s]

    def start(self) -> None:
        """Begin counting."""
        self.started = time.perf_counter()

    def elapsed(self) -> float:
        """Return the wall time since the start [s]."""
        return time.perf_counter() - self.started

    def timing(self, now: float) -> Timing:
        """Return the wall-clock figures of a mission that has come to ``now`` [s], its rounds simulated."""
        wall_s = self.elapsed()
        return Timing(
            planning_ms=self.planning_ms,
            answer_ms=self.answer_ms,
            round_ms=None,
            real_time_factor=now / wall_s if wall_s > 0 else 0.0,
            wall_s=wall_s,
        )

    def measured(self, robot: int, rounds: Rounds, act: Callable[[], T]) -> T:
        """Let a robot's agent do something, and count it if it is part of a round."""
        decisions, answers = rounds.decisions, rounds.answers
        began = time.thread_time()
        result = act()
        took = time.thread_time() - began
        if rounds.busy or rounds.decisions != decisions:
            self._plans(robot, rounds.stamp, took)
            if rounds.decisions == decisions and rounds.answers != answers:
                self.answers.append(took)
        return result

    def run(self, robot: int, job: Job) -> None:
        """Run a robot's job."""
        began = time.thread_time()
        job.run()
        self._plans(robot, job.key, time.thread_time() - began)

    @property
    def planning_ms(self) -> Spread | None:
        """What one robot spends on one replan, all sweeps."""
        return Spread.of([1e3 * took for took in self.planning.values()])

    @property
    def answer_ms(self) -> Spread | None:
        """What it takes to answer the token, a visit."""
        return Spread.of([1e3 * took for took in self.answers])

    def _plans(self, robot: int, stamp: tuple[int, int], took: float) -> None:
        key = robot, *stamp
        self.planning[key] = self.planning.get(key, 0.0) + took
