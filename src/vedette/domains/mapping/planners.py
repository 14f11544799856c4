"""The planners by name: an objective's time layers and a kind of platform."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vedette.domains.mapping import layers
from vedette.domains.mapping.layers import TimeLayers
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.yardsticks import BurgardPlatform, NearestPlatform
from vedette.errors import InputError, nearest_name
from vedette.team import PlatformSpec

HIDDEN_AREA = 2.0  # expected behind a frontier [m^2]
RETURN_PRICE = 1.0  # about half of what a robot maps while it drives a metre [m^2 a metre]


@dataclass(frozen=True)
class Planner:
    """How a team plans: what observations are worth when, and what each platform considers."""

    summary: str
    layers: TimeLayers
    hidden: float  # area expected behind a frontier [m^2]
    return_price: float  # more for a frontier far from others [m^2 a metre]
    platform: Callable[[PlatformSpec], MappingPlatform]


PLANNERS = {
    "tours": Planner(
        "tours of frontiers with arrival times, negotiated (default)",
        layers.rate(start=5.0),
        HIDDEN_AREA,
        RETURN_PRICE,
        lambda spec: MappingPlatform(spec, max_stops=6, measured="unknown"),
    ),
    "rate": Planner(
        "one frontier each by the rate of uncertainty reduction, negotiated (the paper, eq. 42)",
        layers.rate(),
        0.0,
        0.0,
        lambda spec: MappingPlatform(spec, max_stops=1, measured="distance"),
    ),
    "entropy": Planner(
        "one frontier each by expected posterior entropy, negotiated (the paper, eq. 41)",
        layers.plain(),
        0.0,
        0.0,
        lambda spec: MappingPlatform(spec, max_stops=1, measured="distance"),
    ),
    "nearest": Planner(
        "nearest frontier, uncoordinated (Yamauchi)", layers.plain(), 0.0, 0.0, NearestPlatform
    ),
    "burgard": Planner(
        "coordinated assignment of frontiers (Burgard et al.)", layers.plain(), 0.0, 0.0, BurgardPlatform
    ),
}


def planner(name: str) -> Planner:
    """Return the planner of this name.

    Raises:
        InputError: there is none.
    """
    if name not in PLANNERS:
        raise InputError(f"unknown planner {name!r}: {nearest_name(name, PLANNERS)}")
    return PLANNERS[name]
