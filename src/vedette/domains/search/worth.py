"""What a detection is worth by the layer in which it is made."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.parts import PartKind, telling

DELAYS = np.array([0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0])  # after the horizon [horizons], first in each layer


@dataclass(frozen=True, eq=False)
class Worth:
    """``w_k >= 0``, non-increasing in k: that makes the objective monotone and submodular.

    Layers beyond the horizon are what platforms promise to search afterwards, by how much later.
    """

    weights: NDArray[np.float64]  # (horizon,) or, with promises, (horizon + len(DELAYS),)
    horizon: int

    def __post_init__(self) -> None:
        weights = np.asarray(self.weights, np.float64)
        object.__setattr__(self, "weights", weights)
        if self.horizon < 1 or weights.shape not in (
            (self.horizon,),
            (self.horizon + len(DELAYS),),
        ):
            raise InputError(
                f"worth: {weights.shape} weights for a horizon of {self.horizon}; give one a step, "
                f"and none or {len(DELAYS)} more"
            )
        if not (np.isfinite(weights).all() and (weights >= 0.0).all() and (np.diff(weights) <= 0.0).all()):
            raise InputError(f"worth: weights must be >= 0 and never rise; got {weights.tolist()}")

    @property
    def promises(self) -> bool:
        """Whether there are layers for what is promised after the horizon."""
        return len(self.weights) > self.horizon


def plain(horizon: int, tail: float = 1.0) -> Worth:
    """``w_k = 1``: psi is the probability of detection by the horizon, and what is promised after it."""
    return _worth(np.ones(max(horizon, 0)), tail)


def discounted(horizon: int, gamma: float, tail: float = 1.0) -> Worth:
    """``w_k = gamma^k``: psi is ``E[gamma^k]`` of the step k of detection.

    Raises:
        InputError: gamma is not in (0, 1].
    """
    if not 0.0 < gamma <= 1.0:
        raise InputError(f"gamma must be more than 0 and at most 1; got {gamma}")
    return _worth(np.float64(gamma) ** np.arange(max(horizon, 0)), tail)


def endless(horizon: int, gamma: float, tail: float = 1.0) -> Worth:
    """``w_k = gamma^k`` for ever: as `discounted`, and what is promised counts by when it would be detected.

    A promise ``D`` horizons after the horizon is worth ``gamma^(K (1 + D))`` instead of a share of the last
    step's: so gamma alone says how far ahead the team looks. docs/search.md (V56)

    Raises:
        InputError: gamma is not in (0, 1), or nothing is promised.
    """
    if not 0.0 < gamma < 1.0:
        raise InputError(f"gamma must be more than 0 and less than 1 for an endless horizon; got {gamma}")
    if not (math.isfinite(tail) and 0.0 < tail <= 1.0):
        raise InputError(f"tail must be more than 0 and at most 1 for an endless horizon; got {tail}")
    ahead = np.concatenate((np.arange(max(horizon, 0)), horizon * (1.0 + DELAYS)))
    weights = np.power(gamma, ahead, dtype=np.float64)
    weights[max(horizon, 0) :] *= tail
    return Worth(weights, horizon)


def mean_time(horizon: int, tail: float = 1.0) -> Worth:
    """``w_k = 1 - k / K``: the largest psi has the least mean time to detection, cut at the horizon K.

    ``E[min(step of detection, K)] = K (1 - psi)`` with steps counted from 0.
    """
    return _worth(1.0 - np.arange(max(horizon, 0)) / max(horizon, 1), tail)


def _worth(weights: NDArray[np.float64], tail: float) -> Worth:
    """Add the promises' layers, the last step's weight times ``tail / (1 + DELAYS)``; none if tail is 0."""
    if not (math.isfinite(tail) and 0.0 <= tail <= 1.0):
        raise InputError(f"tail must be 0 to 1; got {tail}")
    if tail == 0.0 or len(weights) == 0:
        return Worth(weights, len(weights))
    return Worth(np.append(weights, tail * weights[-1] / (1.0 + DELAYS)), len(weights))


# From the horizon [steps], the worth of a step's delay, and that of what is promised after the horizon.
WorthOf: TypeAlias = Callable[[int, float, float], Worth]
WORTHS: dict[str, WorthOf] = {
    "plain": lambda horizon, gamma, tail: plain(horizon, tail),
    "discounted": discounted,
    "endless": endless,
    "mean-time": lambda horizon, gamma, tail: mean_time(horizon, tail),
}


def _wrong(part: Any) -> str | None:
    return None if callable(part) else f"is {type(part).__name__}, not a function that returns a Worth"


WORTH: PartKind[WorthOf] = PartKind("worths", "worth", WORTHS, _wrong, "docs/how-to/own-objective.md")


def worth_of(name: str, horizon: int, gamma: float, tail: float) -> Worth:
    """Return what detections are worth.

    Raises:
        InputError: there is no worth of this name, or it cannot be so.
    """
    make = WORTH.find(name)
    if name in WORTHS:
        return make(horizon, gamma, tail)
    with telling(f"worth {name}"):
        own = make(horizon, gamma, tail)
        if not isinstance(own, Worth) or own.horizon != horizon:
            raise TypeError(f"gives {type(own).__name__}; a Worth of {horizon} steps is asked for")
    return own
