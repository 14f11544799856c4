"""The laws that an own domain must obey, checked on its own example: its first test."""

from __future__ import annotations

from typing import Any

import numpy as np

from vedette.missions.own.case import OwnCase
from vedette.missions.own.theory import Theory
from vedette.problem.alike import equal
from vedette.testing import LawBroken, check_objective
from vedette.vehicle import drive

LOOKS = 40


def check_theory(theory: type[Theory[Any, Any]], seed: int = 0) -> None:
    """Check a domain on its example: evidence adds up in any order, impacts keep the laws and travel.

    Raises:
        LawBroken: the first law that fails, with the example.
        InputError: a function raises, or returns what cannot be.
    """
    case, rng = OwnCase.of(theory.__name__, theory, None), np.random.default_rng(seed)
    total = _looked(case, rng)
    empty = case.theory.belief(np.zeros(case.theory.size, np.int64))
    for belief in (empty, case.theory.belief(total.copy())):
        own = _impacts(case, belief, rng)
        check_objective(case.theory.objective, belief, [*own, case.theory.objective.nothing(belief)])
        for k, impact in enumerate(own):
            if not equal(case.theory.codec.decode(case.theory.codec.encode(impact)), impact):
                raise LawBroken(f"codec: impacts[{k}] does not come through as it is")
        if not dict(case.theory.figures(belief, case.truth(seed))):
            raise LawBroken("figures: names nothing that tells how well the team does")


def _looked(case: OwnCase, rng: np.random.Generator) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Return what looks from random places add up to, added from the first on and from the last on."""
    theory, truth = case.theory, case.theory.truth(rng)
    x0, y0, x1, y1 = case.scenario.area
    total, told = np.zeros(theory.size, np.int64), []
    for look in range(LOOKS):
        pose = np.append(rng.uniform((x0, y0), (x1, y1)), rng.uniform(-np.pi, np.pi))
        i = look % len(case.scenario.vehicles)
        reading = theory.sense(truth, i, pose, rng)
        if reading is not None:
            places, numbers = theory.evidence(i, pose, reading)
            total[places] += numbers
            told.append((i, pose, reading))
    again = np.zeros(theory.size, np.int64)
    for i, pose, reading in reversed(told):
        places, numbers = theory.evidence(i, pose, reading)
        again[places] += numbers
    if not told:
        raise LawBroken(f"sense: tells nothing from {LOOKS} random places; is the range too short?")
    if not np.array_equal(total, again):
        raise LawBroken("evidence: says another thing of the same reading the second time")
    return total


def _impacts(case: OwnCase, belief: Any, rng: np.random.Generator) -> list[Any]:
    """Return what every vehicle would add on some courses, from its start and from elsewhere."""
    own: list[Any] = []
    x0, y0, x1, y1 = case.scenario.area
    for i, vehicle in enumerate(case.scenario.vehicles[:3]):
        elsewhere = np.append(rng.uniform((x0, y0), (x1, y1)), 0.0)
        for pose in (np.array(vehicle.pose), elsewhere):
            rates = rng.uniform(-vehicle.turn_rate, vehicle.turn_rate, (2, case.scenario.horizon))
            poses = drive(pose, rates, vehicle.speed, case.scenario.step)
            before = poses.copy()
            own += list(case.theory.impacts(belief, i, poses))
            if not np.array_equal(poses, before):
                raise LawBroken("impacts: changes the poses that it is given")
    return own
