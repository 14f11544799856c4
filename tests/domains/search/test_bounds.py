"""Ideal bounds on searching, and the figures by which a search is judged."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.search_scenes import search
from vedette.domains.search import bounds, metrics, worth
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import DefiniteRange, Detector, ExponentialRange
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.maps import GridFrame


def test_a_definite_sensor_sweeps_its_diameter_and_effort_is_its_log_miss() -> None:
    sensor = DefiniteRange(detection=0.5, range=80.0)
    assert bounds.sweep_width(DefiniteRange(detection=1.0, range=80.0), 40.0, 0.1) == pytest.approx(
        160.0, rel=0.01
    )
    assert bounds.search_effort(sensor) == pytest.approx(np.log(2) * np.pi * 80.0**2, rel=1e-9)
    assert bounds.search_effort(DefiniteRange(detection=1.0)) == np.inf


def test_the_effort_of_a_faint_look_is_the_integral_of_its_probability_over_the_disc() -> None:
    faint = ExponentialRange(detection=1e-7, range=50.0, sigma=50.0, view=90.0)
    whole = 1e-7 * np.pi * 50.0**2 * (1.0 - np.exp(-1.0))
    assert bounds.search_effort(faint) == pytest.approx(0.25 * whole, rel=1e-6, abs=0.0)


def test_faint_looks_sweep_as_wide_as_their_effort_over_their_spacing() -> None:
    sensor = ExponentialRange(detection=0.01, range=200.0, sigma=50.0)
    spacing = 40.0 * 1.0
    width = bounds.sweep_width(sensor, 40.0, 1.0)
    assert width == pytest.approx(bounds.search_effort(sensor) / spacing, rel=0.03)


def test_the_best_allocation_beats_random_ones_and_meets_its_closed_forms() -> None:
    rng = np.random.default_rng(0)
    mass = rng.dirichlet(np.full(40, 0.4))
    for effort in (0.0, 3.0, 50.0, 1000.0):
        best = bounds.allocation(mass, 2.0, effort)
        for _ in range(200):
            density = rng.dirichlet(np.full(40, 0.3)) * effort / 2.0
            assert mass @ (1 - np.exp(-density)) <= best + 1e-12
    swept = np.linspace(0.0, 3e5, 7)
    uniform = bounds.allocation(np.full((50, 50), 1 / 2500), 100.0, swept)
    np.testing.assert_allclose(uniform, bounds.random_search(swept, 2.5e5), atol=1e-12)


def test_on_a_circular_gaussian_the_best_allocation_is_koopmans() -> None:
    frame = GridFrame(10.0, 200, 200)
    mass = gaussians(frame, [GaussianPart((1000.0, 1000.0), 150.0)])
    swept = np.array([1e3, 1e4, 1e5, 4e5])
    np.testing.assert_allclose(
        bounds.allocation(mass, 100.0, swept), bounds.gaussian(swept, 150.0), atol=2e-3
    )


def test_top_mass_gathers_the_best_cells_first() -> None:
    mass = np.array([[0.1, 0.5], [0.3, 0.1]])
    np.testing.assert_allclose(bounds.top_mass(mass, 4.0, [0.0, 4.0, 6.0, 16.0, 99.0]), [0, 0.5, 0.65, 1, 1])
    np.testing.assert_allclose(bounds.parallel_sweep([0.0, 50.0, 400.0], 100.0), [0.0, 0.5, 1.0])


@pytest.mark.parametrize(
    "detector",
    [
        DefiniteRange(detection=0.6, range=80.0),
        ExponentialRange(detection=0.8, range=150.0, sigma=60.0),
        DefiniteRange(detection=1.0, range=80.0),
    ],
)
def test_no_simulated_search_does_better_than_the_bounds(detector: Detector) -> None:
    frame = GridFrame(20.0, 60, 60)
    target = TargetPdf(frame, gaussians(frame, [GaussianPart((600.0, 600.0), 180.0)]), dt=2.0)
    team = [SearchPlatform(speed=40.0, turn_rate=0.4, detector=detector, controls=3) for _ in range(2)]
    for i, platform in enumerate(team):
        platform.place((500.0 + 200.0 * i, 450.0, 1.0), None)
    _, missed, _ = search(team, target, worth.plain(3), rounds=8)
    found = 1.0 - np.cumprod(missed)
    steps = np.arange(1, len(missed) + 1)
    looks = steps * len(team) * team[0].looks_a_step(2.0)
    area = bounds.covered_area(detector, 40.0, steps * 2.0, len(team))
    ceiling = bounds.top_mass(target.mass, 400.0, area)
    effort = bounds.search_effort(detector)
    if np.isfinite(effort):
        ceiling = np.minimum(ceiling, bounds.allocation(target.mass, 400.0, looks * effort))
    assert (found <= ceiling).all()
    assert found[-1] > 0.45 * ceiling[-1]


def test_the_mean_time_to_detection_is_that_of_what_each_step_detects() -> None:
    detection = np.array([0.1, 0.37, 0.37, 0.685])
    found_at = 2.0 * np.arange(1, 5)
    first = np.diff(detection, prepend=0.0)
    left = 1 - detection[-1]
    assert metrics.mean_time_to_detection(detection, 2.0) == pytest.approx(first @ found_at + left * 8.0)
    assert metrics.mean_time_to_detection(detection, 2.0, tail=5.0) == pytest.approx(
        first @ found_at + left * 13.0
    )
    assert metrics.mean_time_to_detection([], 2.0, tail=5.0) == 5.0
