"""The sensor manager for Stone Soup against its own reward, its own managers and brute force."""

from __future__ import annotations

import copy
import datetime
import itertools
import runpy
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from tests.support.places import ROOT

pytest.importorskip("stonesoup")

from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.movable.grid import NStepDirectionalGridMovable
from stonesoup.platform import FixedPlatform, Platform
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.sensor.radar.radar import (
    RadarBearingRange,
    RadarBearingRangeRate,
    RadarBearingRangeRate2D,
    RadarElevationBearingRange,
    RadarElevationBearingRangeRate,
    RadarRotatingBearing,
    RadarRotatingBearingRange,
    RadarRotatingElevationBearingRange,
)
from stonesoup.sensormanager import BruteForceSensorManager
from stonesoup.sensormanager.reward import ExpectedKLDivergence, UncertaintyRewardFunction
from stonesoup.types.array import CovarianceMatrix, StateVector
from stonesoup.types.state import GaussianState, State
from stonesoup.types.track import Track
from stonesoup.updater.kalman import ExtendedKalmanUpdater

from bench.stonesoup.managers import BRUTE, GREEDY, LOG_DET, OURS, Decision
from bench.stonesoup.scenario import START, THEN, Scene, scene
from vedette import InputError, exhaustive
from vedette.stonesoup import (
    LogDetReward,
    StoneSoupTracks,
    TrackReward,
    UncertaintyReward,
    VedetteSensorManager,
)
from vedette.stonesoup.candidates import Menu, joint_actions, menus
from vedette.stonesoup.forecast import forecast
from vedette.stonesoup.information import measured
from vedette.stonesoup.rotating import RotatingView, is_plain_rotating_radar
from vedette.testing import LawBroken, check_objective

REWARDS = {"logdet": LogDetReward(), "uncertainty": UncertaintyReward()}


def small(radars: int, targets: int, seed: int) -> Scene:
    return scene(radars, targets, np.random.default_rng(seed))


def menus_of(made: Scene) -> tuple[StoneSoupTracks, list[Menu]]:
    ahead = forecast(made.tracks, made.predictor, THEN)
    return StoneSoupTracks.of(ahead.covariances), menus(made.sensors, [], ahead, 1000)[0]


def radar(kind: Any = RadarRotatingBearingRange, noise: Any = None, **changed: Any) -> Any:
    settings: dict[str, Any] = {
        "position": StateVector([10.0, 20.0]),
        "position_mapping": (0, 2),
        "ndim_state": 4,
        "noise_covar": CovarianceMatrix(np.diag([1e-3, 4.0]) if noise is None else noise),
        "dwell_centre": StateVector([0.3]),
        "rpm": 60.0,
        "resolution": np.radians(30.0),
        "fov_angle": np.radians(50.0),
        "max_range": 70.0,
    }
    made = kind(**(settings | changed))
    made.timestamp = START
    return made


def manager(made: Scene, **properties: Any) -> VedetteSensorManager:
    return VedetteSensorManager(set(made.sensors), **({"predictor": made.predictor} | properties))


# -- rewards ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("reward", REWARDS.values(), ids=REWARDS)
def test_the_rewards_keep_the_laws_of_an_objective(reward: TrackReward) -> None:
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(7, 3, 2, 4)) * (rng.random((7, 3, 1, 1)) < 0.6)
    impacts = [np.swapaxes(each, 1, 2) @ each for each in rows]
    spread = rng.normal(size=(3, 4, 4))
    check_objective(reward, StoneSoupTracks.of(spread @ np.swapaxes(spread, 1, 2) + np.eye(4)), impacts)


def test_the_uncertainty_reward_does_not_diminish_so_that_it_can_have_no_bound() -> None:
    class Bold(UncertaintyReward):
        submodular = True

    one, other = (np.diag(diagonal)[None] for diagonal in ([10.0, 0.0], [0.0, 10.0]))
    with pytest.raises(LawBroken, match="returns do not diminish"):
        check_objective(Bold(), StoneSoupTracks.of(np.eye(2)[None]), [one, other])


@pytest.mark.parametrize("seed", range(3))
def test_the_rewards_are_entropy_and_norm_taken_off_the_covariances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    spread, rows = rng.normal(size=(2, 3, 4, 4))
    before, told = spread @ np.swapaxes(spread, 1, 2) + np.eye(4), np.swapaxes(rows, 1, 2) @ rows
    after = np.linalg.inv(np.linalg.inv(before) + told)
    entropy = 0.5 * np.log(np.linalg.det(before) / np.linalg.det(after)).sum()
    norm = sum(np.linalg.norm(p) - np.linalg.norm(q) for p, q in zip(before, after, strict=True))
    assert REWARDS["logdet"].value(StoneSoupTracks.of(before), told) == pytest.approx(entropy)
    assert REWARDS["uncertainty"].value(StoneSoupTracks.of(before), told) == pytest.approx(norm)


# -- what sensors tell ------------------------------------------------------------------------------


@pytest.mark.parametrize("dwell", np.linspace(-3.1, 3.1, 9))
def test_the_view_of_a_rotating_radar_equals_what_it_measures_at_that_angle(dwell: float) -> None:
    made = small(1, 60, 6)
    ahead = forecast(made.tracks, made.predictor, THEN)
    seat = radar(position=StateVector([50.0, 45.0]), orientation=StateVector([0.0, 0.0, 0.7]), max_range=40.0)
    assert is_plain_rotating_radar(seat)
    view = RotatingView(seat, ahead)
    seat.dwell_centre = StateVector([dwell])
    expected = measured(seat, ahead)
    assert 0 < np.count_nonzero(expected.any(axis=(1, 2))) < 60
    np.testing.assert_allclose(view(seat), expected, rtol=1e-5, atol=1e-9)


def test_a_tilted_radar_and_a_subclass_that_sees_otherwise_are_asked_angle_by_angle() -> None:
    class Blind(RadarRotatingBearingRange):  # type: ignore[misc]
        def is_detectable(self, state: Any, measurement_model: Any = None) -> bool:
            return False

    assert not is_plain_rotating_radar(radar(orientation=StateVector([0.0, 0.1, 0.0])))
    assert not is_plain_rotating_radar(radar(Blind))
    assert not is_plain_rotating_radar(radar(RadarRotatingBearing, noise=np.diag([1e-3])))


def test_the_information_is_the_jacobians_weighted_by_the_noise() -> None:
    seat = radar(dwell_centre=StateVector([0.3]))
    state = GaussianState(StateVector([40.0, 1.0, 30.0, -1.0]), np.eye(4), timestamp=START)
    (told,) = measured(seat, forecast([Track([state])], Still(), START))
    dx, dy = 30.0, 10.0
    r2 = dx * dx + dy * dy
    jacobian = np.array([[-dy / r2, 0, dx / r2, 0], [dx / r2**0.5, 0, dy / r2**0.5, 0]])
    np.testing.assert_allclose(told, jacobian.T @ np.diag([1e3, 0.25]) @ jacobian, rtol=1e-5, atol=1e-9)


class Still:
    """A predictor for tracks that stay as they are."""

    def predict(self, state: Any, timestamp: datetime.datetime) -> Any:
        return state


def test_equal_actions_are_asked_once_and_candidates_that_tell_the_same_are_one() -> None:
    made = small(1, 2, 3)
    seat = radar()  # 60 rpm: a whole turn both ways, so every angle is listed twice
    ahead = forecast(made.tracks, made.predictor, THEN)
    ((menu,), still) = menus([seat], [], ahead, 1000)
    assert len(joint_actions(seat, ahead, 1000)) == 25
    assert menu.asked == 12
    assert still == {}
    told = {candidate.information.tobytes() for candidate in menu.candidates}
    assert len(told) == len(menu.candidates) <= 2**2


def test_asking_leaves_sensors_and_tracks_as_they_were() -> None:
    made = small(2, 4, 1)
    before = copy.deepcopy([vars(sensor) for sensor in made.sensors])
    lengths = [len(track) for track in made.tracks]
    manager(made).choose_actions(made.tracks, THEN)
    for sensor, kept in zip(made.sensors, before, strict=True):
        assert sensor.dwell_centre == kept["_property_dwell_centre"]
        assert sensor.timestamp == START
        assert sensor.scheduled_actions == {}
    assert [len(track) for track in made.tracks] == lengths


# -- decisions --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_the_reward_reported_is_what_stone_soups_reward_function_says_of_the_configuration(seed: int) -> None:
    made = small(5, 7, seed)
    ours = manager(made, reward_function=made.reward(), predictor=None)
    (config,), rewards = ours.choose_actions(made.tracks, THEN, return_reward=True)
    assert ours.last is not None
    assert rewards == [ours.last.reward]
    assert ours.last.reward == pytest.approx(made.worth(config), rel=1e-6)
    assert ours.last.bound is None


@pytest.mark.parametrize("reward", REWARDS)
@pytest.mark.parametrize("seed", range(8))
def test_a_decision_of_four_radars_is_within_a_hundredth_of_the_best_of_all(reward: str, seed: int) -> None:
    made = small(4, 8, seed)
    belief, found = menus_of(made)
    best = exhaustive(
        REWARDS[reward], belief, [[each.information for each in menu.candidates] for menu in found]
    )
    ours = manager(made, reward_function=reward)
    ours.choose_actions(made.tracks, THEN)
    assert ours.last is not None
    assert 0.99 * best.value <= ours.last.reward <= best.value + 1e-9
    assert ours.last.converged
    bound = ours.last.bound
    assert (bound is not None) == (reward == "logdet")  # the only one that promises a bound
    assert bound is None or best.value <= bound + 1e-9


def test_a_decision_of_two_radars_is_stone_soups_brute_force_one() -> None:
    made = small(2, 4, 0)
    brute = BruteForceSensorManager(set(made.sensors), reward_function=made.reward())
    _, (best,) = brute.choose_actions(made.tracks, THEN, return_reward=True)
    _, (reward,) = manager(made, reward_function=made.reward()).choose_actions(
        made.tracks, THEN, return_reward=True
    )
    assert reward == pytest.approx(best, rel=1e-6)


@pytest.mark.parametrize("reward", REWARDS)
def test_sensors_can_negotiate_from_nothing_by_messages_alone(reward: str) -> None:
    made = small(6, 8, 2)
    alone, started = manager(made, reward_function=reward, starts=0), manager(made, reward_function=reward)
    alone.choose_actions(made.tracks, THEN)
    started.choose_actions(made.tracks, THEN)
    assert alone.last is not None
    assert started.last is not None
    assert alone.last.sweeps > started.last.sweeps == 1
    assert 0.5 * started.last.reward <= alone.last.reward


def test_the_decision_does_not_depend_on_the_order_of_a_set() -> None:
    made = small(6, 8, 5)
    chosen = set()
    for order in (made.tracks, sorted(made.tracks, key=id), sorted(made.tracks, key=id, reverse=True)):
        (config,) = manager(made).choose_actions(order, THEN)
        chosen.add(tuple(float(config[sensor][0].target_value) for sensor in made.sensors))
    assert len(chosen) == 1


def test_a_decision_can_be_enacted_step_after_step() -> None:
    made = small(3, 4, 8)
    ours, tracks = manager(made), set(made.tracks)
    for second in range(1, 4):
        now = START + datetime.timedelta(seconds=second)
        for sensor, actions in ours.choose_actions(tracks, now)[0].items():
            assert sensor.add_actions(actions)
            sensor.act(now)
            assert float(sensor.dwell_centre[0, 0]) == pytest.approx(
                float(actions[0].target_value), abs=1e-5
            )  # Stone Soup rounds the time that a turn takes to microseconds
        tracks = {Track([made.predictor.predict(track.state, timestamp=now)]) for track in tracks}


def brute(ours: VedetteSensorManager, reward: Any, tracks: Any) -> float:
    """The best reward of all configurations, by Stone Soup's own function."""
    everybody = list(ours.actionables)
    choices = [list(itertools.product(*each.actions(THEN))) for each in everybody]
    configs = (dict(zip(everybody, chosen, strict=True)) for chosen in itertools.product(*choices))
    return max(float(reward(config, tracks, THEN)) for config in configs)


def test_sensors_of_several_kinds_and_several_actions_decide_as_brute_force_does() -> None:
    made = small(1, 5, 7)
    bearing = radar(RadarRotatingBearing, noise=np.diag([1e-3]), rpm=20.0)
    fixed = RadarBearingRange(
        position=StateVector([90.0, 10.0]), position_mapping=(0, 2), ndim_state=4,
        noise_covar=np.diag([1e-3, 9.0]), max_range=60.0,
    )  # fmt: skip
    fixed.timestamp = START
    ours = VedetteSensorManager({*made.sensors, bearing, fixed}, reward_function=made.reward())
    (config,) = ours.choose_actions(made.tracks, THEN)
    assert config[fixed] == ()
    assert ours.last is not None
    assert ours.last.reward == pytest.approx(brute(ours, made.reward(), made.tracks), rel=1e-6)


def test_a_radar_that_turns_and_tilts_decides_over_the_product_of_its_actions() -> None:
    rng = np.random.default_rng(3)
    tracks = [
        Track(
            [
                GaussianState(
                    StateVector(rng.uniform(-50, 50, 6)), np.diag(rng.uniform(1, 9, 6)), timestamp=START
                )
            ]
        )
        for _ in range(6)
    ]
    seat = RadarRotatingElevationBearingRange(
        position=StateVector([0.0, 0.0, 0.0]), position_mapping=(0, 2, 4), ndim_state=6,
        dwell_centre=StateVector([0.0]), tilt_centre=StateVector([0.0]),
        noise_covar=np.diag([1e-3, 1e-3, 4.0]), rpm=15.0, resolution=np.radians(30.0),
        fov_angle=np.radians(60.0), vertical_extent=np.radians(40.0),
    )  # fmt: skip
    seat.timestamp = START
    model = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.05)] * 3)
    reward = UncertaintyRewardFunction(KalmanPredictor(model), ExtendedKalmanUpdater(None))
    ours = VedetteSensorManager({seat}, reward_function=reward)
    (config,) = ours.choose_actions(tracks, THEN)
    assert len(config[seat]) == 2
    assert ours.last is not None
    assert ours.last.asked == 7 * 7
    assert ours.last.reward > 0.0
    assert ours.last.reward == pytest.approx(brute(ours, reward, tracks), rel=1e-6)


def test_a_platform_that_moves_decides_together_with_its_radar_as_brute_force_does() -> None:
    made = small(1, 4, 11)
    mobile = NStepDirectionalGridMovable(
        states=[State(StateVector([40.0, 50.0]), timestamp=START)],
        position_mapping=(0, 1),
        n_steps=1,
        step_size=10,
    )
    carried = RadarRotatingBearingRange(
        position_mapping=(0, 2), ndim_state=4, noise_covar=np.diag([1e-3, 4.0]),
        dwell_centre=StateVector([0.0]), rpm=10.0, resolution=np.radians(30.0), fov_angle=np.radians(60.0),
        mounting_offset=StateVector([0.0, 0.0]),
    )  # fmt: skip
    boat = Platform(movement_controller=mobile, sensors=[carried])
    tower = FixedPlatform(position_mapping=(0, 1), states=State(StateVector([0.0, 0.0]), timestamp=START))
    ours = VedetteSensorManager(set(made.sensors), {boat, tower}, reward_function=made.reward())
    (config,) = ours.choose_actions(made.tracks, THEN)
    assert config.keys() == {boat, tower, carried, *made.sensors}
    assert config[tower] == ()
    assert ours.last is not None
    assert ours.last.reward == pytest.approx(made.worth(config), rel=1e-6)
    assert ours.last.reward == pytest.approx(brute(ours, made.reward(), made.tracks), rel=1e-6)
    assert boat.position.ravel().tolist() == [40.0, 50.0]


def test_without_tracks_every_sensor_still_has_an_action() -> None:
    made = small(3, 1, 0)
    ours = manager(made)
    (config,) = ours.choose_actions(set(), THEN)
    assert {len(actions) for actions in config.values()} == {1}
    assert ours.last is not None
    assert ours.last.reward == 0.0


# -- bad input --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"reward_function": "logdat"}, "unknown reward_function 'logdat'; did you mean 'logdet'"),
        (
            {"reward_function": ExpectedKLDivergence()},
            "unknown reward_function 'ExpectedKLDivergence'; known:",
        ),
        ({"predictor": None}, "predictor is missing"),
        ({"max_actions": 11}, "RadarRotatingBearingRange has 12 joint actions, at most 11; coarsen"),
    ],
)
def test_bad_properties_are_told_in_one_line(properties: dict[str, Any], message: str) -> None:
    made = small(2, 2, 0)
    with pytest.raises(InputError, match=message):
        manager(made, **properties).choose_actions(made.tracks, THEN)


def test_a_time_before_that_of_a_track_is_told_in_one_line_and_its_own_time_is_none() -> None:
    made = small(1, 2, 0)
    late = datetime.timedelta(seconds=1)
    with pytest.raises(
        InputError, match=r"lies before track .*give the time at which the actions end"
    ) as caught:
        manager(made).choose_actions(made.tracks, START - late)
    assert "\n" not in str(caught.value)
    for track in made.tracks:
        assert track.state.timestamp == START
    assert manager(made).choose_actions(made.tracks, START)


def test_no_sensors_no_covariance_and_a_second_best_are_told_in_one_line() -> None:
    made = small(1, 2, 0)
    with pytest.raises(InputError, match="no sensors"):
        VedetteSensorManager(predictor=made.predictor).choose_actions(made.tracks, THEN)
    with pytest.raises(InputError, match="nchoose must be 1; got 2"):
        manager(made).choose_actions(made.tracks, THEN, nchoose=2)
    bare = Track([State(StateVector([1.0, 0.0, 1.0, 0.0]), timestamp=START)])
    with pytest.raises(InputError, match=r"has a State; give it a state with a covariance"):
        manager(made).choose_actions({bare}, THEN)
    with pytest.raises(InputError, match="is empty; leave it out"):
        manager(made).choose_actions({Track()}, THEN)
    other = Track([GaussianState(StateVector([1.0]), np.eye(1), timestamp=START)])
    with pytest.raises(InputError, match="states of different sizes"):
        VedetteSensorManager(set(made.sensors), predictor=Still()).choose_actions({*made.tracks, other}, THEN)
    wrong = np.diag([9.0, 1.0, 9.0, -1.0])
    none = Track([GaussianState(StateVector(np.zeros(4)), wrong, timestamp=START)])
    with pytest.raises(InputError, match=f"covariance of track {none.id} has a negative variance"):
        VedetteSensorManager(set(made.sensors), predictor=Still()).choose_actions({none}, THEN)
    with pytest.raises(InputError, match="tracks hold a GaussianState, which is no track"):
        manager(made).choose_actions({none.state}, THEN)


def track_at(mean: list[float], variances: list[float]) -> Track:
    return Track([GaussianState(StateVector(mean), np.diag(variances), timestamp=START)])


@pytest.mark.parametrize("kind", [RadarRotatingBearingRange, RadarRotatingBearing])
@pytest.mark.parametrize("x", [0.0, 500.0])
def test_a_target_predicted_on_the_radar_itself_is_worth_what_brute_force_makes_of_it(
    kind: Any, x: float
) -> None:
    """There Stone Soup takes the bearing from wherever the antenna points: it is in view of every dwell."""
    noise = np.diag([3e-4, 25.0] if kind is RadarRotatingBearingRange else [3e-4])
    seat = radar(kind, noise=noise, fov_angle=np.radians(30.0), rpm=29.0)
    seat.position = StateVector([x, 0.0])
    tracks = [track_at([x, 0.0, 0.0, 0.0], [9, 1, 9, 1]), track_at([x - 30, 0, -30, 0], [9, 1, 9, 1])]
    model = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.05)] * 2)
    reward = UncertaintyRewardFunction(KalmanPredictor(model), ExtendedKalmanUpdater(None))
    ours = VedetteSensorManager({seat}, reward_function=reward)
    (config,) = ours.choose_actions(tracks, THEN)
    assert ours.last is not None
    assert ours.last.reward == pytest.approx(float(reward(config, tracks, THEN)), rel=1e-6)
    assert ours.last.reward == pytest.approx(brute(ours, reward, tracks), rel=1e-6)


@pytest.mark.parametrize("name", ["logdet", "uncertainty"])
def test_a_component_that_is_known_and_stays_so_is_taken_as_stone_soups_reward_takes_it(name: str) -> None:
    made = small(1, 1, 0)
    model = CombinedLinearGaussianTransitionModel(
        [ConstantVelocity(0.0)] * 2
    )  # q = 0: a velocity stays known
    reward = UncertaintyRewardFunction(KalmanPredictor(model), ExtendedKalmanUpdater(None))
    tracks = [track_at([30, 1, 30, 0], [9, 0, 9, 0]), track_at([-30, 0, 30, 0], [4, 0, 9, 0])]
    asked: Any = reward if name == "uncertainty" else name
    ours = VedetteSensorManager(set(made.sensors), predictor=reward.predictor, reward_function=asked)
    (config,) = ours.choose_actions(tracks, THEN)
    assert ours.last is not None
    if name == "uncertainty":
        assert ours.last.reward == pytest.approx(float(reward(config, tracks, THEN)), rel=1e-6)
        assert ours.last.reward == pytest.approx(brute(ours, reward, tracks), rel=1e-6)
    else:
        assert np.isfinite(ours.last.reward)


@pytest.mark.parametrize(
    ("kind", "noise"),
    [
        (RadarElevationBearingRange, [3e-4, 3e-4, 25.0]),
        (RadarBearingRangeRate, [3e-4, 25.0, 1.0]),
        (RadarElevationBearingRangeRate, [3e-4, 3e-4, 25.0, 1.0]),
    ],
)
def test_elevations_and_range_rates_in_three_dimensions_are_worth_what_stone_soup_says(
    kind: Any, noise: list[float]
) -> None:
    rates = {"velocity_mapping": (1, 3, 5)} if len(noise) == 4 or noise[1] == 25.0 else {}
    seat = kind(
        position=StateVector([5.0, 5.0, 0.0]), position_mapping=(0, 2, 4), ndim_state=6,
        noise_covar=np.diag(noise), **rates,
    )  # fmt: skip
    seat.timestamp = START
    rng = np.random.default_rng(0)
    tracks = [track_at(rng.uniform(-50, 50, 6).tolist(), [9, 1, 9, 1, 9, 1]) for _ in range(3)]
    model = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.05)] * 3)
    reward = UncertaintyRewardFunction(KalmanPredictor(model), ExtendedKalmanUpdater(None))
    ours = VedetteSensorManager({seat}, reward_function=reward)
    (config,) = ours.choose_actions(tracks, THEN)
    assert ours.last is not None
    assert ours.last.reward == pytest.approx(float(reward(config, tracks, THEN)), rel=1e-6)


def test_a_range_rate_from_the_target_itself_is_refused_by_name() -> None:
    seat = RadarBearingRangeRate2D(
        position=StateVector([5.0, 5.0]), position_mapping=(0, 2), velocity_mapping=(1, 3), ndim_state=4,
        noise_covar=np.diag([3e-4, 25.0, 1.0]),
    )  # fmt: skip
    seat.timestamp = START
    on_it = track_at([5, 0, 5, 0], [9, 1, 9, 1])
    with pytest.raises(InputError, match=f"RadarBearingRangeRate2D: .* no slope at .* track {on_it.id}"):
        VedetteSensorManager({seat}, predictor=Still()).choose_actions({on_it}, THEN)


def test_without_stone_soup_the_import_names_the_extra() -> None:
    program = "import sys; sys.modules['stonesoup'] = None; import vedette.stonesoup"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == (
        "ImportError: vedette.stonesoup needs Stone Soup; run: pip install 'vedette[stonesoup]'"
    )


# -- benchmark --------------------------------------------------------------------------------------


def test_the_benchmark_judges_shares_in_the_worst_scene_and_time_in_the_median() -> None:
    from bench.stonesoup.__main__ import judge, table

    found = [
        {
            OURS: Decision(0.01, 1.0),
            LOG_DET: Decision(0.02, share),
            GREEDY: Decision(0.1, 0.9),
            BRUTE: Decision(9.0, 1.0),
        }
        for share in (1.0, 0.98)
    ]
    few, many = (
        table(2, 8, found),
        table(16, 8, [{k: v for k, v in each.items() if k != BRUTE} for each in found]),
    )
    assert [row.manager for row in many] == [OURS, LOG_DET, GREEDY]
    exact, best, cpu = judge([*few, *many])
    assert (exact.measured, exact.verdict) == (1.0, "MET")
    assert (best.measured, best.verdict) == (0.98, "MISSED")
    assert (cpu.measured, cpu.verdict) == (pytest.approx(0.2), "MET")


# -- example ----------------------------------------------------------------------------------------

EXAMPLE = ROOT / "examples" / "stonesoup_radars.py"


def test_the_example_takes_at_most_sixty_lines_and_keeps_the_targets(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 60
    names = runpy.run_path(str(EXAMPLE))
    out = capsys.readouterr().out.splitlines()
    assert [line[:4] for line in out[:-1]] == [f"{second:02d} s" for second in range(1, 9)]
    assert out[-1].endswith("m on average")
    assert names["done"].reward <= names["done"].bound + 1e-9
    assert np.mean(names["errors"]) < 3.0  # where they were at first
