"""The model's numbers from measurements: mean, deviation and length of greatest likelihood."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import LEAST_LENGTH, MOST_LENGTH, FieldModel
from vedette.domains.monitoring.spots import Spots
from vedette.errors import InputError

Floats = NDArray[np.float64]

LEAST_MEASUREMENTS = 10


def log_likelihood(
    model: FieldModel, spots: Spots, at: NDArray[np.int64], values: Floats, variances: Floats
) -> float:
    """``ln p(z)`` of measurements (m,) of one moment, by the sparse factor; docs/monitoring.md (V127)."""
    belief = FieldBelief.prior(model, spots).observe(at, values, variances)
    residual = values - model.mean
    right = belief.spots.weights.T @ belief.vector
    square = residual @ (residual / variances) - right @ belief.factor.solve(right)
    return -0.5 * float(square + np.log(2.0 * np.pi * variances).sum()) - belief.gained


def learned(
    model: FieldModel, spots: Spots, at: NDArray[np.int64], values: Floats, variances: Floats
) -> FieldModel:
    """Return the model with the mean of the values, and with the likeliest deviation and length.

    Lasting and drift stay as they are: one moment says nothing of them.

    Raises:
        InputError: fewer than 10 measurements, or all of the same value.
    """
    if len(values) < LEAST_MEASUREMENTS:
        raise InputError(
            f"{len(values)} measurements are too few to learn from; take {LEAST_MEASUREMENTS} or more, or "
            "state mean, deviation and length yourself"
        )
    mean, deviation = float(np.mean(values)), float(np.std(values))
    if not deviation > 0.0:
        raise InputError(f"all {len(values)} measurements are {mean:g}: state the field's deviation yourself")
    least = LEAST_LENGTH * model.frame.resolution
    most = model.frame.resolution * min(2.0 * math.hypot(*model.frame.shape), MOST_LENGTH)

    def at_logs(logs: Floats) -> FieldModel:
        found, length = np.exp(logs).tolist()
        return replace(model, mean=mean, deviation=found, length=min(max(length, least), most))

    limits = ((math.log(0.1 * deviation), math.log(10.0 * deviation)), (math.log(least), math.log(most)))
    start = np.log([deviation, min(max(model.length, least), most)])
    found = minimize(
        lambda logs: -log_likelihood(at_logs(logs), spots, at, values, variances),
        start,
        method="Nelder-Mead",
        bounds=limits,
        options={"xatol": 0.02, "fatol": 0.02, "maxfev": 120},
    )
    return at_logs(found.x)
