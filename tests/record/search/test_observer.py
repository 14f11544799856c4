"""The observer of searching measures from views alone, wherever they come from; figures counted by hand."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.search_missions import BOX, case
from vedette.domains.search.prediction import predicted
from vedette.missions.flying import RoundTimes
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.search.searching import Declared
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures, RoundFigures
from vedette.record.log import Floats
from vedette.record.search.curves import ideal
from vedette.record.search.log import SearchSample
from vedette.record.search.observer import Hiding, SearchObserver, SearchView, first_declared
from vedette.record.search.summary import SearchSummary
from vedette.record.summary import Setting, Timing

CASE = case(detector=BOX)
TEAM = SearchTeam(CASE, SearchOptions(), RoundTimes(0.02, 0.03))
DT, RADIUS = CASE.pdf.dt, TEAM.plan.radius
TARGET = 600.0, 400.0
TIMING = Timing(planning_ms=None, answer_ms=None, round_ms=None, real_time_factor=1.0, wall_s=1.0)
LOOKS = (  # by vehicle: poses by the step at whose end they count
    {1: np.array([(800.0, 350.0, 0.0)]), 2: np.array([(800.0, 350.0, 0.0), (760.0, 350.0, 0.0)])},
    {2: np.array([(350.0, 450.0, 0.0)])},
    {},
)


def place(step: int) -> Floats:
    """A target that does not move."""
    return np.array(TARGET)


def views(
    *declared: Declared | None, first: int = 0, figures: RobotFigures | None = None
) -> list[SearchView]:
    """Three vehicles, of which the first ones are dead."""
    told = [*declared, None, None, None][:3]
    return [
        SearchView(
            SearchSample(100.0 * i, 0.0, 0.0, "flying", i >= first, np.empty((0, 2)), None),
            CASE.pdf if i == first else None,
            word,
            figures or RobotFigures(),
        )
        for i, word in enumerate(told)
    ]


def observer() -> SearchObserver:
    """Of a team that has not begun."""
    return SearchObserver(TEAM, CASE.scenario.duration, Setting(seed=5), Hiding(place, LOOKS))


def ended(outcome: Outcome, *declared: Declared | None, now: float = 2.0 * DT) -> SearchSummary:
    """The summary of a search of two steps that ends so."""
    looking = observer()
    for _ in range(2):
        looking.look(views())
    looking.finish(now, views(*declared))
    return looking.report(outcome, TIMING, now, ideal(CASE, 11)).summary


def found(x: float, y: float, time: float = DT, certain: bool = False) -> Declared:
    """Somebody's word."""
    return Declared(x, y, time, certain)


def test_detection_is_what_all_looks_so_far_have_taken_from_the_prior() -> None:
    looking = observer()
    for _ in range(4):
        looking.look(views())
    curve = [snapshot.detection for snapshot in looking.log.snapshots]
    np.testing.assert_array_equal(curve, predicted(CASE.pdf, CASE.detectors, LOOKS, 3).detection)
    assert curve[0] == 0.0 < curve[1] < curve[2] == pytest.approx(curve[3], abs=1e-12)
    assert [snapshot.target for snapshot in looking.log.snapshots] == [TARGET] * 4


def test_the_pdf_shown_is_that_of_the_vehicle_that_tells_one() -> None:
    looking = observer()
    looking.look(views(first=2))
    (snapshot,) = looking.log.snapshots
    np.testing.assert_array_equal(snapshot.mass, CASE.pdf.mass.astype(np.float32))
    assert snapshot.entropy == CASE.pdf.entropy
    assert [vehicle.alive for vehicle in snapshot.vehicles] == [False, False, True]


def test_the_step_in_which_a_search_ends_is_logged_if_it_has_begun() -> None:
    for now, steps in ((2.0 * DT, 3), (2.0 * DT - 0.5, 2)):
        looking = observer()
        for _ in range(2):
            looking.look(views())
        looking.finish(now, views())
        assert looking.log.step == steps


def test_a_detection_goes_before_a_belief_then_the_earlier_then_the_first_vehicle() -> None:
    early, sure = found(0.0, 0.0, 1.0), found(0.0, 0.0, 9.0, certain=True)
    assert first_declared([None, early, sure]) == (2, sure)
    assert first_declared([found(0.0, 0.0, 2.0), early, None]) == (1, early)
    assert first_declared([early, early, None]) == (0, early)
    assert first_declared([None, None, None]) is None


@pytest.mark.parametrize("certain", [False, True])
@pytest.mark.parametrize("off", [0.0, 0.99, 1.01])
def test_a_declared_place_is_right_within_the_radius_or_by_a_sure_detection(
    off: float, certain: bool
) -> None:
    right = certain or off < 1.0
    summary = ended(Outcome.COMPLETE, None, found(TARGET[0] + off * RADIUS, TARGET[1], certain=certain))
    assert summary.outcome is (Outcome.FOUND if right else Outcome.MISTAKEN)
    assert summary.completed is right
    assert (summary.found_s, summary.found_by) == ((DT, "vehicle-2") if right else (None, None))
    assert summary.declared_m == (TARGET[0] + off * RADIUS, TARGET[1])
    assert summary.error_m == pytest.approx(off * RADIUS)


def test_a_search_that_ends_otherwise_says_why_whatever_was_declared() -> None:
    for outcome in (Outcome.TIME_LIMIT, Outcome.TEAM_LOST, Outcome.INTERRUPTED):
        assert ended(outcome, found(*TARGET)).outcome is outcome
        assert ended(outcome).declared_m is None


def test_the_summary_counts_what_the_vehicles_tell_in_the_end() -> None:
    looking = observer()
    looking.look(views())
    looking.finish(0.5 * DT, views(figures=RobotFigures(7.0, RoundFigures(2, 3, 1, 0.5))))
    summary = looking.report(Outcome.TIME_LIMIT, TIMING, 0.5 * DT, ideal(CASE, 11)).summary
    assert summary.path_m == {"vehicle-1": 7.0, "vehicle-2": 7.0, "vehicle-3": 7.0}
    assert (summary.rounds, summary.sweeps, summary.bound_ratio) == (2, 3, 0.5)
    assert (summary.seed, summary.coordination, summary.worth) == (5, "negotiated", CASE.scenario.worth)
    assert (summary.detection, summary.counted, summary.comparison) == (None, None, {})
    assert (summary.duration_s, summary.detection_then) == (11 * DT, 0.0)
