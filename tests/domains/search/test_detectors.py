"""Detectors: what they report and how likely that is; evidence as exact integers."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import DefiniteRange, Detector, ExponentialRange, detector_from
from vedette.domains.search.evidence import NO_EVIDENCE, evidence
from vedette.errors import InputError
from vedette.maps import GridFrame

FRAME = GridFrame(5.0, 60, 60, -150.0, -150.0)
POSE = (10.0, -20.0, 0.8)
DETECTORS = [
    DefiniteRange(detection=0.7, range=60.0, noise=6.0, false_alarm=0.2),
    DefiniteRange(detection=0.9, range=90.0, view=100.0, noise=8.0, false_alarm=0.05),
    ExponentialRange(detection=0.95, range=100.0, sigma=50.0, noise=5.0, false_alarm=0.1),
]


@pytest.mark.parametrize("detector", DETECTORS)
def test_glimpses_come_as_often_as_the_law_says(detector: Detector) -> None:
    rng = np.random.default_rng(0)
    target = (30.0, 0.0)  # ahead
    reports = [detector.glimpse(rng, POSE, target) for _ in range(4000)]
    chance = float(detector.probability(np.hypot(20.0, 20.0)))
    expected = chance + (1 - chance) * detector.false_alarm
    share = np.mean([report is not None for report in reports])
    assert abs(share - expected) < 3 * np.sqrt(expected * (1 - expected) / 4000)


@pytest.mark.parametrize("detector", DETECTORS)
def test_footprints_are_the_law_averaged_over_a_cell(detector: Detector) -> None:
    _, cells, shares = detector.footprints(FRAME, np.array([[POSE]]))
    rng = np.random.default_rng(1)
    for k in rng.choice(len(cells), 5, replace=False):
        places = FRAME.centres(cells[k : k + 1]) + rng.uniform(-2.5, 2.5, (3000, 2))
        silent = DefiniteRange if isinstance(detector, DefiniteRange) else ExponentialRange
        quiet = silent(**{**detector.__dict__, "false_alarm": 0.0})
        seen = np.mean([quiet.glimpse(rng, POSE, place) is not None for place in places])
        assert abs(seen - shares[k]) < 0.13  # four points stand for the cell; the edge is the worst


@pytest.mark.parametrize("detector", DETECTORS)
def test_likelihood_ratios_average_to_one_where_there_is_no_target(detector: Detector) -> None:
    """``sum_z p(z | nobody) p(z | x) / p(z | nobody) = 1`` for every x: reports are normalised."""
    rng = np.random.default_rng(2)
    ratios = np.zeros(FRAME.size)
    runs = 3000
    nowhere = (5000.0, 5000.0)
    for _ in range(runs):
        cells, log_ratio = detector.log_likelihood(FRAME, POSE, detector.glimpse(rng, POSE, nowhere))
        ratio = np.ones(FRAME.size)
        ratio[cells] = np.exp(log_ratio)
        ratios += ratio / runs
    inside, _ = detector.log_likelihood(FRAME, POSE, None)
    deep = np.hypot(*(FRAME.centres(inside) - (40.0, 10.0)).T) < 18.0  # noise leaves none of it outside
    assert deep.sum() > 20
    assert ratios[inside][deep].mean() == pytest.approx(1.0, abs=0.15)


def test_many_looks_find_the_target_in_spite_of_false_alarms() -> None:
    rng = np.random.default_rng(3)
    detector = DETECTORS[0]
    target = (30.0, 5.0)
    pdf = TargetPdf(FRAME, np.ones(FRAME.shape))
    for _ in range(25):
        pdf = pdf.observe(*detector.log_likelihood(FRAME, POSE, detector.glimpse(rng, POSE, target)))
    assert pdf.probability_near(*target, 8.0) > 0.95


def test_no_report_lowers_the_pdf_where_the_sensor_looked() -> None:
    detector = DefiniteRange(detection=1.0, range=60.0)
    pdf = TargetPdf(FRAME, np.ones(FRAME.shape))
    after = pdf.observe(*detector.log_likelihood(FRAME, POSE, None))
    assert after.probability_near(*POSE[:2], 50.0) < 1e-8
    found = pdf.observe(*detector.log_likelihood(FRAME, POSE, (30.0, 0.0)))
    assert found.probability_near(30.0, 0.0, 40.0) > 0.999


def test_detectors_are_made_by_name() -> None:
    made = detector_from({"type": "exponential", "sigma": 40, "range": 120.0})
    assert made == ExponentialRange(sigma=40, range=120.0)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({}, "unknown type None"),
        ({"type": "exponental"}, "did you mean 'exponential'"),
        ({"type": "definite", "rnge": 3}, "did you mean 'range'"),
        ({"type": "definite", "range": -3}, "range must be"),
        ({"type": "definite", "detection": 1.2}, "detection must be 0 to 1"),
        ({"type": "definite", "noise": float("nan")}, "noise: must be a finite number"),
        ({"type": "definite", "view": "wide"}, "view: must be a number"),
        ({"type": "exponential", "sigma": 0}, "sigma must be"),
    ],
)
def test_bad_detector_settings_are_refused_by_name(settings: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        detector_from(settings)


def some_evidence(seed: int) -> object:
    rng = np.random.default_rng(seed)
    cells = np.flatnonzero(rng.random(FRAME.size) < 0.1).astype(np.uint32)
    return evidence(cells, rng.normal(0.0, 3.0, len(cells)))


def test_evidence_adds_up_the_same_in_any_order() -> None:
    a, b, c = (some_evidence(seed) for seed in range(3))
    assert (a + b) + c == a + (c + b)  # type: ignore[operator]
    assert a + NO_EVIDENCE == a  # type: ignore[operator]
