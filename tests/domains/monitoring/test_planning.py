"""Plans on larger cells: what they take a measurement for, and how near that comes to the field's own."""

from __future__ import annotations

import numpy as np
import pytest

from vedette import InputError
from vedette.domains.monitoring.banded import BandedField, LayerLooks
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import NOTHING, impact_of
from vedette.domains.monitoring.objective import MonitoringBelief
from vedette.domains.monitoring.planning import Outlook, deviations_of
from vedette.domains.monitoring.platform import FieldSensor, MonitoringPlatform
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.worth import Patrol
from vedette.maps import GridFrame

FRAME = GridFrame(1.0, 48, 60)


def outlook(length: float) -> Outlook:
    return Outlook(FieldModel(FRAME, deviation=2.0, length=length), Spots(FRAME, (1, 5)))


def test_planning_cells_are_at_most_half_a_length_wide_and_not_too_few() -> None:
    assert [outlook(length).factor for length in (1.0, 3.9, 4.0, 10.0, 500.0)] == [1, 1, 2, 5, 6]
    assert min(outlook(500.0).model.frame.shape) >= 8


def test_where_planning_cells_are_the_fields_own_nothing_is_changed() -> None:
    fine = outlook(2.0)
    assert fine.apart == 0.0
    known = FieldBelief.prior(fine.fine, fine.spots).observe(np.array([5, 2900]), np.ones(2), np.full(2, 0.3))
    np.testing.assert_allclose(fine.of(known).information, known.information)
    assert fine.sensor(FieldSensor(0.3, 5)) == FieldSensor(0.3, 5)


def test_what_a_place_differs_from_its_planning_cell_is_what_draws_show() -> None:
    """In draws of the field: a random place of a planning cell against the place in its middle."""
    plan = outlook(10.0)
    rng = np.random.default_rng(1)
    apart = []
    for _ in range(200):
        blocks = plan.fine.sample(rng)[:45].reshape(9, 5, 12, 5)
        apart.append(((blocks - blocks[:, 2:3, :, 2:3]) ** 2).mean())
    half = 0.5 * float(np.mean(apart))  # Var(a - b) = 2 s^2 (1 - rho)
    assert half == pytest.approx(plan.apart, rel=0.25)


def test_the_way_that_is_best_on_planning_cells_is_nearly_so_on_the_fields_own() -> None:
    """Mutual information of all ways of a fan, on both grids, after some evidence."""
    plan, patrol = outlook(10.0), Patrol(24.0, 1, 1.0)
    rng = np.random.default_rng(2)
    shares = []
    for _ in range(6):
        at = rng.choice(FRAME.size, 60, replace=False)
        known = FieldBelief.prior(plan.fine, plan.spots).observe(at, np.zeros(60), np.full(60, 0.2))
        sensor = FieldSensor(0.2)
        here = rng.uniform((5.0, 5.0), (55.0, 43.0))
        gains = []
        for belief, seen in ((known, sensor), (plan.of(known), plan.sensor(sensor))):
            frozen = MonitoringBelief(belief, patrol, 0.25 / seen.variance)
            platform = MonitoringPlatform(1.0, seen, ground=FRAME)
            platform.place(here[0], here[1], 99.0)
            platform.prepare(frozen)
            gains.append(platform.gains(frozen, NOTHING))
        exact, coarse = gains
        assert coarse.max() < exact.max()  # what lies within a planning cell does not count
        shares.append(exact[coarse.argmax()] / exact.max())
    assert min(shares) > 0.85
    assert np.mean(shares) > 0.93


def test_gains_of_ways_are_differences_of_determinants() -> None:
    belief = FieldBelief.prior(
        FieldModel(GridFrame(1.0, 9, 7), length=3.0), Spots(GridFrame(1.0, 9, 7), (1, 3))
    )
    banded = BandedField(belief)
    rng = np.random.default_rng(3)
    impacts = [
        impact_of(rng.integers(0, belief.spots.count, 9), rng.integers(0, 2, 9), 40, 2) for _ in range(5)
    ]
    before = rng.integers(0, 3, belief.spots.count) * 100
    posterior = banded.posterior(0.1 * before)
    for looks, last in zip(LayerLooks.of(impacts, 2), range(2), strict=True):
        gains = looks.gains(posterior, before, 0.1)
        for impact, gain in zip(impacts, gains, strict=True):
            spot, layer = np.divmod(impact.keys.astype(np.int64), 2)
            total = before + np.bincount(
                spot[layer <= last], impact.misses[layer <= last], belief.spots.count
            ).astype(np.int64)
            after = banded.posterior(0.1 * np.minimum(total, 255))
            assert gain == pytest.approx(0.5 * (after.log_det - posterior.log_det), abs=1e-9)


def test_a_field_of_too_many_cells_to_plan_on_is_refused() -> None:
    frame = GridFrame(1.0, 400, 400)
    with pytest.raises(InputError, match="take larger cells"):
        BandedField(FieldBelief.prior(FieldModel(frame), Spots(frame)))


def test_deviations_are_those_of_the_inverse_and_on_planning_cells_near_them() -> None:
    plan = outlook(12.0)
    rng = np.random.default_rng(4)
    at = rng.choice(FRAME.size, 40, replace=False)
    known = FieldBelief.prior(plan.fine, plan.spots).observe(at, np.zeros(40), np.full(40, 0.2))
    exact = deviations_of(known)
    some = rng.choice(FRAME.size, 30, replace=False)
    np.testing.assert_allclose(exact.ravel()[some], known.deviations(some), rtol=1e-8)
    assert np.abs(plan.deviations(known) - exact).mean() < 0.25 * exact.mean()


@pytest.mark.parametrize(
    ("rows", "cols", "sides"), [(2, 8, (5,)), (4, 4, (1, 3)), (6, 7, (5,)), (9, 8, (15,))]
)
def test_the_widest_blocks_of_a_small_field_are_factorised_in_its_band(
    rows: int, cols: int, sides: tuple[int, ...]
) -> None:
    """Against the dense matrix."""
    frame = GridFrame(1.0, rows, cols)
    spots = Spots(frame, sides)
    information = np.linspace(0.0, 5.0, spots.count)
    belief = FieldBelief.prior(FieldModel(frame, length=3.0), spots).add(information, 0.0 * information)
    posterior = BandedField(belief).posterior(np.zeros(spots.count))
    dense = belief.precision.toarray()
    assert posterior.log_det == pytest.approx(np.linalg.slogdet(dense)[1])
    np.testing.assert_allclose(posterior.deviations.ravel(), np.sqrt(np.diag(np.linalg.inv(dense))))
