"""A mission ends for the right reason: complete, unreached or enclosed."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from msgspec import structs

from tests.fuzz.decoders import conditions
from tests.support.small_missions import robots, room_with_a_wall, run, two_rooms
from vedette import outcome
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.watch import ExploreWatcher
from vedette.outcome import Outcome, together
from vedette.record.explore.score import Reference
from vedette.record.summary import Setting
from vedette.sim.faults import Schedule
from vedette.sim.faults.kinds import Heal, Partition
from vedette.study.run import GeneratedWorld
from vedette.team import PlatformSpec


def slit(side: float) -> World:
    """A cell of about so many metres a side, and a slit of 0.1 m in the wall between it and a room."""
    cells = round(side / 0.05)
    solid = np.ones((cells + 4, cells + 64), bool)
    solid[2:-2, 2 : 2 + cells] = False
    solid[2:-2, 4 + cells : -2] = False
    solid[1 + cells // 2 : 3 + cells // 2, 2 + cells : 4 + cells] = False
    return World(GridFrame(0.05, *solid.shape), solid, "slit")


def test_a_robot_that_cannot_move_and_sees_a_frontier_is_enclosed() -> None:
    _, report = run(slit(0.45), [PlatformSpec(start=(0.325, 0.325))], seed=1)
    summary = report.summary
    assert summary.outcome is Outcome.ENCLOSED
    assert summary.path_m["robot-1"] < 0.1
    assert {spot.why for spot in summary.left_out} >= {"out_of_reach"}


def test_a_room_behind_a_slit_is_out_of_reach_and_the_mission_complete() -> None:
    _, report = run(slit(3.0), [PlatformSpec(start=(1.0, 1.0))], seed=1)
    summary = report.summary
    assert summary.outcome is Outcome.COMPLETE
    assert summary.left_out
    assert {spot.why for spot in summary.left_out} <= {"out_of_reach", "unseeable"}


def test_a_robot_in_a_closed_cell_has_nothing_left_to_see() -> None:
    solid = np.pad(np.zeros((9, 9), bool), 2, constant_values=True)
    world = World(GridFrame(0.05, *solid.shape), solid, "cell")
    _, report = run(world, [PlatformSpec(start=(0.325, 0.325))], seed=1)
    assert report.summary.outcome is Outcome.COMPLETE
    assert report.summary.coverage == 1.0
    assert not report.summary.left_out


def test_what_lies_behind_a_dead_mate_in_the_only_way_is_unreached() -> None:
    specs = [
        PlatformSpec(name="blocker", start=(3.85, 1.6)),
        PlatformSpec(name="worker", start=(2.0, 1.6)),
    ]
    _, report = run(two_rooms(0.6, 0.05), specs, seed=1, kills=((0, 0.5),))
    summary = report.summary
    assert summary.outcome is Outcome.UNREACHED
    assert summary.outcome.status == 1
    assert "unreached" in {spot.why for spot in summary.left_out}
    assert summary.coverage < 0.9


@pytest.mark.parametrize(
    ("reach", "radius", "resolution", "most"),
    [
        (0.25, 0.2, 0.05, 0.2),
        (0.2, 0.3, 0.05, 0.2),
        (0.3, 0.2, 0.05, 0.2),
        (0.3, 0.25, 0.05, 0.2),
        (0.4, 0.3, 0.05, 0.2),
        (0.5, 0.5, 0.02, 0.2),
        (0.6, 0.5, 0.02, 0.2),
        (0.35, 0.2, 0.1, 0.9),  # a cell and a half beyond its rim
    ],
)
def test_a_lidar_that_sees_hardly_farther_than_its_robot_completes_nothing(
    reach: float, radius: float, resolution: float, most: float
) -> None:
    world = room_with_a_wall(resolution)
    _, report = run(world, robots(1, range=reach, radius=radius), seed=1, max_time=1800.0)
    assert report.summary.coverage < most
    assert report.summary.outcome in (Outcome.ENCLOSED, Outcome.UNREACHED)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_robot_that_sees_two_cells_beyond_its_rim_explores_a_room_and_says_what_it_did_not_reach(
    seed: int,
) -> None:
    spec = robots(1, range=0.25, radius=0.1)
    _, report = run(room_with_a_wall(0.1), spec, seed=seed, max_time=1800.0)
    summary = report.summary
    assert 0.99 < summary.coverage < 1.0
    assert summary.outcome is Outcome.UNREACHED
    assert "unreached" in {spot.why for spot in summary.left_out}


def test_robots_that_are_done_come_to_hold_one_map_though_cells_flicker_before_them() -> None:
    world = GeneratedWorld("cave", 455, 30.0, 20.0, 0.1).build()
    _, report = run(world, robots(3), planner="burgard")
    assert report.summary.outcome is Outcome.COMPLETE


@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize(("width", "resolution"), [(0.45, 0.05), (0.5, 0.05), (0.46, 0.02), (0.48, 0.03)])
def test_a_corridor_little_wider_than_the_robot_is_reachable_to_score_and_driver_alike(
    width: float, resolution: float, bent: bool
) -> None:
    world = two_rooms(width, resolution, bent=bent)
    specs = [PlatformSpec(start=(1.0, 1.0))]
    simulation, report = run(world, specs, seed=1)
    beyond = np.zeros_like(world.solid)
    beyond[:, -round(3.0 / resolution) :] = True
    behind = Reference(world, specs, simulation.starts).coverable & beyond
    assert behind.sum() > 0.95 * (beyond & ~world.solid).sum()
    assert report.summary.completed
    assert report.summary.coverage >= 0.99
    assert report.summary.collisions == 0


@pytest.mark.parametrize("bent", [False, True])
def test_a_corridor_as_wide_as_the_robot_is_reachable_to_neither(bent: bool) -> None:
    world, specs = two_rooms(0.4, 0.05, bent=bent), [PlatformSpec(start=(1.0, 1.0))]
    simulation, report = run(world, specs, seed=1)
    beyond = np.zeros_like(world.solid)
    beyond[:, -round(3.0 / 0.05) :] = True
    behind = Reference(world, specs, simulation.starts).coverable & beyond
    assert behind.sum() < 0.5 * (beyond & ~world.solid).sum()
    assert report.summary.outcome is Outcome.COMPLETE
    assert report.summary.left_out


def test_a_team_ends_as_its_robots_say_in_the_simulator_and_in_the_watch_alike() -> None:
    words = (Outcome.COMPLETE, Outcome.UNREACHED, Outcome.ENCLOSED, Outcome.UNJOINED)
    world, specs = room_with_a_wall(0.1), robots(3)
    plan = ExplorePlan(world, specs, np.zeros((3, 3)), ExploreOptions(), 0, 1.0)
    (condition,) = conditions()
    for said in product(words, repeat=3):
        if set(said) == {Outcome.ENCLOSED}:
            wanted = Outcome.ENCLOSED  # nobody can move
        elif Outcome.UNREACHED in said:
            wanted = Outcome.UNREACHED
        elif Outcome.UNJOINED in said:
            wanted = Outcome.UNJOINED
        else:
            wanted = Outcome.COMPLETE
        assert together(said) is wanted
        heard = [structs.replace(condition, ending=word.value, state="done") for word in said]
        assert ExploreWatcher(plan, Setting(seed=0)).over(1.0, heard, silent=False) is wanted


def test_who_works_on_on_a_map_of_its_own_is_waited_for_as_long_again_as_most_took_and_300_s_at_least() -> (
    None
):
    world, specs = room_with_a_wall(0.1), robots(3)
    plan = ExplorePlan(world, specs, np.zeros((3, 3)), ExploreOptions(frames="unknown"), 0, 1.0)
    (condition,) = conditions()
    works = structs.replace(condition, state="driving")
    done = structs.replace(condition, state="done", ending="unjoined")
    for took, wanted in ((50.0, 350.0), (400.0, 800.0)):
        watcher = ExploreWatcher(plan, Setting(seed=0))
        ended = None
        for now in np.arange(0.0, 1000.0, 10.0).tolist():
            watcher._ways[0] = now  # it gets on
            heard = [done, done if now >= took else works, works]
            ended = watcher.over(now, heard, silent=False)
            if ended is not None:
                break
        assert ended is Outcome.UNJOINED
        assert now == wanted + 10.0
    watcher = ExploreWatcher(plan, Setting(seed=0))
    for now in np.arange(
        0.0, 1000.0, 10.0
    ).tolist():  # one of three is no reason, nor is who has come to an end
        watcher._ways[0] = now
        assert watcher.over(now, [done, works, works], silent=False) is None
        whole = structs.replace(done, ending="complete")
        assert watcher.over(now, [whole, whole, works], silent=False) is None


def test_parts_that_are_cut_off_from_each_other_and_hold_other_maps_are_not_called_complete() -> None:
    apart = Schedule((Partition(at=3.0, parts=((1, 2), (3,))),))
    _, report = run(room_with_a_wall(0.1), robots(3), seed=1, faults=apart)
    summary = report.summary
    assert summary.outcome is Outcome.MAPS_DIFFER
    assert not summary.completed
    assert summary.coverage > 0.99  # though each part has seen all that it can
    assert set(summary.maps) == {("robot-1", "robot-2"), ("robot-3",)}
    healed = Schedule((*apart.faults, Heal(at=12.0)))
    _, report = run(room_with_a_wall(0.1), robots(3), seed=1, faults=healed)
    assert report.summary.outcome is Outcome.COMPLETE
    assert report.summary.maps == (("robot-1", "robot-2", "robot-3"),)


def test_a_watch_calls_a_mission_complete_only_if_all_who_live_are_heard_and_hold_one_map(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = ExplorePlan(room_with_a_wall(0.1), robots(2), np.zeros((2, 3)), ExploreOptions(), 0, 1.0)
    (condition,) = conditions()
    done = structs.replace(condition, state="done")
    other = structs.replace(done, digest=7)
    watcher = ExploreWatcher(plan, Setting(seed=0))
    assert watcher.over(1.0, [done, condition], silent=False) is None
    assert watcher.over(1.0, [done], silent=True) is Outcome.UNHEARD
    assert watcher.over(2.0, [done, other], silent=False) is None  # they may still tell each other
    assert watcher.over(3.0, [done, done], silent=False) is Outcome.COMPLETE
    monkeypatch.setattr(outcome, "AGREEING", -1.0)
    assert watcher.over(4.0, [done, other], silent=False) is Outcome.MAPS_DIFFER
