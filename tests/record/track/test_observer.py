"""The observer of tracking measures from views alone, wherever they come from; figures counted by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.support.track_scenes import scenario
from vedette.domains.tracking.belief import Tracks
from vedette.missions.flying import RoundTimes
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures, RoundFigures
from vedette.record.log import Floats
from vedette.record.summary import Setting, Timing, Traffic
from vedette.record.track.log import TrackSample
from vedette.record.track.observer import TrackObserver, TrackView
from vedette.record.track.summary import consistency

TEAM = TrackTeam(scenario(), TrackOptions(), RoundTimes(0.02, 0.03))
PRIOR = TEAM.prior
TIMING = Timing(planning_ms=None, answer_ms=None, round_ms=None, real_time_factor=1.0, wall_s=1.0)


def truth(step: int) -> Floats:
    """Targets that are 3 m east and 4 m north of where they are taken to be, a metre more a step."""
    return np.asarray(PRIOR.means + np.array((3.0, 4.0 + step, 0.0, 0.0)))


def view(
    i: int,
    tracks: Tracks = PRIOR,
    alive: bool = True,
    seen: tuple[int, ...] = (),
    figures: RobotFigures | None = None,
) -> TrackView:
    """A vehicle that flies at its start."""
    sample = TrackSample(10.0 * i, 0.0, 0.0, "flying" if alive else "dead", alive, np.empty((0, 2)), seen)
    return TrackView(sample, tracks, i, figures or RobotFigures())


def observer() -> TrackObserver:
    """Of a team that has not begun."""
    return TrackObserver(TEAM, "test", Setting(seed=5, faults="storm.yaml"), truth)


def surer(factor: float) -> Tracks:
    """The prior, known so many times as well."""
    return replace(PRIOR, Y=factor * PRIOR.Y, y=factor * PRIOR.y)


def test_what_the_living_know_counts_and_the_first_of_them_is_shown() -> None:
    looking = observer()
    looking.look([view(0, surer(9.0), alive=False), view(1, surer(4.0)), view(2)])
    (snapshot,) = looking.log.snapshots
    assert snapshot.holder == 1
    np.testing.assert_allclose(snapshot.covariances[2, :2, :2], np.diag((625.0, 625.0)) / 4.0)
    alone = 5.0 * np.log(2.0 * np.pi * np.e) + 0.5 * np.log(20.0**8 * 25.0**4)  # d = 4 + 4 + 2
    assert snapshot.entropy == pytest.approx(alone - 0.5 * 0.5 * 10 * np.log(4.0))
    assert snapshot.squared_error == pytest.approx(25.0)
    once = (25.0 / 400.0 + 25.0 / 400.0 + 25.0 / 625.0) / 10.0
    assert snapshot.nees == pytest.approx((4.0 * once + once) / 2.0)


def test_of_a_team_of_the_dead_what_all_held_counts() -> None:
    looking = observer()
    looking.look([view(i, surer(1.0 + i), alive=False) for i in range(3)])
    assert looking.log.snapshots[0].holder == 0
    assert looking.log.snapshots[0].nees > 0.0


def test_tracks_of_an_earlier_step_are_predicted_to_the_one_that_is_looked_at() -> None:
    looking = observer()
    for _ in range(3):
        looking.look([view(i) for i in range(3)])
    dt = TEAM.scenario.step
    first, _, last = looking.log.snapshots
    assert (last.t, looking.log.step) == (2.0 * dt, 3)
    x, y, vx, vy = first.means[0]
    np.testing.assert_allclose(last.means[0], (x + 2 * dt * vx, y + 2 * dt * vy, vx, vy))
    np.testing.assert_array_equal(last.means[2], first.means[2])  # it is static
    assert last.entropy > first.entropy


def test_a_step_is_due_at_its_last_tick() -> None:
    looking, dt = observer(), TEAM.scenario.step
    assert not looking.log.due(dt - 0.2)
    assert looking.log.due(dt - 0.1)
    looking.look([view(i) for i in range(3)])
    assert not looking.log.due(dt)
    assert looking.log.due(2.0 * dt - 0.1)


def test_the_summary_counts_what_the_vehicles_tell_in_the_end() -> None:
    looking = observer()
    looking.look([view(0, seen=(0, 2)), view(1, seen=(2,)), view(2)])
    looking.look([view(i) for i in range(3)])
    team = [
        RobotFigures(3.0, RoundFigures(4, 9, 2, 1.5), Traffic(1, 2, 3, 4), Traffic(10, 20, 30, 40)),
        RobotFigures(5.0, RoundFigures(5, 8, 1, 0.3), Traffic(5, 6, 7, 8), Traffic(50, 60, 70, 80)),
        RobotFigures(),
    ]
    looking.finish([view(i, figures=each) for i, each in enumerate(team)])
    summary = looking.report(Outcome.TIME_LIMIT, TIMING, 2.5).summary
    assert (summary.completed, summary.outcome, summary.time_s) == (False, Outcome.TIME_LIMIT, 2.5)
    assert (summary.seed, summary.radio, summary.faults) == (5, None, "storm.yaml")
    assert (summary.coordination, summary.scheme, summary.fusion) == ("negotiated", "token", "replicated")
    assert (summary.objective, summary.continuous) == (TEAM.scenario.objective, False)
    assert (summary.vehicles, summary.targets, summary.steps, summary.skipped) == (3, 3, 2, 3)
    assert summary.in_view == {"target-1": 0.5, "target-2": 0.0, "target-3": 0.5}
    assert summary.in_view_mean == pytest.approx(1.0 / 3.0)
    assert summary.path_m == {"vehicle-1": 3.0, "vehicle-2": 5.0, "vehicle-3": 0.0}
    assert (summary.rounds, summary.sweeps, summary.bound_ratio) == (5, 8, pytest.approx(1.8 / 3))
    assert summary.messages["vehicle-2"] == Traffic(5, 6, 7, 8)
    assert summary.bytes["vehicle-1"].overlay == 40


def test_a_mission_that_ends_at_once_is_looked_at_once() -> None:
    looking = observer()
    looking.finish([view(i) for i in range(3)])
    looking.finish([view(i) for i in range(3)])
    assert looking.report(Outcome.INTERRUPTED, TIMING, 0.0).summary.steps == 1


def test_means_are_scored_from_step_1_on_and_say_whether_they_are_consistent() -> None:
    """At step 0 there is the prior, which ways of fusion tell before its looks or after."""
    looking = observer()
    for count in range(3):
        looking.look([view(i, surer(1.0 + 2.0 * count)) for i in range(3)])
    _, first, second = looking.log.snapshots
    summary = looking.report(Outcome.COMPLETE, TIMING, 3.0).summary
    assert summary.nees == pytest.approx((first.nees + second.nees) / 2)
    assert summary.entropy_mean_nat == pytest.approx((first.entropy + second.entropy) / 2)
    assert summary.position_rmse_m == pytest.approx(((first.squared_error + second.squared_error) / 2) ** 0.5)
    low, high = summary.nees_band
    assert summary.consistency == "cautious"
    assert consistency(1.0, (low, high)) == "consistent"
    assert consistency(high + 0.1, (low, high)) == "overconfident"
