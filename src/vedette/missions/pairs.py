"""Options that do not go together: refused, or told in a line, by whatever door they come in.

An option that is None, or what it is by default, is one that nobody gave.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

from vedette.domains.mapping.planners import planner
from vedette.errors import InputError, InputWarning, check_word
from vedette.negotiation import SCHEMES

SCHEME = "token"  # where nobody gave one
_USUAL = {
    "scheme": None,
    "fusion": "replicated",
    "radio": None,
    "link_delay": 0.02,
    "link_loss": 0.0,
    "lease": 3.0,
}


def scheme_of(planner_name: str, scheme: str | None) -> str:
    """Return how a team with this planner negotiates; ``scheme`` None: as the planner does, or by token.

    Raises:
        InputError: an unknown planner or scheme, or another scheme than the one that is part of the planner.
    """
    own = planner(planner_name).scheme
    if own is not None:
        check_word(f"scheme of planner {planner_name},", own, SCHEMES)
    if scheme is None:
        return own or SCHEME
    check_word("scheme", scheme, SCHEMES)
    if own not in (None, scheme):
        raise InputError(
            f"planner {planner_name} negotiates by {own}, which is part of it; leave out scheme {scheme}"
        )
    if not planner(planner_name).negotiates and scheme in ("multistart", "fork", "async"):
        return SCHEME  # these take back what lowers the team's value, which such a planner does not ask for
    return scheme


def tell_unheeded(planner_name: str, robots: int, scheme: str | None, **links: object) -> None:
    """Say which options are in vain where an exploring team has nobody to tell anything, or heeds nobody."""
    if robots == 1:
        _tell("one robot alone tells nobody anything", scheme=scheme, **links)
    elif not planner(planner_name).negotiates:
        why = f"planner {planner_name} chooses without negotiating"
        if scheme == "jacobi":
            warnings.warn(f"{why}; scheme jacobi asks it more than once", InputWarning, stacklevel=3)
        else:
            _tell(why, scheme=scheme)


def tell_unsaid(coordination: str, vehicles: int, scheme: str | None, **links: object) -> None:
    """Say which options are in vain since vehicles tell each other nothing, or nothing of their plans."""
    if vehicles == 1:
        _tell("one vehicle alone tells nobody anything", scheme=scheme, **links)
    elif coordination == "none":
        _tell("with coordination none nobody tells anybody anything", scheme=scheme, **links)
    elif coordination != "negotiated":
        _tell(f"with coordination {coordination} nobody negotiates", scheme=scheme)


def tell_duration(max_time: float | None, duration: float) -> None:
    """Say that a scenario is over before the time limit; both [s]."""
    if max_time is not None and max_time > duration:
        text = f"max-time {max_time:g} is beyond the scenario's end, {duration:g} s: it ends there"
        warnings.warn(text, InputWarning, stacklevel=3)


def tell_objective(objective: str | None, scenarios: str, usual: str) -> None:
    """Say that an objective replaces the one that a scenario names, if that is not the usual one."""
    if objective is not None and scenarios not in (objective, usual):
        text = f"objective {objective} replaces that of the scenario, {scenarios}"
        warnings.warn(text, InputWarning, stacklevel=3)


def tell_too_late(kills: Sequence[tuple[int, float]], max_time: float) -> None:
    """Say which robots, by index, would die when the mission is over; times [s]."""
    for robot, time in kills:
        if time > max_time:
            text = f"robot {robot + 1} does not die at {time:g} s: the mission is over after {max_time:g} s"
            warnings.warn(text, InputWarning, stacklevel=3)


def _tell(why: str, **options: object) -> None:
    idle = [name.replace("_", " ") for name, value in options.items() if value != _USUAL[name]]
    if idle:
        warnings.warn(f"{why}, whatever {', '.join(idle)}", InputWarning, stacklevel=4)
