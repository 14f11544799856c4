"""A process's clock of its mission, in ticks of the body."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor

from vedette.agent.body import TICK

LATE = 5  # ticks that are made up for at most; a process that falls behind more runs slower


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
