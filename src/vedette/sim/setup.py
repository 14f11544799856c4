"""What is simulated, beside the world and the team."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from msgspec import to_builtins

from vedette.errors import InputError, brief, check_word
from vedette.negotiation import SCHEMES
from vedette.number import is_number, is_whole
from vedette.scenario import as_scenario
from vedette.sim.faults import Schedule, check_faults
from vedette.sim.orders import OrderAt
from vedette.sim.radio import Radio


@dataclass(frozen=True)
class Setup:
    """What all simulated missions share.

    Raises:
        InputError: an unknown scheme, or a number that is none or out of its range; the line names the field.
    """

    scheme: str | None = None  # None: the planner's own, or token
    seed: int = 0
    max_time: float = 3600.0  # [s]
    link_delay: float = 0.02  # [s]
    link_loss: float = 0.0
    kills: tuple[tuple[int, float], ...] = ()  # robot index, time [s]
    radio: Radio | None = None  # None: everybody reaches everybody
    faults: Schedule | None = None
    faults_from: str | None = None  # the schedule's file or seed
    orders: tuple[OrderAt, ...] = ()  # of the operator, in order of time

    def __post_init__(self) -> None:
        if self.scheme is not None:
            check_word("scheme", self.scheme, SCHEMES)
        if not is_whole(self.seed) or self.seed < 0:
            raise InputError(f"seed must be a whole number >= 0; got {brief(self.seed)}")
        for name, time in (("max_time", self.max_time), ("link_delay", self.link_delay)):
            if not _is_time(time):
                raise InputError(f"{name} must be a number of seconds >= 0; got {brief(time)}")
        if not is_number(self.link_loss) or not 0.0 <= self.link_loss < 1.0:
            raise InputError(f"link_loss must be a number >= 0 and < 1; got {brief(self.link_loss)}")
        _check_kills(self.kills)
        if not isinstance(self.radio, Radio | None):
            raise InputError(f"radio is {brief(self.radio)}; give a Radio, or None")
        if self.faults is not None:
            _check_schedule(self.faults)

    def check_team(self, robots: int) -> None:
        """Raise InputError if robots are killed, or something befalls them, that a team has not."""
        for k, (robot, _) in enumerate(self.kills):
            if robot >= robots:
                raise InputError(f"kills[{k}]: there is no robot {robot}; they are 0 to {robots - 1}")
        if self.faults is not None:
            check_faults(self.faults, robots, self.faults_from or "faults")

    @property
    def ideal(self) -> bool:
        """Links neither fail nor lose anything, so that nobody has to look after them."""
        return self.radio is None and self.faults is None and self.link_loss == 0.0

    @property
    def apart(self) -> bool:
        """Nobody tells anybody anything: each robot is a team of one."""
        return False


def _is_time(value: object) -> bool:
    return is_number(value) and value >= 0.0


def _check_kills(kills: Sequence[tuple[int, float]]) -> None:
    if not isinstance(kills, tuple | list):
        raise InputError(f"kills is {brief(kills)}; give a tuple of (robot index, time [s])")
    for k, kill in enumerate(kills):
        pair = isinstance(kill, tuple | list) and len(kill) == 2
        if not pair or not is_whole(kill[0]) or kill[0] < 0 or not _is_time(kill[1]):
            raise InputError(
                f"kills[{k}] must be a robot's index and a time [s], both >= 0; got {brief(kill)}"
            )


def _check_schedule(faults: Schedule) -> None:
    """Raise InputError for a schedule that no file could have."""
    if not isinstance(faults, Schedule):
        raise InputError(f"faults is {brief(faults)}; give a Schedule, or None")
    try:
        plain = to_builtins(faults)
    except (TypeError, ValueError) as error:
        raise InputError(f"faults: {error}; give faults of vedette.sim.faults") from None
    as_scenario(plain, Schedule, "faults")
