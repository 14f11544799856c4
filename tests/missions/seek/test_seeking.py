"""Mapping and searching at once: what is agreed on, what is known of somebody, and how missions end."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.small_missions import TWO_ROOMS, drawn, robots, small_maze, small_office
from vedette import InputError, run
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.planners import DEFAULT, PLANNERS
from vedette.domains.mapping.price import EndPrice
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.domains.mapping.tour import STAY
from vedette.domains.search.evidence import LEVELS_PER_NAT
from vedette.kernels import coverage
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.missions.seek.looks import Looker, levels, room_for_somebody
from vedette.missions.seek.options import SeekOptions
from vedette.missions.seek.platform import LOOKED_AT, Belief, SeekingPlatform
from vedette.missions.seek.seeking import Seeking
from vedette.missions.seek.spots import APART, LEAST_ROOM, good_spots
from vedette.outcome import Outcome
from vedette.sim.seek.run import SeekRun, prepare
from vedette.sim.seek.simulation import SeekSetup, SeekSimulation
from vedette.testing import check_objective


def seeking(seed: int = 1, order: str = "together", **options: Any) -> SeekSimulation:
    """A team of two in a small office."""
    setup = SeekSetup(seed=seed, seek=SeekOptions(order), **options)
    return prepare(small_office(), robots(2), setup)


def never_seen(simulation: SeekSimulation, monkeypatch: pytest.MonkeyPatch) -> SeekSimulation:
    """A team that never sees whom it looks for."""
    monkeypatch.setattr(simulation.robots, "_in_sight", lambda robot: False)
    return simulation


def in_a_round(simulation: SeekSimulation, seconds: float = 25.0) -> tuple[Seeking, SeekingPlatform, Belief]:
    """The first robot after a while, its platform and its belief in a round that it is prepared for."""
    while simulation.now < seconds:
        simulation.step()
    mission = simulation.missions[0]
    belief = mission.freeze(simulation.now)
    pose = simulation.network.agents[0].pose
    assert pose is not None
    mission.prepare(belief, pose, [], False, simulation.now)
    platform = mission.platform
    assert isinstance(platform, SeekingPlatform)
    return mission, platform, belief


@pytest.fixture(scope="module")
def round_() -> tuple[Seeking, SeekingPlatform, Belief]:
    simulation = seeking()
    simulation.robots._in_sight = lambda robot: False  # type: ignore[method-assign]
    return in_a_round(simulation)


def tours(platform: SeekingPlatform, count: int) -> list[NDArray[np.int64]]:
    """Random orders of stops in reach, a place to look from in each."""
    assert platform.stops is not None
    rng = np.random.default_rng(0)
    ahead = np.flatnonzero(np.isfinite(platform.stops.first_leg))
    spots = ahead[platform.stops.unknown[ahead] == LOOKED_AT]
    assert len(spots)
    assert len(spots) < len(ahead)
    chosen = []
    for _ in range(count):
        others = rng.permutation(ahead)[:3]
        chosen.append(np.append(others[others != spots[0]], spots[0]))
    return chosen


def test_a_tour_is_worth_the_same_to_the_kernel_and_to_the_weighted_sum(
    round_: tuple[Seeking, SeekingPlatform, Belief],
) -> None:
    mission, platform, belief = round_
    first, *rest = (platform.tour(order) for order in tours(platform, 6))
    others = platform.impact(belief, first)
    for tour in rest:
        both = mission.objective.combine(others, platform.impact(belief, tour))
        gain = mission.objective.value(belief, both) - mission.objective.value(belief, others)
        problem = platform._both(belief, others)
        assert coverage.best_tour(problem, tour.stops, 6)[2] == pytest.approx(gain, rel=1e-4)
        assert platform.slack(belief, others) >= gain * (1.0 - 1e-4)


def test_tours_that_may_end_with_somebody_found_have_no_price_whatever_the_default_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(PLANNERS, DEFAULT, replace(PLANNERS[DEFAULT], end_price=EndPrice(1.0, 0.1)))
    assert {mission.planner.end_price for mission in seeking().missions} == {EndPrice()}


def test_the_sum_keeps_its_laws_on_tours_of_a_mission(
    round_: tuple[Seeking, SeekingPlatform, Belief],
) -> None:
    mission, platform, belief = round_
    impacts = [platform.impact(belief, platform.tour(order)) for order in tours(platform, 3)]
    assert (mission.objective.monotone, mission.objective.submodular) == (True, True)
    check_objective(mission.objective, belief, [*impacts, platform.impact(belief, STAY)], tolerance=1e-5)


def test_impacts_travel_in_both_parts_and_are_admitted(
    round_: tuple[Seeking, SeekingPlatform, Belief],
) -> None:
    mission, platform, belief = round_
    impact = platform.impact(belief, platform.tour(tours(platform, 1)[0]))
    assert mission.codec.decode(mission.codec.encode(impact)) == impact
    mission.admit(belief, impact, 1)
    with pytest.raises(ValueError, match="claims"):
        mission.admit(belief, (impact[0], type(impact[1])(*too_much(belief[0]))), 1)


def too_much(belief: MapBelief) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    """All cells, seen at once."""
    keys = np.arange(belief.planning.size, dtype=np.uint32) * np.uint32(coverage.LAYERS)
    return keys, np.full(len(keys), 255, np.uint8)


def test_where_somebody_may_be_follows_bayes_rule(round_: tuple[Seeking, SeekingPlatform, Belief]) -> None:
    mission, _, (known, sought) = round_
    looked = mission.fusion.counts[ROWS * BINS :].reshape(known.planning.shape)
    assert set(np.unique(looked % levels(0.8))) == {0}
    times = looked // levels(0.8)
    assert times.max() > 5
    weight = np.full(known.planning.shape, 2.0)  # four unknown cells, each free by half
    (row, col), shape = known.first, known.unknown.shape
    for r, c in np.ndindex(shape):
        cells = known.classes[2 * r : 2 * r + 2, 2 * c : 2 * c + 2]
        weight[row + r, col + c] = np.sum(cells == FREE) + 0.5 * np.sum(cells == UNKNOWN)
    weight *= 0.2**times  # each look would have missed somebody there with that probability
    np.testing.assert_allclose(sought.mass, weight / weight.sum(), rtol=2e-2, atol=1e-12)


def test_a_look_sees_what_no_wall_and_nothing_unknown_hides() -> None:
    classes = np.full((20, 30), FREE, np.uint8)
    classes[:12, 14:16] = OCCUPIED
    classes[12:, 22:] = UNKNOWN
    seen = np.zeros((10, 15), bool)
    seen.flat[Looker(classes, 0.1, 1.5).seen(5 * 30 + 8)] = True  # row 5, col 8: before the wall
    for row, col in np.ndindex(seen.shape):
        end = np.array([2 * row + 1, 2 * col + 1])
        path = np.linspace((5.0, 8.0), end, 400)
        open_ = (classes[tuple(np.rint(path).astype(int).T)] == FREE).all()
        if np.hypot(*(end - (5, 8))) > 15 or classes[tuple(end)] != FREE or not open_:
            assert not seen[row, col]
        elif abs(col - 7) > 1 and not (row > 4 and col > 6):  # clear of corners that a line may touch
            assert seen[row, col], (row, col)


def test_spots_are_chosen_greedily_by_brute_force(round_: tuple[Seeking, SeekingPlatform, Belief]) -> None:
    mission, platform, (known, _) = round_
    assert platform.ground is not None
    looker = Looker(known.classes, known.frame.resolution, 3.0)
    unsearched = mission._unsearched(round_[2])
    chosen = good_spots(known, platform.ground, unsearched, 3.0, looker.seen)
    step = round(APART / known.frame.resolution)
    rows, cols = known.frame.shape
    places = [
        r * cols + c
        for r in range(step // 2, rows, step)
        for c in range(step // 2, cols, step)
        if np.isfinite(platform.ground.field[r, c])
    ]
    left, found = unsearched.ravel().copy(), []
    while True:
        worth = [left[looker.seen(cell)].sum() for cell in places]
        if max(worth) < LEAST_ROOM / known.frame.resolution**2:
            break
        found.append(max(worth))
        left[looker.seen(places[int(np.argmax(worth))])] = 0.0
    assert len(chosen) == len(found)
    again = unsearched.ravel().copy()
    for cell, best in zip(chosen, found, strict=True):
        assert again[looker.seen(cell)].sum() == pytest.approx(best)
        again[looker.seen(cell)] = 0.0


def test_room_counts_free_cells_and_unknown_ones_by_half() -> None:
    classes = np.array([[FREE, UNKNOWN, OCCUPIED], [FREE, OCCUPIED, UNKNOWN], [FREE, FREE, FREE]], np.uint8)
    assert room_for_somebody(classes, 2).tolist() == [[2.5, 0.5], [2.0, 1.0]]


# -- missions -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", ["together", "map-first"])
def test_somebody_is_found_and_the_same_seed_finds_them_alike(order: str) -> None:
    first, again = (run.seek(small_maze(), 2, seed=5, order=order) for _ in range(2))
    assert first.outcome is Outcome.FOUND
    assert first.completed
    assert first.to_json() == again.to_json()
    x, y = first.somebody
    finder = next(robot for robot in first.log.last.robots if robot.name == first.found_by)
    assert np.hypot(finder.x - x, finder.y - y) <= 3.0 + 0.1
    assert first.found_s == pytest.approx(first.time_s, abs=0.2)


@pytest.mark.parametrize("order", ["together", "map-first"])
def test_who_is_never_seen_is_missed_once_all_is_mapped_and_searched(
    monkeypatch: pytest.MonkeyPatch, order: str
) -> None:
    simulation = never_seen(seeking(order=order, max_time=900.0), monkeypatch)
    report = SeekRun(simulation).run()
    assert report.summary.outcome is Outcome.MISSED
    assert report.summary.coverage is not None
    assert report.summary.coverage > 0.99
    mission = simulation.missions[0]
    unsearched = mission._unsearched(mission.freeze(simulation.now)).sum() * 0.1**2  # [m^2]
    assert unsearched < 0.05 * report.summary.known_m2


def test_with_the_map_first_nobody_goes_to_look_while_it_has_a_frontier_in_reach(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def both_kinds(order: str) -> int:
        simulation, mixed = never_seen(seeking(order=order, max_time=60.0), monkeypatch), 0
        while simulation.over is None:
            simulation.step()
            for mission in simulation.missions:
                stops = mission.platform.stops
                if stops is not None and len(stops):
                    there = np.isfinite(stops.first_leg)
                    kinds = set((stops.unknown[there] == LOOKED_AT).tolist())
                    mixed += len(kinds) == 2
        return mixed

    assert both_kinds("map-first") == 0
    assert both_kinds("together") > 0


def test_a_look_in_vain_is_everybodys(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = never_seen(seeking(max_time=40.0), monkeypatch)
    while simulation.over is None:
        simulation.step()
    own = sum(mission._looked for mission in simulation.missions)
    for mission in simulation.missions:
        shared = mission.fusion.counts[ROWS * BINS :]
        assert (shared <= own).all()
        assert shared.sum() > 0.5 * own.sum()  # told every ten seconds
    assert LEVELS_PER_NAT == 1024.0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"order": "searchfirst"}, "unknown order 'searchfirst'"),
        ({"reach": 0.0}, "range must be 0.001 to"),
        ({"detection": 1.5}, "detection must be 0 to 1"),
        ({"scheme": "tokn"}, "unknown scheme 'tokn'"),
    ],
)
def test_what_cannot_be_is_told_in_a_line(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as told:
        run.Seek(drawn(TWO_ROOMS), 1, **options)
    assert said in str(told.value)
