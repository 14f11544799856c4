"""The searching vehicle: its candidates, its reply, and where it goes when what is near is worth little."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.search_scenes import (
    EYE,
    MOVING,
    OBJECTIVE,
    SEA,
    agree,
    frozen,
    pdf,
    random_impact,
    search,
    team,
)
from vedette.domains.search import worth
from vedette.domains.search.belief import TargetPdf, freeze
from vedette.domains.search.detectors import DefiniteRange
from vedette.domains.search.flights import Flight
from vedette.domains.search.impact import NOTHING, clip
from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.platform import MOST_CANDIDATES, SearchPlatform
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.errors import InputError
from vedette.maps import GridFrame

MOTIONS = [STILL, MOVING]


@pytest.mark.parametrize("motion", MOTIONS)
def test_gains_are_those_of_the_flights_impacts(motion: TargetMotion) -> None:
    belief = frozen(motion)
    platform = team(belief, size=1)[0]
    others = random_impact(belief, np.random.default_rng(1))
    assert platform.options is not None
    impacts = [platform.impact(belief, flight) for flight in platform.options.flights]
    gains = OBJECTIVE.values(belief, others, impacts) - OBJECTIVE.value(belief, others)
    np.testing.assert_allclose(platform.gains(belief, others), gains, atol=1e-12)
    assert platform.slack(belief, others) == pytest.approx(gains.max(), abs=1e-12)


def test_the_reply_is_the_best_flight_and_the_present_one_stays_unless_clearly_beaten() -> None:
    belief = frozen()
    platform = team(belief, size=1)[0]
    assert platform.options is not None
    gains = platform.gains(belief, NOTHING)
    best = platform.options.flights[int(np.argmax(gains))]
    assert platform.reply(belief, NOTHING, platform.start) == best
    close = np.flatnonzero(gains > 0.995 * gains.max())
    for k in close:
        assert platform.reply(belief, NOTHING, platform.options.flights[k]) is platform.options.flights[k]


@pytest.mark.parametrize("elapsed", [0, 1, 3, 4, 9])
def test_the_present_flight_shifted_by_the_steps_that_passed_is_a_candidate(elapsed: int) -> None:
    platform = SearchPlatform(speed=30.0, turn_rate=0.4, detector=EYE, controls=4)
    rates = np.array([0.4, 0.0, -0.1, 0.3])
    platform.place((0.0, 400.0, 0.0), Flight(3, rates, (300.0, 600.0)))
    belief = freeze(TargetPdf(SEA, pdf().mass, STILL, 2.0, 3 + elapsed), worth.plain(4))
    platform.prepare(belief)
    kept = rates[elapsed:]
    assert platform.start.turn_rates[: len(kept)].tolist() == kept.tolist()
    assert len(platform.start.turn_rates) == 4
    assert platform.start.step == 3 + elapsed
    assert platform.impact(belief, platform.start).keys.size > 0


@pytest.mark.parametrize("horizon", [1, 3, 5, 8, 20])
def test_candidates_stay_few_whatever_the_horizon(horizon: int) -> None:
    platform = SearchPlatform(speed=30.0, turn_rate=0.4, detector=EYE)
    platform.place((0.0, 400.0, 0.0), None)
    platform.prepare(frozen(STILL, worth.plain(horizon)))
    assert platform.options is not None
    assert len(platform.options.flights) <= MOST_CANDIDATES
    assert {len(flight.turn_rates) for flight in platform.options.flights} == {horizon}


def test_a_fast_vehicle_skips_no_cell_of_its_track() -> None:
    frame = GridFrame(10.0, 40, 200)
    belief = freeze(TargetPdf(frame, np.ones(frame.shape), STILL, 4.0), worth.plain(3, 0.0))
    platform = SearchPlatform(speed=100.0, turn_rate=0.0, detector=DefiniteRange(range=40.0, detection=1.0))
    platform.place((100.0, 200.0, 0.0), None)
    platform.prepare(belief)
    impact = platform.impact(belief, platform.start)
    seen = np.zeros(frame.size, int)
    np.maximum.at(seen, impact.keys // 3, impact.misses)
    track = seen.reshape(frame.shape)[17:23, 11:129]  # 30 m to either side of 1200 m of straight flight
    assert track.min() == 255


@pytest.mark.parametrize("motion", MOTIONS)
def test_clipping_a_message_to_a_vehicles_reach_leaves_its_gains_as_they_were(motion: TargetMotion) -> None:
    belief = frozen(motion, worth.plain(4, 0.0))
    platform = team(belief, size=1)[0]
    rng = np.random.default_rng(4)
    keys = np.flatnonzero(rng.random(SEA.size * belief.layers) < 0.3).astype(np.uint32)
    everywhere = type(NOTHING)(keys, rng.integers(1, 40, len(keys)).astype(np.uint8))
    clipped = clip(everywhere, SEA, belief.layers, platform.reach())
    assert len(clipped.keys) < 0.8 * len(keys)
    np.testing.assert_allclose(
        platform.gains(belief, clipped), platform.gains(belief, everywhere), atol=1e-14
    )


def far_sea() -> TargetPdf:
    """All the mass far from the start, in two places."""
    frame = GridFrame(25.0, 120, 120)
    parts = [GaussianPart((2600.0, 400.0), 80.0, 1.0), GaussianPart((400.0, 2600.0), 80.0, 0.9)]
    return TargetPdf(frame, gaussians(frame, parts), STILL, 2.0)


def test_with_all_mass_out_of_reach_a_team_flies_to_it_and_shares_it_out() -> None:
    platforms = [SearchPlatform(speed=40.0, turn_rate=0.3, detector=EYE, controls=4) for _ in range(2)]
    for i, platform in enumerate(platforms):
        platform.place((300.0 + 20.0 * i, 300.0, np.pi), None)
    _, _, poses = search(platforms, far_sea(), worth.plain(4), rounds=20)
    ends = poses[-1, :, :2]
    away = np.hypot(*(ends[:, None] - np.array([(2600.0, 400.0), (400.0, 2600.0)])).transpose(2, 0, 1))
    assert sorted(np.argmin(away, axis=1)) == [0, 1]
    assert away.min(axis=1).max() < 900.0  # from 2300 m, 1600 m of flight


def test_without_promises_a_vehicle_that_sees_nothing_flies_to_the_best_place() -> None:
    vehicle = SearchPlatform(speed=40.0, turn_rate=0.3, detector=EYE, controls=4)
    vehicle.place((-500.0, 300.0, np.pi), None)  # outside the area, and leaving it
    frame = GridFrame(25.0, 80, 120)
    target = TargetPdf(frame, gaussians(frame, [GaussianPart((1500.0, 400.0), 80.0)]), STILL, 2.0)
    _, missed, _ = search([vehicle], target, worth.plain(4, tail=0.0), rounds=24)
    assert np.prod(missed) < 0.7


def test_promises_lead_a_vehicle_away_from_leftovers() -> None:
    """Between a searched place and a rich one far off, a short horizon alone goes on gleaning."""

    def found(tail: float) -> float:
        frame = GridFrame(25.0, 60, 120)
        parts = [GaussianPart((400.0, 700.0), 80.0, 0.3), GaussianPart((2400.0, 700.0), 80.0, 0.7)]
        target = TargetPdf(frame, gaussians(frame, parts), STILL, 2.0)
        vehicle = SearchPlatform(speed=40.0, turn_rate=0.4, detector=EYE, controls=4)
        vehicle.place((300.0, 700.0, 0.0), None)
        _, missed, _ = search([vehicle], target, worth.plain(4, tail), rounds=45)
        return float(1.0 - np.prod(missed))

    assert found(1.0) > 0.8
    assert found(0.0) < 0.35


def test_two_vehicles_that_start_together_part() -> None:
    belief = frozen()
    platforms = [SearchPlatform(speed=30.0, turn_rate=0.4, detector=EYE, controls=4) for _ in range(2)]
    for platform in platforms:
        platform.place((0.0, 400.0, np.pi / 2), None)
        platform.prepare(belief)
    first, second = agree(platforms, belief)
    assert first != second


def test_a_sensor_that_stands_and_turns_looks_where_the_target_is() -> None:
    belief = frozen(STILL, worth.plain(4))
    post = SearchPlatform(
        speed=0.0, turn_rate=0.5, detector=DefiniteRange(range=300.0, view=60.0), controls=4
    )
    post.place((0.0, 300.0, 0.0), None)
    post.prepare(belief)
    flight = post.reply(belief, NOTHING, post.start)
    assert flight.turn_rates.sum() > 0.0  # towards the nearer place, to the left
    assert flight.goal is None


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"speed": -1.0}, "speed"),
        ({"turn_rate": float("nan")}, "turn_rate"),
        ({"choices": 4}, "odd"),
        ({"controls": 6}, "fewer controls"),
        ({"looks": 0}, "looks"),
    ],
)
def test_bad_settings_are_refused_by_name(settings: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        SearchPlatform(**settings)  # type: ignore[arg-type]
