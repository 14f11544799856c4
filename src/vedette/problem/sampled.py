"""Objectives whose platforms may end up elsewhere: the mean over samples, or over outcomes."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_whole
from vedette.problem.objective import BeliefT, Codec, ImpactT, Objective
from vedette.problem.reach import Clippable, Reach

Float = NDArray[np.float64]


class Sampled(Objective[BeliefT, tuple[ImpactT, ...]]):
    """``psi(a) = 1/K sum_k psi(a_k)``, with ``*`` sample by sample: the mean over where platforms end up.

    An impact is K impacts of the objective beneath, one for each draw of the platform's own motion
    ``P(y_k | y_{k-1}, u)``, drawn independently of the others'. So the k-th of all together are a draw of
    where the team ends up. Messages are K times as long. It keeps what the objective beneath declares, and is
    for those in which an impact does not stand for its mean, as information: ``LogDet``.
    Source: docs/theory.md (V108).
    """

    def __init__(self, objective: Objective[BeliefT, ImpactT], samples: int) -> None:
        """Take the objective of a draw, and how many there are.

        Raises:
            InputError: no whole number of at least one sample.
        """
        if not is_whole(samples) or samples < 1:
            raise InputError(f"samples must be a whole number >= 1; got {brief(samples)}")
        self.monotone, self.submodular = objective.monotone, objective.submodular
        self._one, self._samples = objective, int(samples)

    def nothing(self, belief: BeliefT) -> tuple[ImpactT, ...]:
        """Return nothing in every sample."""
        return (self._one.nothing(belief),) * self._samples

    def combine(self, a: tuple[ImpactT, ...], b: tuple[ImpactT, ...]) -> tuple[ImpactT, ...]:
        """``a_k * b_k`` for every k."""
        return tuple(self._one.combine(*pair) for pair in zip(a, b, strict=True))

    def value(self, belief: BeliefT, impact: tuple[ImpactT, ...]) -> float:
        """Return the mean of the samples' values."""
        return float(np.mean([self._one.value(belief, each) for each in impact]))

    def price(self, impact: tuple[ImpactT, ...]) -> float:
        """Return the mean of the samples' prices."""
        return float(np.mean([self._one.price(each) for each in impact]))

    def values(
        self, belief: BeliefT, others: tuple[ImpactT, ...], own: Sequence[tuple[ImpactT, ...]]
    ) -> Float:
        """Return the mean over samples of ``value(others_k * own_ck)``, for every candidate c."""
        drawn = zip(others, *own, strict=True)
        return np.asarray(np.mean([self._one.values(belief, rest, each) for rest, *each in drawn], axis=0))

    def clip(self, belief: BeliefT, impact: tuple[ImpactT, ...], reach: Reach) -> tuple[ImpactT, ...]:
        """Return what can matter within a reach that holds all that may be seen from; (V14)."""
        if not isinstance(self._one, Clippable):
            return impact
        return tuple(self._one.clip(belief, each, reach) for each in impact)

    def wrong_belief(self, belief: BeliefT) -> str | None:
        """As the objective beneath."""
        return self._one.wrong_belief(belief)

    def wrong_impact(self, belief: BeliefT, own: Sequence[tuple[ImpactT, ...]]) -> tuple[int, str] | None:
        """An impact is a tuple of as many as there are samples."""
        for k, drawn in enumerate(own):
            if not isinstance(drawn, tuple) or len(drawn) != self._samples:
                return k, f"an impact must be a tuple of {self._samples} samples; got {brief(drawn)}"
            if (wrong := self._one.wrong_impact(belief, drawn)) is not None:
                return k, f"sample {wrong[0]}: {wrong[1]}"
        return None


class SampledCodec(Codec[tuple[ImpactT, ...]]):
    """Samples as bytes, one after the other: K times as many as one takes, and up to 6 each beside."""

    def __init__(self, codec: Codec[ImpactT], samples: int) -> None:
        """Take the codec of a sample, and how many there are."""
        self._codec, self._samples = codec, samples

    def encode(self, impact: tuple[ImpactT, ...]) -> bytes:
        """Return the samples' bytes as an array of MessagePack."""
        return msgspec.msgpack.encode([self._codec.encode(each) for each in impact])

    def decode(self, data: bytes) -> tuple[ImpactT, ...]:
        """Return the samples; ``ValueError`` if there are not so many, or one is malformed."""
        try:
            parts = msgspec.msgpack.decode(data, type=list[bytes])
        except msgspec.MsgspecError as error:
            raise ValueError(f"samples: {error}") from error
        if len(parts) != self._samples:
            raise ValueError(f"{len(parts)} samples; want {self._samples}")
        return tuple(self._codec.decode(part) for part in parts)


def mean_miss(outcomes: Sequence[tuple[float, Float]]) -> Float:
    """``E[m] = sum_y P(y) m_y``: the miss probabilities of a platform that may end up in several places.

    For ``Coverage`` that is exact, not an approximation: psi is linear in each platform's misses, and
    platforms end up where they do independently. Round after averaging, if at all. Source: docs/theory.md
    (V107).

    Args:
        outcomes: probability of each, and the misses from there; the probabilities sum to 1.

    Raises:
        InputError: probabilities that do not.
    """
    if abs(sum(chance for chance, _ in outcomes) - 1.0) > 1e-9 or any(chance < 0.0 for chance, _ in outcomes):
        raise InputError(f"outcomes: probabilities must sum to 1; got {[chance for chance, _ in outcomes]}")
    return np.asarray(sum(chance * miss for chance, miss in outcomes))
