"""A place is declared when the posterior there says so, and is then wrong no more often than that says."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.declaring import declared_place
from vedette.domains.search.detectors import DefiniteRange
from vedette.domains.search.evidence import LEVELS_PER_NAT, evidence_of_looks
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.maps import GridFrame

FRAME = GridFrame(20.0, 25, 25)
SENSOR = DefiniteRange(detection=0.5, range=90.0, noise=15.0, false_alarm=0.3)
RADIUS = 50.0


def test_the_place_is_the_likeliest_cells_middle_once_its_neighbourhood_holds_enough() -> None:
    mass = np.zeros(FRAME.shape)
    mass[10, 12], mass[11, 12], mass[2, 2] = 0.5, 0.25, 0.25
    pdf = TargetPdf(FRAME, mass)
    assert declared_place(pdf, 0.75, 30.0) == (250.0, 210.0)
    assert declared_place(pdf, 0.76, 30.0) is None
    assert declared_place(pdf, 0.75, 15.0) is None
    assert declared_place(TargetPdf(FRAME, mass, outside=0.1), 0.75, 30.0) is None  # it may have left


def outcome(rng: np.random.Generator, probability: float) -> str:
    """Look from places drawn at random until a place is declared; tell whether the target is near it."""
    pdf = TargetPdf(FRAME, gaussians(FRAME, [GaussianPart((250.0, 250.0), 90.0)]))
    cell = rng.choice(FRAME.size, p=pdf.mass.ravel())
    target = FRAME.centres(np.array([cell]))[0] + rng.uniform(-10.0, 10.0, 2)
    for _ in range(40):
        pose = np.array((*rng.uniform(100.0, 400.0, 2), 0.0))
        told = evidence_of_looks(SENSOR, FRAME, pose[None], [SENSOR.glimpse(rng, pose, target)])
        pdf = pdf.observe(told.cells, told.levels / LEVELS_PER_NAT)
        place = declared_place(pdf, probability, RADIUS)
        if place is not None:
            near = np.hypot(*np.subtract(place, target)) <= RADIUS
            return "right" if near else "wrong"
    return "never"


@pytest.mark.parametrize("probability", [0.6, 0.9])
def test_declared_places_are_wrong_no_more_often_than_their_posteriors_say(probability: float) -> None:
    """By Bayes' rule, whenever one stops. Some are wrong: the test would see an overconfident filter."""
    rng = np.random.default_rng(5)
    told = [outcome(rng, probability) for _ in range(400)]
    right, wrong = told.count("right"), told.count("wrong")
    assert right > 100
    share, most = wrong / (right + wrong), 1.0 - probability
    assert 0.1 * most < share < most + 2.6 * np.sqrt(most * probability / (right + wrong))
