"""The planners by name, the house's and somebody's own: an objective's time layers and a kind of platform."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from vedette.domains.mapping import layers
from vedette.domains.mapping.baselines.cost_utility import CostUtilityPlatform
from vedette.domains.mapping.baselines.greedy import GreedyPlatform
from vedette.domains.mapping.baselines.hungarian import HungarianPlatform
from vedette.domains.mapping.baselines.makespan import MakespanPlatform
from vedette.domains.mapping.baselines.optimal import MOST_ROBOTS, OptimalPlatform
from vedette.domains.mapping.baselines.team import check_size
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.layers import TimeLayers
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.price import FREE, EndPrice
from vedette.domains.mapping.stops import Stops
from vedette.domains.mapping.tour import Tour
from vedette.domains.mapping.views import MOST_STOPS
from vedette.domains.mapping.yardsticks import BurgardPlatform, NearestPlatform
from vedette.errors import brief
from vedette.number import is_number, is_whole
from vedette.parts import PartKind, telling, told
from vedette.team import PlatformSpec

HIDDEN_AREA = 0.5  # expected behind a frontier [m^2]
RETURN_PRICE = 0.3  # more for a frontier that somebody will have to come back for [m^2 a metre]
WORLDS = 3  # of a planner that predicts; what it sends and works out grows with them
MOST_WORLDS = 8
LARGEST = 1e6  # area that a frontier may stand for [m^2], and price of a metre [m^2]


@dataclass(frozen=True)
class Planner:
    """How a team plans: what observations are worth when, and what each platform considers."""

    summary: str
    layers: TimeLayers
    platform: Callable[[PlatformSpec], MappingPlatform]
    hidden: float = 0.0  # area expected behind a frontier [m^2]
    return_price: float = 0.0  # more for a frontier far from others [m^2 a metre]
    end_price: EndPrice = FREE  # of tours [m^2/s], [m^2/s^2]
    worlds: int = 1  # ways at once in which what is unknown may be, by what the building showed
    turn: float = math.inf  # prices and tours count once frontiers promise less than this [m^2]; 0: never
    alone: str | None = None  # the planner of a team of one; None: the same
    scheme: str | None = None  # the negotiation that is part of the planner; None: any
    negotiates: bool = True  # what a platform chooses hangs on what the others tell it
    most_robots: int | None = None  # None: any number


def _tours(
    summary: str,
    turn: float = math.inf,
    return_price: float = RETURN_PRICE,
    alone: str | None = None,
    kind: type[MappingPlatform] = MappingPlatform,
    scheme: str | None = None,
    worlds: int = 1,
) -> Planner:
    """Return a planner that makes tours once frontiers promise less than ``turn``, until then as ``rate``."""
    return Planner(
        summary,
        layers.rate(start=5.0),
        lambda spec: kind(spec, max_stops=6, measured="unknown", foresees=True),
        hidden=HIDDEN_AREA,
        return_price=return_price,
        worlds=worlds,
        turn=turn,
        alone=alone,
        scheme=scheme,
    )


def _single(spec: PlatformSpec) -> MappingPlatform:
    """Return a platform that considers one frontier, as the paper's do."""
    return MappingPlatform(spec, max_stops=1, measured="distance")


PLANNERS = {
    "tours": _tours(
        "tours of frontiers with arrival times, negotiated; alone, a route (default)", alone="makespan"
    ),
    "predicted": _tours(
        "as tours, by what may lie behind frontiers, as this building showed", alone="makespan", worlds=WORLDS
    ),
    "information": _tours("information first; then tours of what was left behind", turn=1.4),
    "completion": _tours("completion first: tours, dearer to come back to what is left", return_price=2.0),
    "long": Planner(
        "tours of all frontiers within reach, whose end has a price; alone, a route",
        layers.fading(60.0, 10.0),
        lambda spec: MappingPlatform(spec, max_stops=MOST_STOPS, measured="unknown", foresees=True),
        hidden=HIDDEN_AREA,
        end_price=EndPrice(0.03, 0.001),
        alone="makespan",
    ),
    "rate": Planner(
        "one frontier each by the rate of uncertainty reduction, negotiated (the paper, eq. 42)",
        layers.rate(),
        _single,
    ),
    "entropy": Planner(
        "one frontier each by expected posterior entropy, negotiated (the paper, eq. 41)",
        layers.plain(),
        _single,
    ),
    "jacobi": Planner(
        "as rate, all replying at once (the paper, Table 1)", layers.rate(), _single, scheme="jacobi"
    ),
    "greedy": _tours(
        "as tours, each replying once to those before it (sequential greedy)",
        kind=GreedyPlatform,
        scheme="token",
    ),
    "optimal": Planner(
        f"as rate, the joint optimum by search; at most {MOST_ROBOTS} robots",
        layers.rate(),
        lambda spec: OptimalPlatform(spec, max_stops=1, measured="distance"),
        negotiates=False,
        most_robots=MOST_ROBOTS,
    ),
    "nearest": Planner(
        "nearest frontier, uncoordinated (Yamauchi)", layers.plain(), NearestPlatform, negotiates=False
    ),
    "cost-utility": Planner(
        "area against path length, uncoordinated (Gonzalez-Banos & Latombe)",
        layers.plain(),
        CostUtilityPlatform,
        negotiates=False,
    ),
    "burgard": Planner(
        "coordinated assignment of frontiers (Burgard et al.)",
        layers.plain(),
        BurgardPlatform,
        negotiates=False,
    ),
    "hungarian": Planner(
        "assignment of frontiers with the least total path (Kuhn; Wurm et al.)",
        layers.plain(),
        HungarianPlatform,
        negotiates=False,
    ),
    "makespan": Planner(
        "routes through all frontiers, the longest as short as can be (min-max salesmen)",
        layers.plain(),
        MakespanPlatform,
        negotiates=False,
    ),
}

DEFAULT = "tours"


def _wrong(part: Any) -> str | None:
    if not isinstance(part, Planner):
        return f"is {type(part).__name__}, not a Planner"
    if not isinstance(part.layers, TimeLayers) or not callable(part.platform):
        return "needs layers, a TimeLayers, and a platform that can be called with a PlatformSpec"
    if not isinstance(part.end_price, EndPrice):
        return f"has {brief(part.end_price)} as end_price, not an EndPrice"
    for name in ("hidden", "return_price", "turn"):
        value = getattr(part, name)
        if not (is_number(value) and 0.0 <= value <= LARGEST) and not (name == "turn" and value == math.inf):
            return f"has {brief(value)} as {name}, not a number from 0 to {LARGEST:g}"
    if not (is_whole(part.worlds) and 1 <= part.worlds <= MOST_WORLDS):
        return f"has {brief(part.worlds)} as worlds, not a whole number from 1 to {MOST_WORLDS}"
    if part.most_robots is not None and not (is_whole(part.most_robots) and part.most_robots > 0):
        return f"has {brief(part.most_robots)} as most_robots, not a whole number > 0 or None"
    return None


PLANNER: PartKind[Planner] = PartKind("planners", "planner", PLANNERS, _wrong, "docs/how-to/own-planner.md")


def planner(name: str, robots: int | None = None) -> Planner:
    """Return the planner of this name, for a team of so many if that is known.

    Raises:
        InputError: there is none, or it cannot plan for so many.
    """
    found = PLANNER.find(name)
    if found.most_robots is not None and robots is not None:
        check_size(name, robots, found.most_robots)
    if found.alone is not None and robots == 1:
        return planner(found.alone)
    return found if name in PLANNERS else replace(found, platform=_told(found, name))


def _told(own: Planner, name: str) -> Callable[[PlatformSpec], MappingPlatform]:
    """Return what makes the platforms of somebody's own planner; what they do wrong is told in a line."""
    where = f"planner {name}"

    def made(spec: PlatformSpec) -> MappingPlatform:
        with telling(f"{where}: platform"):
            platform = own.platform(spec)
            _check_is(MappingPlatform)(platform)
            if not hasattr(platform, "left_alone"):
                raise TypeError("its __init__ does not call that of MappingPlatform")

        def prepared(_: Any) -> None:
            if not isinstance(platform.stops, Stops | None):
                raise TypeError(f"leaves {type(platform.stops).__name__} in self.stops; Stops are asked for")

        return told(platform, {**CONTRACT, "prepare": prepared}, where)

    return made


def _check_is(kind: type) -> Callable[[Any], None]:
    def check(returned: Any) -> None:
        if not isinstance(returned, kind):
            raise TypeError(f"gives {type(returned).__name__}; a {kind.__name__} is asked for")

    return check


def _check_slack(returned: Any) -> None:
    if not is_number(returned) and returned != math.inf:
        raise TypeError(f"gives {returned!r}; a number of nats is asked for, inf where nothing is promised")


CONTRACT = {
    "carry_over": _check_is(Tour),
    "reply": _check_is(Tour),
    "impact": _check_is(Impact),
    "slack": _check_slack,
}  # what a round asks of a platform, and what it must return
