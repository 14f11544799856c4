"""What a sensor tells about each track: ``H' R^-1 H`` by its own measurement model."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from stonesoup.models.base import Model
from stonesoup.types.array import StateVectors
from stonesoup.types.detection import TrueDetection
from stonesoup.types.state import State

from vedette.errors import InputError
from vedette.stonesoup.forecast import Forecast

MOST = 1e10  # variances of prediction over measurement


def measured(sensor: Any, forecast: Forecast) -> NDArray[np.float64]:
    """Return the information of the sensor as it stands about every track, (m, d, d).

    The sensor measures the predicted means without noise; tracks that it does not detect get zero, as in
    Stone Soup's reward. Several detections of a track add up.
    """
    which = {id(truth): t for t, truth in enumerate(forecast.truths)}
    seen: dict[int, tuple[Any, list[int]]] = {}  # by model: most sensors use one for all their detections
    for detection in sensor.measure(set(forecast.truths), noise=False):
        if isinstance(detection, TrueDetection):
            model = detection.measurement_model
            seen.setdefault(id(model), (model, []))[1].append(which[id(detection.groundtruth_path)])
    total = np.zeros_like(forecast.covariances)
    for model, tracks in seen.values():
        jacobians = linearised(model, forecast, tracks)[1]
        for t, jacobian in zip(tracks, jacobians, strict=True):
            if not np.isfinite(jacobian).all():
                raise InputError(
                    f"{type(sensor).__name__}: its measurement has no slope at the mean of track "
                    f"{forecast.names[t]}, which is on the sensor; leave the sensor or the track out"
                )
        total[tracks] += information(model, jacobians, forecast.covariances[tracks])
    return total


def information(
    model: Any, jacobians: NDArray[np.float64], covariances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return ``H' R^-1 H`` (paper, eq. (20)), (N, d, d), for ``H`` of shape (N, measured, d).

    A number measured `MOST` times as well as it is predicted, (N, d, d), counts as no better than that: a
    bearing's slope has no bound towards the sensor, and beside it nothing else would keep a digit.
    """
    noise = np.asarray(model.covar(), dtype=np.float64)
    try:
        rows = np.linalg.solve(np.linalg.cholesky(noise), jacobians)
    except np.linalg.LinAlgError as error:
        name = type(model).__name__
        raise InputError(f"{name}: noise_covar is singular; give every measured number some noise") from error
    ratios = np.einsum("nij,njk,nik->ni", rows, covariances, rows)
    rows = rows * np.sqrt(np.minimum(1.0, MOST / np.maximum(ratios, MOST)))[:, :, None]
    return np.asarray(np.swapaxes(rows, 1, 2) @ rows, dtype=np.float64)


def linearised(
    model: Any, forecast: Forecast, tracks: list[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return ``h``, (measured, N), and ``H = dh/dx``, (N, measured, d), at the means of N tracks.

    Models that keep Stone Soup's finite differences are asked once for all tracks; others track by track.
    """
    means = forecast.means[tracks].T
    if type(model).jacobian is not Model.jacobian:
        here = model.function(_state(means, forecast), noise=False)
        own = [model.jacobian(forecast.truths[t]) for t in tracks]
        return here.astype(np.float64), np.array(own, dtype=np.float64)
    dim, count = means.shape
    steps = difference_steps(means)
    columns = np.concatenate([means, *(means + steps * unit[:, None] for unit in np.eye(dim))], axis=1)
    values = np.asarray(model.function(_state(columns, forecast), noise=False))
    here, moved = values[:, :count], values[:, count:]
    change = (moved - np.tile(here, dim)).astype(np.float64).reshape(-1, dim, count)  # angles wrap themselves
    return here.astype(np.float64), np.transpose(change / steps, (2, 0, 1))


def difference_steps(means: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the steps of finite differences, as ``stonesoup.functions.jacobian`` takes them."""
    return np.maximum(1e8 * np.spacing(np.abs(means)), 1e-8)


def _state(columns: NDArray[np.float64], forecast: Forecast) -> Any:
    return State(columns.view(StateVectors), timestamp=forecast.timestamp)
