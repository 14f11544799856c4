"""The tracks as predicted for the time of the actions: asked for once, shared by all sensors."""

from __future__ import annotations

import datetime
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stonesoup.types.groundtruth import GroundTruthState
from stonesoup.types.track import Track

from vedette.errors import InputError


@dataclass(frozen=True, eq=False)
class Forecast:
    """Mean and covariance of every track at one time, in an order that does not depend on a set's."""

    names: tuple[str, ...]  # the tracks' ids
    truths: tuple[Any, ...]  # GroundTruthState at the mean: what sensors are asked to measure
    means: NDArray[np.float64]  # (m, d)
    covariances: NDArray[np.float64]  # (m, d, d)
    timestamp: datetime.datetime


def forecast(tracks: Iterable[Any], predictor: Any, timestamp: datetime.datetime) -> Forecast:
    """Predict every track once.

    Raises:
        InputError: what is no track, a track without a Gaussian state or of a later time, or states of
            different size.
    """
    predicted = []
    for track in tracks:
        if not isinstance(track, Track):
            kind = type(track).__name__
            raise InputError(f"tracks hold a {kind}, which is no track; make it one: Track([state])")
        if len(track) == 0:
            raise InputError(f"track {track.id} is empty; leave it out")
        if not hasattr(track.state, "covar"):
            kind = type(track.state).__name__
            raise InputError(
                f"track {track.id} has a {kind}; give it a state with a covariance (GaussianState)"
            )
        if track.state.timestamp is not None and timestamp < track.state.timestamp:
            raise InputError(
                f"timestamp {timestamp} lies before track {track.id}, which is of {track.state.timestamp}; "
                "give the time at which the actions end"
            )
        state = predictor.predict(track.state, timestamp=timestamp)
        mean = np.asarray(state.mean, dtype=np.float64).ravel()
        predicted.append((tuple(mean), mean, np.asarray(state.covar, dtype=np.float64), track))
    if len({len(mean) for _, mean, _, _ in predicted}) > 1:
        raise InputError("tracks have states of different sizes; manage each size with its own manager")
    predicted.sort(key=lambda each: each[0])
    truths = tuple(
        GroundTruthState(mean.reshape(-1, 1), timestamp=timestamp, metadata=track.metadata)
        for _, mean, _, track in predicted
    )
    dim = len(predicted[0][1]) if predicted else 1
    means = np.array([mean for _, mean, _, _ in predicted]).reshape(-1, dim)
    covariances = np.array([covariance for _, _, covariance, _ in predicted]).reshape(-1, dim, dim)
    names = tuple(str(track.id) for _, _, _, track in predicted)
    return Forecast(names, truths, means, covariances, timestamp)
