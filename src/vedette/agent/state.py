"""A robot's whole state, as its agent keeps it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from vedette.agent.driving import Driver
from vedette.agent.events import Pose, Scan
from vedette.agent.mates import Mates
from vedette.agent.mission import Mission
from vedette.agent.rounds import Decision, Rounds
from vedette.maps import GridFrame
from vedette.team import PlatformSpec

QUIET_ROUNDS = 2  # so many rounds in a row with nothing to gain for anybody end the mission


class State(Enum):
    """What a robot is doing, as people are shown it."""

    WAITING = "waiting"  # for its first plan
    DRIVING = "driving"
    YIELDING = "making room"
    STUCK = "stuck"
    IDLE = "idle"  # nothing it can do is worth doing
    RETURNING = "returning"
    DONE = "done"


@dataclass
class Agent:
    """One robot's whole state."""

    robot: int
    boot: int
    spec: PlatformSpec
    frame: GridFrame
    mission: Mission
    scheme: str = "token"
    return_home: bool = False
    state: State = State.WAITING
    pose: Pose | None = None
    home: tuple[float, float] | None = None
    dropped: int = 0  # messages that did not make sense
    mates: Mates = field(default_factory=Mates)
    rounds: Rounds = field(init=False)
    driver: Driver = field(init=False)
    quiet: int = 0  # rounds in a row with nothing to gain for anybody
    home_tries: int = 0  # ways home that were blocked
    beacons: int = 0  # sent
    listening: bool = True  # until all mates have been heard, or for a while: they are not to be mapped
    held: Scan | None = None  # the latest scan while listening
    due: dict[str, float] = field(default_factory=dict)  # when what is to be done next [s]
    redirect: bool = False  # a new decision waits to be driven

    def __post_init__(self) -> None:
        self.rounds = Rounds(self.mission, self.scheme, self._decided)
        self.driver = Driver(self.robot, self.spec, self.frame)

    @property
    def finished(self) -> bool:
        """Tell whether the team has agreed that nothing is left to gain."""
        return self.quiet >= QUIET_ROUNDS

    @property
    def done(self) -> bool:
        """Tell whether this robot has nothing left to do, the way home included."""
        return self.state is State.DONE

    def _decided(self, decision: Decision) -> None:
        everything = not decision.approximate and not decision.blocked
        everything &= not self.mission.postponed(decision.time)
        nothing_to_gain = decision.outcome.value <= 0.0 and everything
        self.quiet = self.quiet + 1 if nothing_to_gain else 0
        self.redirect = True

    def is_due(self, what: str, period: float, now: float) -> bool:
        """Tell whether something periodic [s] is to be done now, and note when it will be again."""
        if now < self.due.get(what, -1.0) - 1e-9:
            return False
        self.due[what] = now + period
        return True
