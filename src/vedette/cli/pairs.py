"""Options that do not go together: refused, or told in a line, so that none is overridden in silence."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import click
from click.core import ParameterSource

from vedette.domains.mapping.planners import PLANNERS
from vedette.errors import InputError, InputWarning
from vedette.team import PlatformSpec

LINKS = {"scheme": "--scheme", "radio": "--radio", "link_loss": "--link-loss"}


def check_scheme(planner: str, scheme: str) -> None:
    """Refuse a ``--scheme`` other than that which is part of the planner.

    Raises:
        InputError: it is another one.
    """
    own = PLANNERS[planner].scheme
    if _given("scheme") and own not in (None, scheme):
        raise InputError(
            f"--planner {planner} negotiates by {own}, which is part of it; leave out --scheme {scheme}"
        )


def tell_what_needs_links(coordination: str) -> None:
    """Say which options are in vain, as the vehicles tell each other nothing."""
    idle = [option for name, option in LINKS.items() if _given(name)]
    if coordination == "none" and idle:
        _say(f"with --coordination none nobody tells anybody anything, whatever {', '.join(idle)}")


def tell_duration(max_time: float | None, duration: float) -> None:
    """Say that a scenario is over before ``--max-time``; both [s]."""
    if max_time is not None and max_time > duration:
        _say(f"--max-time {max_time:g} is beyond the scenario's end, {duration:g} s: it ends there")


def tell_moved(places: Sequence[object], specs: Sequence[PlatformSpec]) -> None:
    """Say whose start in the team file gives way to one of ``--starts``."""
    moved = [spec.name for spec, _ in zip(specs, places, strict=False) if spec.start is not None]
    if moved:
        _say(f"--starts replaces the team file's start of {', '.join(moved)}")


def _given(name: str) -> bool:
    """Tell whether the command was given an option, rather than takes its default."""
    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


def _say(text: str) -> None:
    warnings.warn(text, InputWarning, stacklevel=3)
