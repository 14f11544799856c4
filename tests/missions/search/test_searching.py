"""A search in the real agent and the real simulator: what the team knows, plans, and finds."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.support.search_missions import BOX, DRIFTING, EYE, blind, case, central, curve, scattered
from vedette.agent.effects import TrafficKind
from vedette.agent.events import Pose, Sensed
from vedette.domains.search.belief import freeze
from vedette.domains.search.impact import NOTHING
from vedette.errors import InputError
from vedette.missions.search.options import COORDINATIONS, FUSIONS
from vedette.missions.search.searching import Looks, Searching
from vedette.outcome import Outcome
from vedette.record.search.counting import Trials, dkw, wilson
from vedette.record.search.curves import ideal
from vedette.sim.search.run import search
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.search.trials import detected_at

STILL: dict[str, Any] = {}
SURE = {"type": "definite", "detection": 1.0, "range": 70, "noise": 5}
ALARMS = {
    "type": "exponential",
    "detection": 0.8,
    "range": 100,
    "sigma": 60,
    "noise": 10,
    "false_alarm": 0.02,
}


DETECTORS = {"eye": EYE, "box": BOX, "sure": SURE, "ahead": EYE | {"view": 120}}
TARGETS = {"still": STILL, "drifting": DRIFTING}


# -- what the team knows --------------------------------------------------------------------------------


@pytest.mark.parametrize("fusion", FUSIONS)
@pytest.mark.parametrize("target", [STILL, DRIFTING])
def test_everybodys_pdf_is_that_of_a_filter_that_gets_all_looks(fusion: str, target: dict[str, Any]) -> None:
    simulation = blind(case(target=target), fusion=fusion)
    step = simulation.steps - 2  # what has had the time to go round
    expected = central(simulation, step)
    for mission in simulation.missions:
        np.testing.assert_allclose(mission.pdf(step).mass, expected.mass, rtol=1e-9, atol=1e-15)


def test_a_dead_vehicles_evidence_that_was_delivered_is_kept() -> None:
    simulation = blind(case(), kills=((1, 31.0),))
    assert not simulation.vehicles.alive[1]
    assert max(simulation.vehicles.looks[1]) == 15
    expected = central(simulation, 14)
    assert simulation.missions[0].pdf(14).mass == pytest.approx(expected.mass)
    assert max(simulation.vehicles.looks[0]) == simulation.steps  # the others went on


def test_loss_delays_evidence_and_loses_none() -> None:
    simulation = blind(case(), link_loss=0.05, seed=5)
    step = simulation.steps - 10
    expected = central(simulation, step)
    for mission in simulation.missions:
        assert mission.pdf(step).mass == pytest.approx(expected.mass)
    assert min(agent.rounds.decisions for agent in simulation.agents) > 5


def test_without_coordination_nothing_is_sent() -> None:
    simulation = blind(case(), coordination="none")
    assert sum(map(sum, simulation.network.messages_sent.values())) == 0
    alone = central(simulation, 20)
    assert not np.allclose(simulation.missions[0].pdf(20).mass, alone.mass, rtol=1e-3, atol=1e-8)


# -- what it plans --------------------------------------------------------------------------------------


def mission_at(simulation: SearchSimulation, i: int = 0) -> Searching:
    """Return a mission after a while."""
    return simulation.missions[i]


def test_until_plans_take_over_every_candidate_holds_the_present_flights_turn_rates() -> None:
    mission = mission_at(blind(case(), max_time=20.0))
    belief = freeze(mission.pdf(9), mission.team.worth, committed=2)
    pose = Pose(400.0, 300.0, 0.3)
    mission.prepare(belief, pose, [], False, 18.0)
    assert mission.vehicle.options is not None
    flights = mission.vehicle.options.flights
    assert len({flight.turn_rates[:2].tobytes() for flight in flights}) == 1
    assert len({flight.turn_rates.tobytes() for flight in flights}) > 8
    after = mission.vehicle.look_poses(mission.vehicle.pose, flights[0].turn_rates[0], belief.dt)[-1]
    after = mission.vehicle.look_poses(after, flights[0].turn_rates[1], belief.dt)[-1]
    assert after == pytest.approx((pose.x, pose.y, pose.heading), abs=1e-9)
    assert mission.start(belief) == 22.0


def test_by_a_clock_that_shows_a_time_before_the_start_a_round_freezes_the_start() -> None:
    mission = mission_at(blind(case(), max_time=4.0))
    belief = mission.freeze(-7.0)
    assert (belief.step, belief.committed) == (0, 0)
    assert (belief.mass == mission.pdf(0).mass).all()


def test_a_plan_that_takes_over_in_the_horizons_last_step_or_later_is_refused() -> None:
    mission = mission_at(blind(case(), max_time=4.0))
    with pytest.raises(InputError, match="horizon of 6 steps"):
        freeze(mission.pdf(0), mission.team.worth, committed=6)
    with pytest.raises(InputError, match=r"horizon: a round of 3 vehicles takes .* plan more than"):
        SearchSimulation(case(horizon=3), SearchSetup(link_delay=0.2))


def test_sensors_look_from_where_the_plans_say() -> None:
    simulation = blind(case(), max_time=30.0)
    for i, mission in enumerate(simulation.missions):
        looks, flight = simulation.vehicles.looks[i], mission.strategy
        assert flight is not None
        step = flight.step + 1  # in force by then: the first step was flown as planned before
        if step + 1 in looks:
            planned = mission.vehicle.look_poses(looks[step][-1], flight.turn_rates[1], 2.0)
            np.testing.assert_allclose(looks[step + 1], planned, atol=1e-6)


def test_messages_clipped_to_what_their_receivers_can_reach_change_no_flight(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    apart = [
        {"start": [x, 400, 90 * k], "speed": 20, "turn_rate": 0.4} for k, x in enumerate((300, 500, 3700))
    ]
    scene = case(
        area=[0, 0, 4000, 800], tail=0.0, target=DRIFTING, vehicles=apart, prior=[{"type": "uniform"}],
        detector=BOX, duration=30,
    )  # fmt: skip
    clipped = blind(scene)
    assert clipped.missions[0].reach(0.0) is not None
    monkeypatch.setattr(Searching, "reach", lambda self, now: None)
    whole = blind(scene)
    for one, other in zip(clipped.vehicles.looks, whole.vehicles.looks, strict=True):
        assert one.keys() == other.keys()
        assert all(np.array_equal(one[k], other[k]) for k in one)
    sent, unclipped = (sum(each.network.bytes_sent[TrafficKind.NEGOTIATION]) for each in (clipped, whole))
    assert sent < 0.8 * unclipped


def test_with_promises_a_vehicle_tells_no_bounds() -> None:
    assert mission_at(blind(case(), max_time=10.0)).reach(10.0) is None


def test_a_shared_belief_team_tells_nothing_of_its_plans() -> None:
    simulation = blind(case(), coordination="shared")
    assert all(agent.rounds.impact == NOTHING for agent in simulation.agents)


def test_negotiated_searches_find_more_and_sooner_than_others_in_the_mean() -> None:
    scenes = [scattered(seed) for seed in range(3)]
    none, shared, negotiated = (
        np.array([curve(blind(scene, coordination=coordination)) for scene in scenes])
        for coordination in COORDINATIONS
    )
    for others in (none, shared):
        assert negotiated[:, -1].mean() >= others[:, -1].mean()
        assert negotiated.mean() > others.mean()  # the area under the curve: time not spent searching


# -- what it finds --------------------------------------------------------------------------------------


@cache
def searched(detector: str, target: str, coordination: str = "negotiated") -> SearchSimulation:
    """Return a blind search; several tests look at the same ones."""
    return blind(case(detector=DETECTORS[detector], target=TARGETS[target]), coordination=coordination)


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(
    ("detector", "coordination"),
    [*((detector, "negotiated") for detector in DETECTORS), ("eye", "none"), ("eye", "shared")],
)
def test_no_team_is_better_than_the_bound(detector: str, target: str, coordination: str) -> None:
    simulation = searched(detector, target, coordination)
    best = ideal(simulation.case, simulation.steps)
    assert (curve(simulation) <= best.bound + 1e-9).all()
    assert (np.diff(best.bound) >= -1e-12).all()
    assert best.bound[-1] > 0.5


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("detector", DETECTORS)
def test_targets_drawn_are_detected_as_predicted(detector: str, target: str) -> None:
    simulation = searched(detector, target)
    search, steps = simulation.case, simulation.steps
    rng, looks = np.random.default_rng(1), simulation.vehicles.looks
    first = detected_at(search.pdf, search.detectors, looks, steps, 4000, rng)
    share = np.bincount(first, minlength=steps + 2)[: steps + 1].cumsum() / 4000
    assert np.abs(share - curve(simulation)).max() <= dkw(4000, 0.999)
    assert share[-1] > 0.2


def test_a_target_in_front_of_a_sure_sensor_is_found_when_it_comes_into_range() -> None:
    scene = case(detector=SURE, target={"start": [300, 400]})
    simulation = SearchSimulation(scene, SearchSetup(max_time=60.0))
    report = search(simulation)
    summary = report.summary
    assert summary.outcome is Outcome.FOUND
    assert summary.found_s is not None
    assert summary.found_s == summary.time_s
    finder = scene.names.index(str(summary.found_by))
    last = simulation.vehicles.looks[finder][round(summary.found_s / 2.0)]
    assert np.hypot(*(last[:, :2] - (300, 400)).T).min() <= 70.0
    before = [
        poses for looks in simulation.vehicles.looks for k, poses in looks.items() if k < summary.found_s / 2
    ]
    assert min(np.hypot(*(poses[:, :2] - (300, 400)).T).min() for poses in before) > 70.0
    assert summary.error_m is not None
    assert summary.error_m < 25.0


def test_until_the_target_is_found_a_search_goes_as_if_nobody_reported() -> None:
    scene = case()
    simulation = SearchSimulation(scene, SearchSetup(max_time=60.0, seed=1))
    assert simulation.run(lambda: None) is Outcome.COMPLETE
    quiet = blind(scene, seed=1)
    for looks, others in zip(simulation.vehicles.looks, quiet.vehicles.looks, strict=True):
        assert all(np.array_equal(poses, others[k]) for k, poses in looks.items())


def test_a_place_is_declared_when_the_posterior_there_passes_the_threshold() -> None:
    scene = case(detector=ALARMS, duration=100, declare={"probability": 0.9, "radius": 80})
    outcomes = []
    for seed in range(3):
        simulation = SearchSimulation(scene, SearchSetup(max_time=100.0, seed=seed))
        summary = search(simulation).summary
        outcomes.append(summary.outcome)
        if simulation.declared is not None:
            found = simulation.declared[1]
            assert not found.certain
            pdf = simulation.missions[simulation.declared[0]].pdf(simulation.plan.step(found.time))
            assert pdf.probability_near(found.x, found.y, 80.0) >= 0.9
            assert summary.error_m is not None
            assert (summary.error_m <= 80.0) == (summary.outcome is Outcome.FOUND)
    assert Outcome.FOUND in outcomes


def test_one_false_alarm_does_not_make_a_target() -> None:
    simulation = blind(case(detector=ALARMS), max_time=4.0)
    mission = simulation.missions[0]
    poses = np.array([[350.0, 450.0, 0.0]])
    mission.observe(Sensed(Looks(poses, ((350.0, 480.0),)), 4.0), Pose(350.0, 450.0, 0.0), [], 4.0)
    mission.publish(4.0)
    before = blind(case(detector=ALARMS), max_time=4.0).missions[0].pdf(2)
    after = mission.pdf(2)
    near = after.probability_near(350.0, 480.0, 80.0)
    assert before.probability_near(350.0, 480.0, 80.0) < near < 0.9
    mission.freeze(4.0)
    assert mission.declared is None


def test_the_hidden_target_is_drawn_from_the_prior_and_is_the_same_for_every_coordination() -> None:
    scene = case(target=DRIFTING)
    ways = []
    for coordination in COORDINATIONS:
        simulation = SearchSimulation(scene, SearchSetup(coordination=coordination, seed=3))
        ways.append(np.array([simulation.hidden.at(k) for k in range(20)]))
    assert np.array_equal(ways[0], ways[1])
    assert np.array_equal(ways[0], ways[2])
    starts = np.array([SearchSimulation(scene, SearchSetup(seed=seed)).hidden.at(0) for seed in range(200)])
    cells = scene.pdf.frame.centres(np.arange(scene.pdf.frame.size))
    mean = scene.pdf.mass.ravel() @ cells
    spread = np.sqrt(scene.pdf.mass.ravel() @ (cells - mean) ** 2)
    assert np.abs(starts.mean(axis=0) - mean).max() < 4.0 * spread.max() / np.sqrt(200)


def test_a_team_without_a_vehicle_left_has_lost() -> None:
    simulation = SearchSimulation(
        case(detector=BOX), SearchSetup(max_time=60.0, kills=((0, 0.0), (1, 2.0), (2, 3.0)))
    )
    assert search(simulation).summary.outcome is Outcome.TEAM_LOST


def test_false_declarations_and_misses_are_counted_apart_from_what_was_found() -> None:
    """Of five searches of four steps: found after 2, wrong after 3, never, found after 4, wrong after 1."""
    steps, wrong = np.array([2, 3, 5, 4, 1]), np.array([False, True, False, False, True])
    trials = Trials(steps, "runs", wrong)
    assert trials.curve(4).tolist() == [0.0, 0.0, 0.2, 0.2, 0.4]
    assert trials.curve(4, wrong=True).tolist() == [0.0, 0.2, 0.2, 0.4, 0.4]
    counted = trials.figures(np.arange(5) * 2.0, np.zeros(5))
    assert (counted.found, counted.mistaken, counted.missed, counted.off) == (0.4, 2, 1, None)
    assert counted.mean_time_s == pytest.approx((4.0 + 8.0 + 8.0 + 8.0 + 8.0) / 5)


def test_bands_and_intervals_have_their_textbook_values() -> None:
    assert dkw(1000) == pytest.approx(0.0429, abs=1e-4)
    assert wilson(5, 10) == pytest.approx((0.2366, 0.7634), abs=1e-4)
    assert wilson(0, 10)[0] == 0.0
