"""Whole small missions: they end well, whatever the team, the planner, the links and the faults."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.small_missions import check_complete, drawn, robots, run, small_maze, small_office
from vedette.agent.effects import Send, TrafficKind
from vedette.agent.events import Message
from vedette.domains.mapping.planners import PLANNERS
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.world import World
from vedette.missions.explore.assemble import FUSIONS
from vedette.negotiation import SCHEMES
from vedette.record.explore.score import Reference
from vedette.sim.explore.run import explore, observer_of, prepare, views
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.links import Wires
from vedette.team import PlatformSpec

TWO_DOORS = """
########################
#          #           #
#          #           #
#                      #
#                      #
#          #           #
#          #           #
#          #           #
#          #           #
#                      #
#                      #
#          #           #
########################
"""


@pytest.mark.parametrize("n", [1, 2, 3])
def test_an_office_is_explored_completely_and_without_a_touch(n: int) -> None:
    simulation, report = run(small_office(), robots(n))
    check_complete(report)
    assert report.summary.robots == n
    assert all(agent.dropped == 0 for agent in simulation.agents)
    digests = {mission.fusion.digest for mission in simulation.missions}
    assert len(digests) == 1  # everybody holds the same map in the end


PAIRS = [(name, scheme) for name in PLANNERS for scheme in SCHEMES if PLANNERS[name].scheme in (None, scheme)]


@pytest.mark.parametrize("fusion", FUSIONS)
@pytest.mark.parametrize(("planner", "scheme"), PAIRS)
def test_every_planner_scheme_and_fusion_completes(planner: str, scheme: str, fusion: str) -> None:
    _, report = run(drawn(TWO_DOORS), robots(2, range=4.0), planner=planner, scheme=scheme, fusion=fusion)
    check_complete(report)
    summary = report.summary
    took = (
        "token" if scheme in ("multistart", "fork", "async") and not PLANNERS[planner].negotiates else scheme
    )
    assert (summary.planner, summary.scheme, summary.fusion) == (planner, took, fusion)


@pytest.mark.parametrize("seed", [1])
def test_a_tenth_of_all_messages_lost_does_not_stop_a_mission(seed: int) -> None:
    _, report = run(small_maze(seed), robots(3), link_loss=0.1)
    check_complete(report)


@pytest.mark.parametrize("delay", [0.001, 0.2])
def test_fast_and_slow_links_do_not_stop_a_mission(delay: float) -> None:
    _, report = run(small_maze(), robots(3), link_delay=delay)
    check_complete(report)


@pytest.mark.parametrize("victim", [0, 1, 2])
def test_when_one_robot_dies_the_others_complete_the_mission(victim: int) -> None:
    simulation, report = run(small_maze(), robots(3), kills=((victim, 12.0),))
    check_complete(report)
    assert simulation.living == [i for i in range(3) if i != victim]
    assert report.log.last.robots[victim].state == "dead"


def test_what_a_dead_robot_has_told_still_counts() -> None:
    simulation = prepare(small_maze(), robots(2), ExploreSetup(kills=((1, 15.0),), max_time=15.5))
    report = explore(simulation)
    assert report.summary.coverage > 0.0
    before = simulation.missions[0].fusion.classes.window() != UNKNOWN
    own = simulation.missions[0].own.log_odds.window() != 0
    assert (before & ~own).any()  # some of the survivor's map is the dead robot's
    covered = Reference(simulation.world, simulation.specs, simulation.starts).coverable
    assert report.summary.coverage == pytest.approx(float((before | own)[covered].mean()), abs=1e-6)


def test_a_team_that_dies_is_lost_and_leaves_what_it_saw() -> None:
    _, report = run(small_maze(), robots(2), kills=((0, 8.0), (1, 9.0)))
    assert report.summary.outcome.value == "team_lost"
    assert report.summary.time_s == pytest.approx(9.0)
    assert not report.summary.completed
    assert report.summary.coverage > 0.1
    assert np.count_nonzero(report.classes == FREE) > 100


def test_a_mission_stops_at_its_time_limit() -> None:
    _, report = run(small_office(), robots(1), max_time=10.0)
    assert report.summary.outcome.value == "time_limit"
    assert report.summary.time_s == pytest.approx(10.0)
    assert 0.0 < report.summary.coverage < 1.0


def test_robots_return_to_where_they_started() -> None:
    simulation, report = run(small_office(), robots(3), return_home=True)
    check_complete(report)
    for i in range(3):
        x, y, _ = simulation.pose(i)
        assert np.hypot(x - simulation.starts[i, 0], y - simulation.starts[i, 1]) <= 0.3


def test_a_narrow_view_and_a_short_range_suffice() -> None:
    _, report = run(small_maze(), robots(2, view=180.0, range=4.0))
    check_complete(report)


def test_robots_of_different_bodies_sensors_and_speeds_explore_together() -> None:
    specs = [
        PlatformSpec(name="scout", speed=1.0, radius=0.15, range=12.0, rate=10.0),
        PlatformSpec(name="heavy", speed=0.3, radius=0.3, range=5.0, view=270.0, beams=180),
        PlatformSpec(name="plain"),
    ]
    _, report = run(small_maze(), specs)
    check_complete(report)
    assert list(report.summary.path_m) == ["scout", "heavy", "plain"]


ROOM = """
####################
#                  #
#                  #
#                  #
#                  #
#                  #
####################
"""


def test_team_mates_are_not_in_the_map() -> None:
    specs = [
        PlatformSpec(name="large", radius=0.4, start=(2.0, 1.75)),
        PlatformSpec(name="small", radius=0.15, start=(4.0, 1.75)),
        PlatformSpec(name="other", start=(6.0, 1.75)),
    ]
    simulation, report = run(drawn(ROOM), specs)
    check_complete(report)
    for mission in simulation.missions:
        assert not ((mission.fusion.classes.window() == OCCUPIED) & ~simulation.world.solid)[7:-7, 7:-7].any()


def test_given_starts_are_kept() -> None:
    specs = [
        PlatformSpec(name="a", start=(2.0, 1.0, 90.0)),
        PlatformSpec(name="b", start=(8.0, 2.0)),
        PlatformSpec(name="c"),
    ]
    simulation = prepare(drawn(ROOM), specs, ExploreSetup())
    np.testing.assert_allclose(simulation.starts[:2], [(2.0, 1.0, np.pi / 2), (8.0, 2.0, 0.0)])
    assert simulation.pose(0) == pytest.approx((2.0, 1.0, np.pi / 2))


def test_a_dead_robot_in_a_door_is_planned_round() -> None:
    specs = [
        PlatformSpec(name="blocker", radius=0.4, start=(5.75, 4.5)),
        PlatformSpec(name="worker", start=(2.0, 2.0)),
    ]
    simulation, report = run(drawn(TWO_DOORS), specs, kills=((0, 1.0),))
    check_complete(report)
    assert simulation.robots.bodies.travelled[1] > 5.0


def test_a_frame_whose_origin_lies_elsewhere_makes_no_difference() -> None:
    world = small_maze()
    frame = type(world.frame)(world.frame.resolution, *world.frame.shape, -37.0, 120.0)
    moved = World(frame, world.solid, world.name)
    _, here = run(world, robots(2))
    _, there = run(moved, robots(2))
    check_complete(there)
    assert there.summary.time_s == pytest.approx(here.summary.time_s, rel=0.3)  # rounding alone differs


def test_the_same_seed_gives_the_same_mission_and_another_seed_another() -> None:
    _, first = run(drawn(TWO_DOORS), robots(2), seed=5)
    _, second = run(drawn(TWO_DOORS), robots(2), seed=5)
    _, other = run(drawn(TWO_DOORS), robots(2), seed=6)
    assert first.summary.to_json() == second.summary.to_json()
    np.testing.assert_array_equal(first.classes, second.classes)
    np.testing.assert_array_equal(first.log.poses, second.log.poses)
    assert first.summary.path_m != other.summary.path_m


def test_stopping_a_mission_ends_it_as_interrupted_with_all_its_figures() -> None:
    simulation = prepare(small_office(), robots(2), ExploreSetup())
    observer = observer_of(simulation)

    def look() -> None:
        observer.look(simulation.now, views(simulation), None)
        if simulation.now > 5.0:
            simulation.stop()

    outcome = simulation.run(look, 0.5)
    observer.finish(simulation.now, views(simulation), None)
    assert outcome.value == "interrupted"
    assert simulation.now < 7.0
    assert observer.log.last.t == simulation.now
    assert observer.summary(outcome).coverage > 0.0


def test_a_link_delivers_in_order_after_its_delay_and_counts_what_it_carries() -> None:
    links = Wires(2, 0.05)
    for number in range(4000):
        links.send(0, Send(1, TrafficKind.BEACONS, number.to_bytes(2, "little")), number * 1e-3)
    for number in range(4000):
        time, receiver, arrived = links.arrive()
        assert (receiver, arrived) == (1, [Message(0, number.to_bytes(2, "little"))])
        assert time == pytest.approx(number * 1e-3 + 0.05)
    assert links.next_arrival() == float("inf")
    assert links.messages_sent[TrafficKind.BEACONS] == [4000, 0]
    assert links.bytes_sent[TrafficKind.BEACONS] == [8000, 0]


@pytest.mark.parametrize("delay", [0.0, 0.05])
def test_beacons_that_come_at_one_time_are_taken_in_at_once_and_nothing_else_is(delay: float) -> None:
    links = Wires(3, delay)
    for sender, kind, payload in (
        (0, TrafficKind.BEACONS, b"a"),
        (0, TrafficKind.FUSION, b"b"),
        (1, TrafficKind.BEACONS, b"c"),
        (1, TrafficKind.FUSION, b"d"),
    ):
        links.send(sender, Send(2, kind, payload), 1.0)
    a, b, c, d = Message(0, b"a"), Message(0, b"b"), Message(1, b"c"), Message(1, b"d")
    assert links.arrive()[2] == [a, c]
    links.send(0, Send(2, TrafficKind.BEACONS, b"a"), 1.0)
    assert [links.arrive()[2] for _ in range(3)] == [[b], [d], [a]]


def test_the_sum_of_curves_is_what_the_log_says() -> None:
    _, report = run(small_maze(), robots(2))
    times, covered = report.log.times, report.log.coverage
    assert np.all(np.diff(times) > 0)
    assert times[-1] == report.summary.time_s
    assert covered[-1] == pytest.approx(report.summary.coverage, abs=1e-6)
    assert np.all(np.diff(covered) > -0.01)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_default_offices_are_explored_by_six_robots(seed: int) -> None:
    from vedette.sim.worlds import office

    _, report = run(office(np.random.default_rng(seed)), robots(6), seed=seed, max_time=3600.0)
    check_complete(report)
