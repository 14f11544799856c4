"""Small searches for the tests of the mission, the simulation and the command."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.evidence import evidence_of_looks
from vedette.domains.search.prediction import predicted
from vedette.errors import InputWarning
from vedette.missions.search.case import SearchCase, made
from vedette.missions.search.scenario import SearchScenario
from vedette.record.log import Floats
from vedette.scenario import as_scenario
from vedette.sim.search.simulation import SearchSetup, SearchSimulation

EYE = {"type": "exponential", "detection": 0.7, "range": 100, "sigma": 60}
BOX = {"type": "definite", "detection": 0.9, "range": 70}
DRIFTING = {"drift": [0.8, -0.4], "diffusion": 3.0}
SMALL: dict[str, Any] = {
    "area": [0, 0, 1200, 800],
    "cell": 40,
    "duration": 44,
    "horizon": 6,
    "decisions": 2,
    "detector": EYE,
    "prior": [
        {"type": "gaussian", "mean": [350, 450], "sigma": 90},
        {"type": "gaussian", "mean": [800, 350], "sigma": 100, "weight": 2},
    ],
    "vehicles": [
        {"start": [200, 100, 60], "speed": 30, "turn_rate": 0.4},
        {"start": [280, 100, 60], "speed": 30, "turn_rate": 0.4},
        {"start": [360, 100, 60], "speed": 30, "turn_rate": 0.4},
    ],
}


def case(**changes: Any) -> SearchCase:
    """Return the small search with other fields; its cells may be large, for speed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", InputWarning)
        return made(as_scenario(SMALL | changes, SearchScenario, "small.yaml"), Path("small.yaml"))


def scattered(seed: int) -> SearchCase:
    """Return a search with parts and starts drawn at random, far from the border."""
    rng = np.random.default_rng(seed)
    prior = [
        {"type": "gaussian", "mean": rng.uniform((250, 250), (950, 550)).tolist(), "sigma": float(sigma)}
        for sigma in rng.uniform(60, 110, 3)
    ]
    x, y = rng.uniform((150, 100), (900, 500)).tolist()
    vehicles = [{"start": [x + 60 * i, y, 90], "speed": 30, "turn_rate": 0.4} for i in range(3)]
    return case(prior=prior, vehicles=vehicles)


def blind(search: SearchCase, **setup: Any) -> SearchSimulation:
    """Run a search in which nobody reports anything, to its end."""
    settings = {"max_time": search.scenario.duration, "blind": True} | setup
    simulation = SearchSimulation(search, SearchSetup(**settings))
    simulation.run(lambda: None)
    return simulation


def curve(simulation: SearchSimulation) -> Floats:
    """Return the probability of detection by each step."""
    search = simulation.case
    return predicted(search.pdf, search.detectors, simulation.vehicles.looks, simulation.steps).detection


def central(simulation: SearchSimulation, step: int) -> TargetPdf:
    """Return the pdf of a filter that gets everybody's looks at once, all of them silent."""
    search, pdf = simulation.case, simulation.case.pdf
    for k in range(1, step + 1):
        pdf = pdf.predict()
        for detector, looks in zip(search.detectors, simulation.vehicles.looks, strict=True):
            if k in looks:
                told = evidence_of_looks(detector, pdf.frame, looks[k], (None,) * len(looks[k]))
                pdf = pdf.observe(told.cells, told.log_likelihood)
    return pdf
