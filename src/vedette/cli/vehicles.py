"""What the commands of teams of vehicles share: a scenario, and options that say how they work together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import click

from vedette.cli.options import FILE, OneOf, Positive, seed_option, with_options
from vedette.missions.pairs import SCHEME
from vedette.negotiation import SCHEMES

Adding: TypeAlias = Callable[[Callable[..., Any]], Callable[..., Any]]


def vehicle_options(
    seeds: str,
    coordinations: Sequence[str],
    fusions: Sequence[str],
    *own: Adding,
    decide: str = "How the vehicles decide.",
) -> Adding:
    """``SCENARIO`` and how its vehicles decide, negotiate and share; ``own``: what a domain adds.

    ``seeds``: what a seed decides, and ``decide``: what is chosen of ``coordinations``, for the help.
    """
    return lambda command: with_options(
        command,
        click.argument("scenario_path", metavar="[SCENARIO]", required=False, type=FILE),
        seed_option(seeds),
        click.option(
            "--coordination", type=OneOf(coordinations), default="negotiated", show_default=True, help=decide
        ),
        click.option("--scheme", type=OneOf(SCHEMES), help=f"How they negotiate.  [default: {SCHEME}]"),
        click.option(
            "--fusion", type=OneOf(fusions), default="replicated", show_default=True,
            help="How they share what they see.",
        ),
        *own,
        click.option(
            "--max-time", type=Positive("s"),
            help="Simulated time limit [s].  [default: the scenario's duration]",
        ),
    )  # fmt: skip
