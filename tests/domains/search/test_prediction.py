"""What a search is predicted to detect is what it does detect, however large its cells."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.domains.search import prediction
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import DefiniteRange, Detector, ExponentialRange
from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.prediction import parts_of, predicted
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.maps import GridFrame
from vedette.record.search.counting import dkw
from vedette.sim.search.trials import detected_at
from vedette.vehicle import drive

COARSE = GridFrame(25.0, 8, 10, 500_000.0, 4_000_000.0)
TRIALS, STEPS, LOOKS = 40_000, 30, 10
DETECTORS: dict[str, Detector] = {
    "a 25th of a cell": DefiniteRange(detection=0.9, range=1.0),
    "an 8th": DefiniteRange(detection=0.9, range=3.0),
    "two thirds": DefiniteRange(detection=0.9, range=16.0),
    "two cells": DefiniteRange(detection=0.9, range=50.0),
    "steep": ExponentialRange(detection=0.9, range=100.0, sigma=3.0),
    "narrow": DefiniteRange(detection=0.8, range=40.0, view=12.0),
}
MOTIONS = {"still": STILL, "drifting": TargetMotion((0.6, -0.3)), "diffusing": TargetMotion((0.3, 0.0), 2.0)}


def circling(turn_rate: float, radius: float) -> dict[int, NDArray[np.float64]]:
    """The looks of a vehicle that flies the same circle again and again."""
    pose = np.array((COARSE.origin_x + 130.0 + radius, COARSE.origin_y + 90.0, np.pi / 2))
    poses = drive(pose, np.full(LOOKS * STEPS, turn_rate), turn_rate * radius, 2.0 / LOOKS)
    return {step + 1: poses[LOOKS * step : LOOKS * (step + 1)] for step in range(STEPS)}


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("detector", DETECTORS)
def test_predicted_is_counted_though_cells_be_far_larger_than_the_range(detector: str, motion: str) -> None:
    prior = gaussians(COARSE, [GaussianPart((500_130.0, 4_000_090.0), 30.0)])
    pdf = TargetPdf(COARSE, prior, MOTIONS[motion], 2.0)
    sensors, looks = [DETECTORS[detector]], [circling(0.25, 30.0)]
    first = detected_at(pdf, sensors, looks, STEPS, TRIALS, np.random.default_rng(0))
    share = np.bincount(first, minlength=STEPS + 2)[: STEPS + 1].cumsum() / TRIALS
    off = np.abs(share - predicted(pdf, sensors, looks, STEPS).detection).max()
    assert off <= dkw(TRIALS, 0.999)
    assert share[-1] > 0.01


def test_what_is_detected_what_has_left_and_what_is_left_are_all() -> None:
    prior = gaussians(COARSE, [GaussianPart((500_130.0, 4_000_090.0), 30.0)])
    pdf = TargetPdf(COARSE, prior, TargetMotion((2.5, 0.5), 3.0, leaves=True), 2.0)
    sensors, looks = [DETECTORS["two thirds"]], [circling(0.25, 30.0)]
    found = predicted(pdf, sensors, looks, STEPS)
    rng = np.random.default_rng(0)
    first = detected_at(pdf, sensors, looks, STEPS, TRIALS, rng)
    share = np.bincount(first, minlength=STEPS + 2)[: STEPS + 1].cumsum() / TRIALS
    assert np.abs(share - found.detection).max() <= dkw(TRIALS, 0.999)
    assert (np.diff(found.outside) >= 0.0).all()
    assert (found.detection + found.outside <= 1.0 + 1e-12).all()
    blind = predicted(pdf, sensors, [{}], STEPS)
    assert blind.detection == pytest.approx(0.0, abs=1e-12)
    assert blind.outside[-1] == pytest.approx(pdf.finer(4).predict(STEPS).outside, abs=0.01)
    assert found.outside[-1] < blind.outside[-1] < 0.95


def test_cells_as_they_are_would_predict_twice_what_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    prior = gaussians(COARSE, [GaussianPart((500_130.0, 4_000_090.0), 30.0)])
    pdf, sensors, looks = TargetPdf(COARSE, prior, dt=2.0), [DETECTORS["an 8th"]], [circling(0.25, 30.0)]
    fine = predicted(pdf, sensors, looks, STEPS).detection[-1]
    monkeypatch.setattr(prediction, "parts_of", lambda pdf, detectors: 1)
    assert predicted(pdf, sensors, looks, STEPS).detection[-1] > 2.0 * fine


def test_a_prediction_cuts_cells_as_fine_as_the_sharpest_sensor_asks_and_no_finer_than_lasts() -> None:
    flat = np.ones(COARSE.shape)
    still, moving = TargetPdf(COARSE, flat), TargetPdf(COARSE, flat, TargetMotion(diffusion=50.0))
    sharp, blunt = DETECTORS["an 8th"], DETECTORS["two cells"]
    assert parts_of(still, [blunt]) == 4  # 6.25 m, an eighth of 50 m
    assert parts_of(still, [blunt, sharp]) == parts_of(still, [sharp]) == 67  # 0.373 m
    assert parts_of(moving, [sharp]) == 5  # the target diffuses by 10 m a step
    assert parts_of(TargetPdf(COARSE, flat, TargetMotion((400.0, 0.0))), [sharp]) == 62  # 16 cells a step


@pytest.mark.parametrize("detector", DETECTORS.values())
@pytest.mark.parametrize("report", [None, (500_137.0, 4_000_088.0)])
def test_the_likelihood_of_a_look_is_its_mean_over_a_cell(
    detector: Detector, report: tuple[float, float] | None
) -> None:
    alarming = type(detector)(**{**detector.__dict__, "false_alarm": 0.3, "noise": 12.0})
    pose = np.array((500_130.0, 4_000_090.0, 0.2))
    cells, log_ratio = alarming.log_likelihood(COARSE, pose, report)
    side = (np.arange(400) + 0.5) / 400.0 * 25.0 - 12.5
    offsets = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    area = np.radians(alarming.view) / 2.0 * alarming.range**2
    own = int(np.flatnonzero(cells == COARSE.flat(500_137.0, 4_000_088.0))[0])
    places = COARSE.centres(cells[own : own + 1]) + offsets
    chance = alarming.chance(pose, places)
    expected = 1.0 - chance
    if report is not None:
        square = ((places - report) ** 2).sum(axis=1)
        expected = expected + chance * np.exp(-square / 288.0) / (288.0 * np.pi) * area / 0.3
    assert np.exp(log_ratio[own]) == pytest.approx(expected.mean(), rel=0.1)
