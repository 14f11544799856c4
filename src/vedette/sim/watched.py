"""A simulated mission and the observer that measures it, stepped together."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Generic, TypeVar

from vedette.outcome import Outcome
from vedette.sim.simulation import Simulation

ReportT = TypeVar("ReportT")


class Watched(ABC, Generic[ReportT]):
    """One mission of one domain; it begins with its first step."""

    def __init__(self, simulation: Simulation) -> None:
        """Watch a simulation that has not begun."""
        self._simulation = simulation
        self.over: Outcome | None = None  # how the mission ended; None: it goes on

    def step(self) -> Outcome | None:
        """Live through one tick, the first time that of time 0, and look if it is time; return ``over``."""
        if self.over is None:
            self._simulation.step()
            self._look()
            self.over = self._simulation.over
        return self.over

    def run(self) -> ReportT:
        """Step to the end, which Ctrl-C brings about in good order; return what the mission leaves."""
        try:
            while self.step() is None:
                pass
        except KeyboardInterrupt:
            self.over = Outcome.INTERRUPTED
        return self.report

    @cached_property
    def report(self) -> ReportT:
        """What the mission leaves; one that goes on is interrupted by being asked."""
        self.over = self.over or Outcome.INTERRUPTED
        return self._report(self.over)

    @abstractmethod
    def _look(self) -> None:
        """Measure the mission if it is time."""

    @abstractmethod
    def _report(self, outcome: Outcome) -> ReportT:
        """Measure how the mission ended, and return all."""
