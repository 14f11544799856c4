"""What neighbours have told of their terms and clocks, and what is wrong with that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

from vedette.agent import terms as wire
from vedette.agent.terms import Introduction, Terms, difference

CLOCKS_APART = 1.0  # that is worth a warning [s]
ASK_AGAIN = 1.0  # [s]


@dataclass
class Acquaintance:
    """Tells every neighbour once what the team has to agree on, and says in which field one differs.

    The hellos carry a fingerprint of the terms, without which no link is used: this only finds the words.
    """

    terms: Terms
    time_of_day: Callable[[float], float]  # when the transport's clock shows ``now`` [s]
    far: float = inf  # clocks so far apart [s] keep what robots see from being compared
    complaints: dict[int, str] = field(default_factory=dict)  # by neighbour
    warnings: dict[int, str] = field(default_factory=dict)  # by neighbour: clocks
    _met: dict[int, int] = field(default_factory=dict)  # boots of those that have told
    _asked: dict[int, float] = field(default_factory=dict)  # when [s]
    _clocks: dict[int, tuple[int, float]] = field(default_factory=dict)  # boots, and how far ahead [s]

    def ask(self, robot: int, boot: int, own_boot: int, now: float) -> list[bytes]:
        """Return what to send to a neighbour that is heard, if its present life has not told yet."""
        if self._met.get(robot) == boot or now < self._asked.get(robot, -ASK_AGAIN) + ASK_AGAIN:
            return []
        self._asked[robot] = now
        return [self._tell(own_boot, True, now)]

    def hear(self, robot: int, payload: bytes, own_boot: int, now: float) -> list[bytes]:
        """Take in a neighbour's terms; return the answer, if it asks for one.

        Raises:
            ValueError: malformed.
        """
        told = wire.decode(payload)
        self._met[robot] = told.boot
        self._note(robot, told, now)
        return [self._tell(own_boot, False, now)] if told.asks else []

    def _note(self, robot: int, told: Introduction, now: float) -> None:
        self.complaints.pop(robot, None)
        self.warnings.pop(robot, None)
        unlike = difference(told.fields, self.terms)
        if unlike is not None:
            self.complaints[robot] = f"its link is refused: {unlike}"
        apart = self._ahead(robot, told, now)
        if abs(apart) > CLOCKS_APART:
            much = ", so that what it sees is compared with nobody's" if abs(apart) > self.far else ""
            self.warnings[robot] = f"its clock is {apart:+.1f} s from this robot's{much}"

    def _ahead(self, robot: int, told: Introduction, now: float) -> float:
        """Return how far a clock is ahead [s]: what came late, or came again, shows it behind."""
        ahead = told.clock / 1000.0 - self.time_of_day(now)
        boot, before = self._clocks.get(robot, (told.boot, ahead))
        ahead = max(ahead, before) if boot == told.boot else ahead
        self._clocks[robot] = told.boot, ahead
        return ahead

    def _tell(self, own_boot: int, asks: bool, now: float) -> bytes:
        clock = round(1000.0 * self.time_of_day(now))
        return wire.encode(Introduction(own_boot, asks, clock, dict(self.terms)))
