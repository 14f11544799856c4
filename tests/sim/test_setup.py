"""What simulations are given from Python is used as it is meant, or refused in one line before they begin."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.junk import JUNK, assert_done_or_refused
from tests.support.search_missions import case
from tests.support.small_missions import robots, small_maze
from tests.support.track_scenes import scenario
from vedette import InputError
from vedette.sim.explore import run
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.faults import Schedule
from vedette.sim.faults.kinds import Crash, Cut, Loss, Skew
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.track.simulation import TrackSetup, TrackSimulation
from vedette.team import PlatformSpec

SETUPS = [ExploreSetup, TrackSetup, SearchSetup]
prepare: Any = run.prepare  # given what no type allows

FIELDS: list[tuple[dict[str, Any], str]] = [
    ({"scheme": "tokn"}, "unknown scheme 'tokn'; did you mean 'token'?"),
    ({"seed": -1}, "seed must be a whole number >= 0; got -1"),
    ({"seed": 1.0}, "seed must be a whole number >= 0; got 1.0"),
    ({"max_time": -1.0}, "max_time must be a number of seconds >= 0; got -1.0"),
    ({"max_time": float("inf")}, "max_time must be a number of seconds >= 0; got inf"),
    ({"max_time": None}, "max_time must be a number of seconds >= 0; got None"),
    ({"link_delay": -0.02}, "link_delay must be a number of seconds >= 0; got -0.02"),
    ({"link_delay": float("nan")}, "link_delay must be a number of seconds >= 0; got nan"),
    ({"link_loss": 1.0}, "link_loss must be a number >= 0 and < 1; got 1.0"),
    ({"link_loss": -0.1}, "link_loss must be a number >= 0 and < 1; got -0.1"),
    ({"link_loss": "5 %"}, "link_loss must be a number >= 0 and < 1; got '5 %'"),
    ({"kills": 3}, "kills is 3; give a tuple of (robot index, time [s])"),
    ({"kills": {0: 3.0}}, "kills is {0: 3.0}; give a tuple of (robot index, time [s])"),
    ({"kills": (0, 3.0)}, "kills[0] must be a robot's index and a time [s], both >= 0; got 0"),
    (
        {"kills": ((0, 3.0), (1, -3.0))},
        "kills[1] must be a robot's index and a time [s], both >= 0; got (1, -3.0)",
    ),
    ({"kills": ((-1, 3.0),)}, "kills[0] must be a robot's index and a time [s], both >= 0; got (-1, 3.0)"),
    ({"kills": ((0.5, 3.0),)}, "kills[0] must be a robot's index and a time [s], both >= 0; got (0.5, 3.0)"),
    (
        {"kills": ((0, float("inf")),)},
        "kills[0] must be a robot's index and a time [s], both >= 0; got (0, inf)",
    ),
    ({"radio": 12.0}, "radio is 12.0; give a Radio, or None"),
    ({"faults": 7}, "faults is 7; give a Schedule, or None"),
    (
        {"faults": Schedule((Loss(at=-1.0, share=0.5),))},
        "faults: faults[0].at: must be a number from 0 to 86400; got -1.0",
    ),
    (
        {"faults": Schedule((Loss(at=1.0, share=float("nan")),))},
        "faults: faults[0].share: must be a number from 0 to 1; got nan",
    ),
]


@pytest.mark.parametrize("kind", SETUPS)
@pytest.mark.parametrize(("field", "line"), FIELDS, ids=[line[:40] for _, line in FIELDS])
def test_no_setup_holds_what_cannot_be(kind: Any, field: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError) as refused:
        kind(**field)
    assert str(refused.value) == line


LINES: list[tuple[Callable[[], object], str]] = [
    (lambda: prepare(small_maze(), [], ExploreSetup()), "the team is empty; give at least one PlatformSpec"),
    (lambda: prepare(small_maze(), 3, ExploreSetup()), "the team is 3; give a list of PlatformSpec"),
    (
        lambda: prepare(small_maze(), [PlatformSpec(), {"name": "b"}], ExploreSetup()),
        "platform 1 is {'name': 'b'}; give a PlatformSpec",
    ),
    (
        lambda: prepare(
            small_maze(), [PlatformSpec("a"), PlatformSpec("b"), PlatformSpec("a")], ExploreSetup()
        ),
        "platform 2: the name 'a' is used twice; names must differ",
    ),
    (
        lambda: prepare(small_maze(), robots(2), ExploreSetup(kills=((0, 1.0), (2, 3.0)))),
        "kills[1]: there is no robot 2; they are 0 to 1",
    ),
    (
        lambda: prepare(small_maze(), robots(2), ExploreSetup(faults=Schedule((Crash(at=1.0, robot=3),)))),
        "faults: faults[0].robot: there is no robot 3 in a team of 2",
    ),
    (
        lambda: prepare(small_maze(), robots(2), ExploreSetup(planner="turs")),
        "unknown planner 'turs'; did you mean 'tours'?",
    ),
    (
        lambda: prepare(small_maze(), robots(2), ExploreSetup(fusion="chanel")),
        "unknown fusion 'chanel'; did you mean 'channel'?",
    ),
    (
        lambda: TrackSimulation(scenario(), TrackSetup(kills=((9, 3.0),))),
        f"kills[0]: there is no robot 9; they are 0 to {len(scenario().vehicles) - 1}",
    ),
    (
        lambda: TrackSimulation(scenario(), TrackSetup(faults=Schedule((Cut(at=1.0, robots=(1, 1)),)))),
        "faults: faults[0].robots: must be two robots; both are 1",
    ),
    (
        lambda: SearchSimulation(case(), SearchSetup(kills=((3, 3.0),))),
        "kills[0]: there is no robot 3; they are 0 to 2",
    ),
    (
        lambda: TrackSetup(coordination="share"),
        "unknown coordination 'share'; did you mean 'shared'?",
    ),
    (
        lambda: SearchSetup(coordination="optimum"),
        "unknown coordination 'optimum'; known: none, shared, negotiated",
    ),
    (lambda: SearchSetup(fusion="sum"), "unknown fusion 'sum'; did you mean 'sums'?"),
    (
        lambda: SearchSetup(faults=Schedule((Skew(at=0.0, robot=1, s=3.0),))),
        "faults: fault skew: vehicles plan by a common clock; leave it out",
    ),
]


@pytest.mark.parametrize(("call", "line"), LINES, ids=[line[:40] for _, line in LINES])
def test_no_mission_is_prepared_that_cannot_be(call: Callable[[], object], line: str) -> None:
    with pytest.raises(InputError) as refused:
        call()
    assert str(refused.value) == line


NAMES = ["scheme", "seed", "max_time", "link_delay", "link_loss", "kills", "radio", "faults", "coordination"]


@settings(deadline=None, max_examples=300)
@given(place=st.sampled_from([*NAMES, "kill", "fault"]), junk=JUNK)
def test_anything_else_is_refused_too(place: str, junk: Any) -> None:
    nested: dict[str, dict[str, Any]] = {
        "kill": {"kills": ((0, 1.0), junk)},
        "fault": {"faults": Schedule((Loss(at=junk, share=0.5),))},
    }
    field = nested.get(place, {place: junk})
    assert_done_or_refused(lambda: SearchSetup(**field).check_team(2))


def test_a_generator_of_platforms_is_a_team() -> None:
    simulation = prepare(small_maze(), (spec for spec in robots(2)), ExploreSetup(seed=3))
    assert [spec.name for spec in simulation.specs] == [spec.name for spec in robots(2)]
