"""The target's pdf: it moves without losing mass, Bayes' rule updates it, and priors say where it starts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from tests.support.search_scenes import MOVING, SEA, frozen, pdf
from vedette.domains.search import priors, worth
from vedette.domains.search.belief import TargetPdf, freeze
from vedette.domains.search.motion import TargetMotion, moves
from vedette.domains.search.priors import GaussianPart
from vedette.errors import InputError, InputWarning
from vedette.maps import GridFrame

UNIT = GridFrame(1.0, 8, 10)


@settings(deadline=None, max_examples=60)
@given(mean=st.floats(-30, 30), variance=st.floats(0, 40))
def test_a_stencil_has_the_mean_and_variance_of_the_motion(mean: float, variance: float) -> None:
    first, taps = moves(mean, variance)
    at = first + np.arange(len(taps))
    fraction = mean - np.floor(mean)
    assert taps.sum() == pytest.approx(1.0, abs=1e-14)
    assert taps @ at == pytest.approx(mean, abs=1e-9)
    least = fraction * (1 - fraction)  # linear sharing between two cells cannot spread less
    assert taps @ (at - mean) ** 2 == pytest.approx(max(variance, least), rel=0.03, abs=2e-3)


@pytest.mark.parametrize("motion", [MOVING, TargetMotion((50.0, -80.0)), TargetMotion(diffusion=3000.0)])
def test_moving_keeps_all_mass_and_the_borders_reflect_it(motion: TargetMotion) -> None:
    moved = pdf(motion).predict(40)
    assert moved.mass.sum() == pytest.approx(1.0, abs=1e-13)
    assert moved.mass.min() >= 0.0
    assert moved.step == 40


def test_the_grid_moves_as_true_targets_do() -> None:
    target = pdf(MOVING)
    rng = np.random.default_rng(0)
    cells = rng.choice(SEA.size, 40000, p=target.mass.ravel())
    places = SEA.centres(cells) + rng.uniform(-10, 10, (len(cells), 2))
    for _ in range(30):
        places = MOVING.move(rng, places, SEA, target.dt)
    mass = target.predict(30).mass.ravel()
    centres = SEA.centres(np.arange(SEA.size))
    mean = mass @ centres
    np.testing.assert_allclose(places.mean(axis=0), mean, atol=6.0)  # three sigma of the sample's
    deviation = np.sqrt(mass @ (centres - mean) ** 2)
    np.testing.assert_allclose(places.std(axis=0), deviation, rtol=0.02)
    assert (places >= (-300.0, 100.0)).all()
    assert (places <= (1100.0, 1300.0)).all()


LEAVING = TargetMotion((14.0, -6.0), 60.0, leaves=True)


def test_what_leaves_the_grid_is_outside_as_often_as_true_targets_are() -> None:
    target = pdf(LEAVING)
    rng = np.random.default_rng(0)
    cells = rng.choice(SEA.size, 40000, p=target.mass.ravel())
    places = SEA.centres(cells) + rng.uniform(-10, 10, (len(cells), 2))
    for step in range(1, 31):
        places = LEAVING.move(rng, places, SEA, target.dt)
        target = target.predict()
        inside = SEA.holds(places)
        assert target.outside == pytest.approx(1.0 - inside.mean(), abs=0.01), step
        assert target.mass.sum() + target.outside == pytest.approx(1.0, abs=1e-12)
    assert 0.5 < target.outside < 0.95
    gone = places[~inside]
    np.testing.assert_array_equal(LEAVING.move(rng, places, SEA, target.dt)[~inside], gone)


def test_looks_in_vain_make_it_likelier_that_the_target_has_left() -> None:
    prior = TargetPdf(UNIT, np.arange(80.0).reshape(8, 10), outside=1000.0)
    likelihood = np.random.default_rng(1).random(80)
    posterior = prior.observe(np.arange(80), np.log(likelihood))
    expected = np.append(np.arange(80.0) * likelihood, 1000.0)
    expected /= expected.sum()
    np.testing.assert_allclose(posterior.mass.ravel(), expected[:80], atol=1e-15)
    assert posterior.outside == pytest.approx(expected[80], abs=1e-14)
    assert posterior.entropy == pytest.approx(
        -(expected[expected > 0] * np.log(expected[expected > 0])).sum()
    )
    sure = TargetPdf(UNIT, np.zeros((8, 10)), outside=1.0).observe(np.arange(3), np.full(3, -9.0))
    assert (sure.outside, sure.mass.sum(), sure.entropy) == (1.0, 0.0, 0.0)


def test_observing_is_bayes_rule() -> None:
    prior = TargetPdf(UNIT, np.arange(80.0).reshape(8, 10))
    likelihood = np.random.default_rng(1).random(80)
    posterior = prior.observe(np.arange(80), np.log(likelihood))
    expected = prior.mass.ravel() * likelihood
    np.testing.assert_allclose(posterior.mass.ravel(), expected / expected.sum(), atol=1e-15)


def test_even_very_unlikely_reports_leave_a_pdf() -> None:
    prior = TargetPdf(UNIT, np.ones((8, 10)))
    posterior = prior.observe(np.arange(80), np.linspace(-3000.0, -2000.0, 80))
    assert posterior.best_cell == (7, 9)
    assert posterior.mass.sum() == pytest.approx(1.0)


def test_entropy_and_probabilities_of_regions() -> None:
    flat = TargetPdf(UNIT, np.ones((8, 10)))
    assert flat.entropy == pytest.approx(np.log(80))
    assert flat.probability_in(np.arange(80).reshape(8, 10) < 20) == pytest.approx(0.25)
    assert flat.probability_near(0.5, 0.5, 1.0) == pytest.approx(3 / 80)


def test_a_gaussian_prior_has_its_mean_and_covariance() -> None:
    covariance = ((8000.0, 3000.0), (3000.0, 5000.0))
    mass = priors.gaussians(SEA, [GaussianPart((400.0, 700.0), covariance)]).ravel()
    centres = SEA.centres(np.arange(SEA.size))
    np.testing.assert_allclose(mass @ centres, (400.0, 700.0), atol=2.0)
    off = centres - mass @ centres
    np.testing.assert_allclose((off * mass[:, None]).T @ off, covariance, rtol=0.03)


def test_a_gaussian_narrower_than_a_cell_is_not_lost() -> None:
    mass = priors.gaussians(SEA, [GaussianPart((413.0, 707.0), 0.5)])
    assert np.unravel_index(int(np.argmax(mass)), SEA.shape) == SEA.cell(413.0, 707.0)


def test_a_polygon_is_uniform_inside_and_shares_its_edge_cells() -> None:
    mass = priors.polygon(UNIT, [(1, 1), (5, 1), (5, 3.5), (1, 3.5)])
    full = mass[1, 1]
    assert full == pytest.approx(1 / 10)
    assert mass[3, 2] == pytest.approx(full / 2)
    assert mass[1:3, 1:5].min() == mass[1:3, 1:5].max() == full
    assert np.count_nonzero(mass) == 12


@pytest.mark.parametrize("size", [(5, 4), (20, 16), (7, 3)])
def test_a_heat_map_keeps_the_share_of_every_quarter(tmp_path: Path, size: tuple[int, int]) -> None:
    grey = np.random.default_rng(2).integers(0, 255, size[::-1]).astype(np.uint8)
    Image.fromarray(grey).save(tmp_path / "heat.png")
    mass = priors.heat_map(UNIT, tmp_path / "heat.png")
    fine = np.kron(grey[::-1], np.ones((8, 10))) / (grey.sum() * 80.0)  # both divide this grid
    rows, cols = fine.shape[0] // 2, fine.shape[1] // 2
    assert mass.sum() == pytest.approx(1.0)
    assert mass[:4, :5].sum() == pytest.approx(fine[:rows, :cols].sum(), abs=1e-6)
    assert mass[4:, :5].sum() == pytest.approx(fine[rows:, :cols].sum(), abs=1e-6)


def test_a_heat_map_with_a_place_of_its_own_lies_there(tmp_path: Path) -> None:
    """Of an area of 10 m by 8 m the map covers x 4 to 12 and y -2 to 6, in pixels of 0.5 m and 2 m."""
    values = np.random.default_rng(3).random((4, 16))
    np.save(tmp_path / "heat.npy", values)
    with pytest.warns(InputWarning, match=r"\d\d% of it is outside the area"):
        mass = priors.heat_map(UNIT, tmp_path / "heat.npy", (4.0, -2.0, 12.0, 6.0))
    fine = np.kron(values, np.ones((4, 1)))[4:, :12]  # of 0.5 m, inside the area
    expected = np.zeros((8, 10))
    expected[:6, 4:] = fine.reshape(6, 2, 6, 2).sum(axis=(1, 3))
    np.testing.assert_allclose(mass, expected / expected.sum(), atol=1e-12)
    with pytest.raises(InputError, match="beside the area"):
        priors.heat_map(UNIT, tmp_path / "heat.npy", (10.0, 0.0, 20.0, 8.0))


def test_a_mixture_weighs_its_parts() -> None:
    half = np.zeros(UNIT.shape)
    half[0] = 1.0 / 10
    mass = priors.mixture(UNIT, [(3.0, half), (1.0, priors.uniform(UNIT))])
    assert mass[0].sum() == pytest.approx(0.75 + 0.25 / 8)


def vast() -> TargetPdf:
    target = TargetPdf(UNIT, np.ones((8, 10)))
    object.__setattr__(target, "frame", GridFrame(1.0, 60000, 60000))  # its mass would be 29 GB
    return target


def black(folder: Path) -> Path:
    Image.new("L", (4, 4)).save(folder / "black.png")
    return folder / "black.png"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda _: TargetPdf(UNIT, np.ones((10, 8))), r"\(10, 8\).*\(8, 10\)"),
        (lambda _: TargetPdf(UNIT, np.zeros((8, 10))), "no mass"),
        (lambda _: TargetPdf(UNIT, -np.ones((8, 10))), ">= 0"),
        (lambda _: TargetPdf(UNIT, np.full((8, 10), np.nan)), "nan"),
        (lambda _: TargetPdf(UNIT, np.ones((8, 10)), dt=0.0), "step length"),
        (lambda _: TargetMotion(diffusion=-1.0), "diffusion"),
        (lambda _: TargetMotion((np.inf, 0.0)), "drift"),
        (lambda _: TargetMotion((5000.0, 0.0)).stencil(1.0, 1.0), "shorter steps"),
        (lambda _: priors.gaussians(UNIT, []), "empty"),
        (lambda _: priors.gaussians(UNIT, [GaussianPart((4, 4), 1.0, -2.0)]), "gaussian 1: weight"),
        (lambda _: priors.gaussians(UNIT, [GaussianPart((4, np.nan), 1.0)]), "gaussian 1: mean"),
        (lambda _: priors.gaussians(UNIT, [GaussianPart((4, 4), 0.0)]), "sigma"),
        (lambda _: priors.gaussians(UNIT, [GaussianPart((4, 4), ((1, 2), (2, 1)))]), "positive definite"),
        (lambda _: priors.gaussians(UNIT, [GaussianPart((4, 400), 1.0)]), "in the area"),
        (lambda _: priors.polygon(UNIT, [(0, 0), (1, 1)]), "three corners"),
        (lambda _: priors.polygon(UNIT, [(0, 0), (1, np.nan), (2, 2)]), "finite"),
        (lambda _: priors.polygon(UNIT, [(50, 50), (60, 50), (50, 60)]), "in the area"),
        (lambda folder: priors.heat_map(UNIT, black(folder)), "black.png has no mass"),
        (lambda folder: priors.heat_map(UNIT, folder / "none.png"), "none.png"),
        (lambda _: priors.mixture(UNIT, [(0.0, np.ones(UNIT.shape))]), "weight of part 1"),
        (lambda _: freeze(vast(), worth.plain(5)), "too many"),
    ],
)
def test_bad_input_is_refused_by_name(tmp_path: Path, make: Callable[[Path], object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        make(tmp_path)


def test_a_rounds_belief_knows_the_density_at_its_end() -> None:
    np.testing.assert_allclose(frozen(MOVING).afterwards, pdf(MOVING).predict(4).mass, atol=1e-15)
