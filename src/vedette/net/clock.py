"""A process's clock of its mission, in ticks of the body, or as the robot tells it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import floor
from typing import Protocol

from vedette.agent.body import TICK

LATE = 5  # ticks that are made up for at most; a process that falls behind more runs slower


class Clockwork(Protocol):
    """What a process asks of its mission's clock; ``now`` by the process's own [s]."""

    @property
    def at(self) -> float:
        """The mission's time of the last tick [s]."""

    @property
    def next(self) -> float:
        """When the next tick is due, by the process's clock [s]."""

    def start(self, now: float) -> None:
        """Begin to count."""

    def shows(self, now: float) -> float:
        """Return the mission's time [s]."""

    def tick(self, now: float) -> None:
        """Go on to the next tick."""


@dataclass
class MissionClock:
    """Mission time: ticks of the body, and what has passed of the present one."""

    speed: float  # seconds of the mission in a second
    begins: float | None = (
        None  # when the mission's time is 0, by the process's clock [s]; None: as it starts
    )
    ticks: int = 0
    ticked: float = 0.0  # when the last one was, by the process's clock [s]

    def start(self, now: float) -> None:
        """Begin to count."""
        self.ticked = now if self.begins is None else self.begins

    @property
    def at(self) -> float:
        """The mission's time of the last tick [s]."""
        return self.ticks * TICK

    def shows(self, now: float) -> float:
        """Return the mission's time [s]; it stands still rather than overtake the body."""
        return self.at + min(max(now - self.ticked, 0.0) * self.speed, TICK)

    @property
    def next(self) -> float:
        """When the next tick is due [s]."""
        return self.ticked + TICK / self.speed

    def tick(self, now: float) -> None:
        """Go on by a tick; one that comes much too late moves all later ones.

        A clock that the team shares cannot wait: it leaves out the ticks that it has missed.
        """
        if self.begins is None:
            self.ticks += 1
            self.ticked = max(self.next, now - LATE * TICK / self.speed)
        else:
            self.ticks += 1 + max(floor((now - self.next) * self.speed / TICK), 0)
            self.ticked = self.begins + self.ticks * TICK / self.speed


@dataclass
class ToldClock:
    """Mission time by the robot's own clock, which a simulation may stop, slow down or begin anew."""

    told: Callable[[], float | None]  # what that clock shows [s]; None: nothing yet
    period: float  # from look to look, by the process's clock [s]
    at: float = 0.0
    ticked: float = 0.0  # when it was last looked at, by the process's clock [s]
    _shown: float | None = None  # at the last look [s]

    def start(self, now: float) -> None:
        """Begin to count."""
        self._shown = self.told()
        self.ticked = now

    def shows(self, now: float) -> float:
        """Return the mission's time [s]; it stands still between ticks."""
        return self.at

    @property
    def next(self) -> float:
        """When to look again, by the process's clock [s]."""
        return self.ticked + self.period

    def tick(self, now: float) -> None:
        """Look at the robot's clock; where it has gone back, nothing has passed."""
        shown, self.ticked = self.told(), now
        if shown is not None and self._shown is not None:
            self.at += max(shown - self._shown, 0.0)
        self._shown = shown if shown is not None else self._shown
