"""What an operator makes of the robots' reports."""

from __future__ import annotations

import numpy as np

from tests.fuzz.decoders import conditions
from tests.support.small_missions import room_with_a_wall
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.missions.track.scenario import default_scenario
from vedette.net.explore.content import content
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.flights import FlightsPlan
from vedette.net.track.watch import TrackWatcher
from vedette.outcome import Outcome
from vedette.record.summary import Setting, Timing
from vedette.sim.track.targets import Targets
from vedette.team import PlatformSpec


def test_robots_are_called_as_their_team_file_calls_them() -> None:
    world, specs = room_with_a_wall(0.1), [PlatformSpec(name="scout")]
    plan = ExplorePlan(world, specs, np.array([[1.0, 1.0, 0.0]]), ExploreOptions(), 0, 1.0)
    watcher = ExploreWatcher(plan, Setting(seed=0))
    (condition,) = conditions()
    classes = np.ones((4, 4), np.uint8)
    watcher.take(condition, content(world.frame, (slice(0, 4), slice(0, 4)), classes, classes > 0, None))
    watcher.look(1.0, [True], None)
    timing = Timing(planning_ms=None, answer_ms=None, round_ms=None, real_time_factor=1.0, wall_s=1.0)
    assert list(watcher.report(Outcome.COMPLETE, timing, 1.0).summary.path_m) == ["scout"]


def test_a_scenario_whose_vehicles_are_not_all_heard_in_the_end_is_not_called_complete() -> None:
    scenario = default_scenario()
    options = TrackOptions("negotiated", None, "replicated", None, False)
    team = TrackTeam(scenario, options, FlightsPlan("track", options, None, 4, 0, 1.0).times)
    watcher = TrackWatcher(team, "built-in", Setting(seed=0), Targets.of(team, 0).at)
    assert watcher.over(scenario.duration - 1.0, [], silent=True) is None
    assert watcher.over(scenario.duration, [], silent=True) is Outcome.UNHEARD
    assert watcher.over(scenario.duration, [], silent=False) is Outcome.COMPLETE
