"""The model of a scenario: as it says, and what it does not say learned from a survey of some places."""

from __future__ import annotations

import math

import numpy as np

from vedette.domains.monitoring.field import LEAST_LENGTH, MOST_LENGTH, FieldModel
from vedette.domains.monitoring.learning import learned
from vedette.domains.monitoring.scenario import Age, Drawn, MonitorScenario
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.truth import Floats
from vedette.errors import InputError
from vedette.maps import GridFrame

_MOST = 900  # cells of the grid on which the model is learned
_DIGITS = 3  # that count of a learned number, so that all hosts learn the same


def model_of(scenario: MonitorScenario, truth: Floats | None) -> FieldModel:
    """Return the model; ``truth`` (R, C): the field at first, None: it is drawn from the model itself.

    Raises:
        InputError: a number out of its range, or nothing can be learned; the line names the field.
    """
    known, frame = scenario.model, scenario.frame
    plain = isinstance(scenario.field, Age | Drawn)
    mean, deviation, length = known.mean, known.deviation, known.length
    try:
        if plain or truth is None:
            mean, deviation = mean or 0.0, deviation or 1.0
            length = length or (2.0 if isinstance(scenario.field, Age) else 10.0) * frame.resolution
        elif mean is None or deviation is None or length is None:
            found = _learned(scenario, truth)
            mean = found.mean if mean is None else mean
            deviation, length = deviation or found.deviation, length or found.length
        return FieldModel(frame, mean, deviation, length, scenario.lasting, known.drift)
    except InputError as error:
        raise InputError(f"model: {str(error).removeprefix('field: ')}") from error


def _learned(scenario: MonitorScenario, truth: Floats) -> FieldModel:
    """Measure some places once, and take the likeliest numbers; on larger cells, where there are many."""
    frame, noise = scenario.frame, scenario.sensor.noise
    rng = np.random.default_rng(0)
    at = rng.choice(frame.size, min(scenario.model.survey, frame.size), replace=False)
    values = truth.ravel()[at] + noise * rng.normal(size=len(at))
    factor = math.ceil(math.sqrt(frame.size / _MOST))
    large: GridFrame = frame.coarse(factor)
    row, col = np.divmod(at, frame.cols)
    cells = (row // factor) * large.cols + col // factor
    start = FieldModel(
        large, length=max(LEAST_LENGTH * large.resolution, 0.2 * min(large.shape) * large.resolution)
    )
    found = learned(start, Spots(large), cells, values, np.full(len(at), noise**2))
    mean, deviation, length = (
        float(f"{number:.{_DIGITS}g}") for number in (found.mean, found.deviation, found.length)
    )
    least, most = LEAST_LENGTH * frame.resolution, MOST_LENGTH * frame.resolution
    return FieldModel(frame, mean, deviation, min(max(length, least), most))
