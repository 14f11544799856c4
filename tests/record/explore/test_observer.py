"""The observer measures a team from views alone, wherever they come from; the figures are counted by hand."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rich.console import Console

from tests.support.small_missions import robots, run, small_maze
from vedette.agent.effects import TrafficKind as Kind
from vedette.domains.mapping.belief import LN2
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.leftovers import Leftover
from vedette.kernels.coverage import LAYERS
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.outcome import Outcome
from vedette.record.explore.log import RobotSample
from vedette.record.explore.observer import ExploreObserver
from vedette.record.explore.screen import screen
from vedette.record.explore.summary import LeftOut
from vedette.record.explore.views import GroundFigures, RobotView, held_map, left_out, union_map
from vedette.record.figures import RoundFigures
from vedette.record.links import Link
from vedette.record.summary import Setting, Traffic
from vedette.sim.explore.run import views

ROWS, COLS = 20, 30
WORLD = World(GridFrame(0.1, ROWS, COLS), np.zeros((ROWS, COLS), np.bool_), "hall")
SPECS = robots(3)
STARTS = np.array([(0.5, 0.5, 0.0), (1.0, 1.0, 0.0), (2.0, 1.0, 0.0)])
SETTING = Setting(seed=5, radio="12,3", faults="storm.yaml")
OPTIONS = ExploreOptions("tours", "token", "replicated")
NOTHING = np.zeros((ROWS, COLS), np.uint8)
CHAIN = (Link(0, 1, True, 0.0), Link(1, 2, True, 0.1), Link(0, 2, False, 0.5))
SPLIT = (Link(0, 1, True, 0.0), Link(1, 2, False, 0.9))


def view(
    i: int,
    classes: NDArray[np.uint8] = NOTHING,
    alive: bool = True,
    seen: NDArray[np.bool_] | None = None,
    impact: Impact | None = None,
    figures: GroundFigures | None = None,
    digest: int = 0,
) -> RobotView:
    """A robot seen at its start."""
    x, y, heading = STARTS[i].tolist()
    sample = RobotSample(x, y, heading, "idle", alive, np.empty((0, 2)), SPECS[i].name, None)
    own = classes != UNKNOWN if seen is None else seen
    frame = GridFrame(WORLD.frame.resolution, *classes.shape)
    return RobotView(sample, frame, classes, own, impact, figures or GroundFigures(), digest)


def columns(*known: int, kind: int = FREE) -> NDArray[np.uint8]:
    """A map of which some columns are known."""
    classes = NOTHING.copy()
    classes[:, list(known)] = kind
    return classes


def observer(lattice: Lattice | None = None) -> ExploreObserver:
    """Of a team that has not begun."""
    return ExploreObserver(WORLD, SPECS, STARTS, OPTIONS, SETTING, lattice=lattice)


def test_a_robot_holds_what_is_fused_and_its_own_cells_that_are_not_published_yet() -> None:
    fused = np.array([[UNKNOWN, UNKNOWN, UNKNOWN, FREE, OCCUPIED, FREE]], np.uint8)
    own = np.array([[-2, 4, 0, 4, -2, 0]], np.int8)
    held = held_map(fused, own)
    np.testing.assert_array_equal(held, [[FREE, OCCUPIED, UNKNOWN, FREE, OCCUPIED, FREE]])
    assert not np.shares_memory(held, fused)


@settings(deadline=None, max_examples=30)
@given(st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_the_union_knows_what_any_living_robot_holds_occupied_before_free(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    maps = rng.choice([UNKNOWN, FREE, OCCUPIED], (n, 3, 4)).astype(np.uint8)
    alive = rng.random(n) < 0.7
    team = [view(0, classes, bool(lives)) for classes, lives in zip(maps, alive, strict=True)]
    counted = maps[alive] if alive.any() else maps
    union = union_map(team, team[0].frame)
    for cell in np.ndindex(3, 4):
        held = set(counted[(slice(None), *cell)].tolist())
        expected = OCCUPIED if OCCUPIED in held else FREE if FREE in held else UNKNOWN
        assert union[cell] == expected


def test_coverage_and_entropy_are_those_of_the_living() -> None:
    looking = observer()
    dead = view(2, columns(*range(COLS)), alive=False)
    looking.look(0.0, [view(0, columns(0, 1)), view(1, columns(1, 2)), dead], None)
    last = looking.log.last
    assert last.coverage == pytest.approx(3 / COLS)
    assert last.known_fraction == pytest.approx(3 / COLS)
    assert last.entropy == pytest.approx((COLS - 3) * ROWS * LN2)
    assert last.links is None


def test_of_ground_that_nobody_knows_area_frontiers_and_rate_are_told_and_never_a_share() -> None:
    looking = observer(lattice=Lattice.open(WORLD.frame.resolution))
    rounds = replace(view(0, columns(0, 1, 2)), frontiers=4), replace(view(1, columns(2)), frontiers=5)
    dead = replace(view(2, columns(*range(COLS)), alive=False), frontiers=9)
    looking.look(0.0, [view(0), view(1), dead], None)
    looking.finish(4.0, [*rounds, dead], None)
    known = 3 * ROWS * 0.01
    last, summary = looking.log.last, looking.summary(Outcome.COMPLETE)
    assert (last.coverage, last.known_fraction, last.entropy) == (None, None, None)
    assert (last.known_m2, last.rate_m2_s, last.frontiers) == pytest.approx((known, known / 4.0, 5))
    assert np.isnan(looking.log.coverage).all()
    assert np.isnan(looking.log.frontiers[0])  # there has been no round
    for figure in ("coverage", "t50_s", "t90_s", "t95_s", "t99_s", "auc_s"):
        assert getattr(summary, figure) is None
    assert (summary.known_m2, summary.rate_m2_s, summary.frontiers) == pytest.approx((known, known / 4.0, 5))
    assert [stage.known_m2 for stage in looking.log.stages()] == pytest.approx([known] * 3)


def test_every_second_look_is_logged_and_so_is_the_end() -> None:
    looking = observer()
    team = [view(i) for i in range(3)]
    for k in range(4):
        looking.look(0.5 * k, team, CHAIN)
    looking.finish(1.7, team, SPLIT)
    looking.finish(1.7, team, SPLIT)
    assert looking.log.times.tolist() == [0.0, 1.0, 1.7]
    assert looking.log.last.links == SPLIT
    assert looking.log.last.parts == ((0, 1), (2,))


def test_time_apart_counts_from_the_look_that_found_the_team_apart_to_the_next() -> None:
    looking = observer()
    team = [view(i) for i in range(3)]
    without_third = [view(0), view(1), view(2, alive=False)]
    for now, robots_now, links in (
        (0.0, team, ()),  # apart until 0.5
        (0.5, team, CHAIN),
        (1.5, team, SPLIT),  # apart until 3
        (2.0, team, SPLIT),
        (3.0, without_third, SPLIT),  # those who live are together
        (4.0, team, None),
    ):
        looking.look(now, robots_now, links)
    looking.finish(9.0, team, SPLIT)
    assert looking.apart_s == pytest.approx(2.0)
    assert looking.summary(Outcome.COMPLETE).apart_s == pytest.approx(2.0)


def test_a_team_of_the_dead_is_not_apart_and_leaves_what_all_held() -> None:
    looking = observer()
    dead = [view(i, columns(i, kind=FREE + i % 2), alive=False) for i in range(3)]
    looking.look(0.0, dead, ())
    looking.finish(2.0, dead, ())
    assert looking.apart_s == 0.0
    np.testing.assert_array_equal(looking.delivered_map(), union_map(dead, WORLD.frame))
    assert looking.log.last.coverage == pytest.approx(3 / COLS)


def test_the_map_delivered_is_that_of_the_living_robot_that_knows_most() -> None:
    looking = observer()
    little, much, most = columns(0), columns(1, 2), columns(3, 4, 5)
    looking.finish(1.0, [view(0, little), view(1, much), view(2, most, alive=False)], SPLIT)
    np.testing.assert_array_equal(looking.delivered_map(), much)


def test_the_team_impact_is_that_one_of_the_living_observes_the_cell() -> None:
    cells = np.array((0, 7), np.uint32)
    own = Impact(cells * LAYERS, np.array((16, 255), np.uint8))  # log-misses of 1 nat, and certain
    mate = Impact(cells[:1] * LAYERS + 1, np.array((32,), np.uint8))  # of 2 nat
    looking = observer()
    looking.look(0.0, [view(0, impact=own), view(1, impact=mate), view(2, alive=False, impact=own)], None)
    impact = looking.log.last.impact
    assert impact is not None
    expected = np.zeros(impact.size)
    expected[[0, 7]] = 1.0 - np.exp(-3.0), 1.0
    np.testing.assert_allclose(impact.ravel(), expected, atol=1 / 255)


def test_the_summary_adds_up_what_the_robots_have_counted() -> None:
    team = [
        GroundFigures(3.0, RoundFigures(4, 9, 2, 1.5), Traffic(1, 2, 3, 4), Traffic(10, 20, 30, 40), 1, 0.4),
        GroundFigures(5.0, RoundFigures(5, 8, 1, 0.3), Traffic(5, 6, 7, 8), Traffic(50, 60, 70, 80), 0, 0.1),
        GroundFigures(1.5, collisions=2, min_clearance_m=0.3),
    ]
    seen = [columns(0, 1, 2) > 0, columns(2, 3) > 0, columns() > 0]
    looking = observer()
    everything = columns(*range(COLS))
    looking.look(0.0, [view(i) for i in range(3)], CHAIN)
    looking.finish(
        8.0, [view(i, everything, i < 2, seen[i], figures=each) for i, each in enumerate(team)], SPLIT
    )
    summary = looking.summary(Outcome.TIME_LIMIT)
    assert (summary.completed, summary.outcome, summary.robots) == (False, Outcome.TIME_LIMIT, 3)
    assert (summary.seed, summary.planner, summary.scheme) == (5, "tours", "token")
    assert (summary.fusion, summary.world) == ("replicated", "hall")
    assert (summary.radio, summary.faults) == ("12,3", "storm.yaml")
    assert (summary.time_s, summary.t50_s, summary.t99_s) == (8.0, 8.0, 8.0)
    assert (summary.coverage, summary.auc_s) == (1.0, 8.0)
    assert summary.path_m == {"robot-1": 3.0, "robot-2": 5.0, "robot-3": 1.5}
    assert (summary.collisions, summary.min_clearance_m) == (3, 0.1)
    assert (summary.rounds, summary.sweeps) == (5, 8)
    assert summary.bound_ratio == pytest.approx(1.8 / 3)
    assert summary.overlap == pytest.approx(1 / 4)
    assert summary.messages["robot-2"] == Traffic(5, 6, 7, 8)
    assert summary.bytes["robot-1"].overlay == 40


def test_what_robots_gave_up_is_listed_unless_somebody_knows_it_by_now() -> None:
    spots = [Leftover(0.55, 0.55, 40, "unseeable"), Leftover(2.05, 1.05, 30, "unreached")]
    first, second = left_out(spots[:1], "robot-1"), left_out(spots, "robot-2")
    team = [
        replace(view(0, columns(0, 1)), left_out=first),
        replace(view(1, columns(*range(13))), left_out=second),
        view(2, columns(29), alive=False),
    ]
    looking = observer()
    looking.finish(1.0, team, None)
    reach = 0.6  # [m] to each side of a spot
    unknown = sum(abs(0.1 * (col + 0.5) - 2.05) < reach + 0.05 and col > 12 for col in range(COLS))
    rows = sum(abs(0.1 * (row + 0.5) - 1.05) < reach + 0.05 for row in range(ROWS))
    assert looking.summary(Outcome.COMPLETE).left_out == (
        LeftOut(2.05, 1.05, unknown * rows, "unreached", "robot-2"),
    )


def test_traffic_has_a_field_for_every_kind_that_agents_send() -> None:
    assert [field.name for field in fields(Traffic)] == [kind.value for kind in Kind]


def test_a_simulated_team_is_seen_as_it_is() -> None:
    simulation, report = run(small_maze(), robots(2), max_time=12.0)
    team = views(simulation)
    for i, robot in enumerate(team):
        assert (robot.sample.x, robot.sample.y, robot.sample.heading) == simulation.pose(i)
        own = simulation.missions[i].own.log_odds.window()
        np.testing.assert_array_equal(robot.seen_on(simulation.world.frame), own != 0)
        assert (robot.classes[robot.seen] != UNKNOWN).all()
        assert not np.shares_memory(robot.classes, simulation.missions[i].fusion.classes.blocks)
        assert robot.figures.travelled_m == report.summary.path_m[robot.sample.name]
        assert robot.figures.messages == report.summary.messages[robot.sample.name]
    assert report.summary.apart_s == 0.0
    assert report.log.last.links is None


def test_live_view_curves_and_summary_tell_the_same_metres() -> None:
    _, report = run(small_maze(), robots(2), max_time=20.0)
    driven = {robot.name: robot.driven for robot in report.log.last.robots}
    assert driven == report.summary.path_m
    assert report.log.path_length[-1].tolist() == list(driven.values())
    assert (np.diff(report.log.path_length, axis=0) >= 0.0).all()
    assert min(driven.values()) > 1.0
    console = Console(width=100, height=40, color_system=None)
    with console.capture() as shown:
        console.print(screen(report.log.scene, console, report.log.last))
    assert all(f"{metres:.1f}" in shown.get() for metres in driven.values())
