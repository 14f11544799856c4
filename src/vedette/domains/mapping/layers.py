"""Time layers: what an observation is worth by when it is made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.kernels.coverage import LAYERS
from vedette.number import is_number

STEP = 5.0  # between the first EVEN edges [s]
EVEN = 20
RATIO = 1.16  # between later ones: 100 s ... 594 s


@dataclass(frozen=True, eq=False)
class TimeLayers:
    """``worth(t) = sum of weights[b] over layers b with edges[b] >= t``: a non-increasing step function.

    An observation that arrives in layer b counts in b and in every later layer, so a planning cell first
    seen in layer b contributes ``worth(edges[b])`` of its weight, however many see it later: variable
    horizons stay partially separable.  docs/mapping.md (V22)
    """

    edges: NDArray[np.float64]  # (LAYERS,) upper edge of each layer [s]; the last takes all later arrivals
    weights: NDArray[np.float64]  # (LAYERS,)

    def layer(self, arrival: float) -> int:
        """Return the layer of an arrival [s] after the round's t0: the first whose edge is not before it."""
        return min(int(np.searchsorted(self.edges, arrival)), LAYERS - 1)


def _edges() -> NDArray[np.float64]:
    even = STEP * np.arange(1, EVEN + 1)
    return np.concatenate((even, even[-1] * RATIO ** np.arange(1, LAYERS - EVEN + 1)))


def _layers(worth: NDArray[np.float64]) -> TimeLayers:
    return TimeLayers(_edges(), worth - np.append(worth[1:], 0.0))


def rate(start: float = 0.0) -> TimeLayers:
    """Worth ``1 / (start + t)``: the paper's rate of uncertainty reduction, eq. (42).  docs/mapping.md (V23)

    A ``start`` [s] keeps a trifle close by from outweighing a room a little farther on.

    Raises:
        InputError: it is no number >= 0.
    """
    if not (is_number(start) and start >= 0.0):
        raise InputError(f"layers.rate: start must be a number >= 0 s; got {brief(start)}")
    return _layers(1.0 / (start + _edges()))


def fading(within: float, rest: float) -> TimeLayers:
    """Worth ``exp(-t / within) + rest``: soon is better, and late far better than never.

    docs/mapping.md (V231)

    Raises:
        InputError: ``within`` [s] is no number > 0, or ``rest`` none >= 0.
    """
    for name, value, least in (("within", within, "> 0 s"), ("rest", rest, ">= 0")):
        if not (is_number(value) and (value > 0.0 or (value == 0.0 and name == "rest"))):
            raise InputError(f"layers.fading: {name} must be a number {least}; got {brief(value)}")
    edges = _edges()
    middles = (np.concatenate(([0.0], edges[:-1])) + edges) / 2.0
    return _layers(np.exp(-middles / within) + rest)


def plain() -> TimeLayers:
    """Worth 1 whenever it is made: the paper's expected posterior entropy, eq. (41)."""
    return _layers(np.ones(LAYERS))
