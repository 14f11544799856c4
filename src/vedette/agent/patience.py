"""How long one robot waits for the rest of its team, and when it has been without it for so long."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.agent.pace import Pace
from vedette.agent.silence import LONG

SLOW = 0.5  # of the least patience that a preparation takes [1]
IDLE = 1.0  # a robot that did not look after its rounds for longer did not want any [s of the transport]


def patience(size: int, depth: int = 0) -> float:
    """Return how long a robot, ``depth`` links below the root of so many, waits for a child's answer [s].

    At least, and by the transport's clock: members think in real time, however fast the mission is. The
    lower a robot, the sooner it cuts a child off: before its own parent loses patience with it.
    """
    return 1.0 + 0.3 * max(size - depth, 1)


@dataclass
class TeamPatience:
    """One robot's, by what its own preparation takes and when it last decided with others."""

    pace: Pace
    tempo: float = 1.0  # of the mission, in seconds a second of the transport's clock
    _prepares: float = -1e9  # since when [s]
    _preparation: float = 0.0  # what its own last one took [s]
    _together: float = -1e9  # when it last decided as others did, or wanted nothing [s]
    ticked: float = -1e9  # when it last looked after its rounds [s]

    def tick(self, now: float) -> None:
        """Note that the robot looks after its rounds."""
        if now > self.ticked + self.tempo * IDLE:
            self._together = now
        self.ticked = now

    def prepares(self, now: float) -> None:
        """Note that the robot begins to prepare."""
        self._prepares = now

    def prepared(self, now: float) -> None:
        """Note that it has prepared; while it did, it could not look after its rounds."""
        self._preparation = now - self._prepares
        self.ticked = now

    def together(self, now: float) -> None:
        """Note that it has decided as others did."""
        self._together = now

    def waits(self, size: int, depth: int = 0) -> float:
        """Return how long it waits for others [s]: longer where its own preparation takes long."""
        return self.least(size, depth) + self._preparation

    def least(self, size: int, depth: int = 0) -> float:
        """Return how long a robot would wait whose own preparation takes no time [s]."""
        return self.tempo * patience(size, depth)

    @property
    def is_no_wonder(self) -> float:
        """How long others may be silent while they prepare [s]: longer where this robot's own takes long."""
        return self.tempo * LONG + self._preparation

    def is_over(self, size: int, now: float) -> bool:
        """Tell whether it has decided with nobody for so long that it had better plan alone."""
        alone = self._together + self.pace.overdue + 3.0 * self.least(size) + self._preparation
        return now > alone

    def ignored(self, size: int, since: float, now: float) -> bool:
        """Tell whether calls of so long ago should have been answered by a round: a root that is there does.

        A robot that is slow itself may have been left out of rounds for that, and does not blame its parent.
        """
        least = self.least(size)
        return self._preparation < SLOW * least and now > since + 2.0 * least + self.pace.beat
