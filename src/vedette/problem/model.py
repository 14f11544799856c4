"""The general problem as it stands: any finite model, what it expects to know, the centralised optimum."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.number import many
from vedette.problem.arrays import misfit
from vedette.problem.door import check_choice, check_list
from vedette.problem.exhaustive import Exhaustive
from vedette.problem.interval import Between, bernstein

Float = NDArray[np.float64]

MOST_TERMS = 50_000_000  # of an exact sum over joint observations and states: seconds
MOST_CHOICES = 100_000  # joint actions of an optimum
_ROUNDING = 1e-9  # that sums of probabilities may be off


@dataclass(frozen=True, eq=False)
class FiniteModel:
    """``P(x_{k-1})``, ``P(x_k | x_{k-1})`` and, for each action of each platform, ``P(z | x_k, y(u))``.

    Nothing is assumed but what the paper's section 2 does: finite sets, and observations that are independent
    given the state. So everybody's models are needed in one place, and the sums are as long as the product
    of everybody's observations: that is what partially separable objectives are for. They are compared with
    this. Source: paper, eqs. (1)-(10); docs/theory.md (V101).

    Raises:
        InputError: shapes that do not fit, or columns that are no probabilities.
    """

    prior: Float  # (S,) P(x_{k-1})
    sensors: Sequence[Sequence[Float]]  # sensors[i][u]: (Z, S), row z of P(z | x_k, y_i(u)); columns sum to 1
    motion: Float | None = None  # (S, S), column x_{k-1} of P(x_k | x_{k-1}); None: the state stays

    def __post_init__(self) -> None:
        size = np.size(self.prior)
        _check_columns(self.prior, "prior", (size,))
        if self.motion is not None:
            _check_columns(self.motion, "motion", (size, size))
        check_list(self.sensors, "sensors", "each platform's list of likelihoods, one an action")
        if len(self.sensors) == 0:
            raise InputError("sensors is empty: a team needs at least one platform")
        for i, own in enumerate(self.sensors):
            check_list(own, f"sensors[{i}]", "a list of likelihoods, one an action")
            if len(own) == 0:
                raise InputError(f"sensors[{i}] is empty: give platform {i} at least one action")
            for u, likelihood in enumerate(own):
                rows = likelihood.shape[0] if getattr(likelihood, "ndim", 0) == 2 else 1
                _check_columns(likelihood, f"sensors[{i}][{u}]", (rows, size))

    @cached_property
    def predicted(self) -> Float:
        """``P(x_k)`` (S,) before anybody observes (paper, eq. (2))."""
        return self.prior if self.motion is None else np.asarray(self.motion @ self.prior)

    def posterior(self, choice: Sequence[int], seen: Sequence[int]) -> Float:
        """``P(x_k | z_k)`` (S,) of what each platform sees after its action (paper, eqs. (3)-(5)).

        Raises:
            InputError: not one index a platform, or what cannot be seen.
        """
        actions = check_choice(choice, self.sensors, "choice")
        likelihoods = [own[u] for own, u in zip(self.sensors, actions, strict=True)]
        observations = check_choice(seen, [range(len(own)) for own in likelihoods], "seen")
        joint = self.predicted.copy()
        for likelihood, z in zip(likelihoods, observations, strict=True):
            joint *= likelihood[z]
        if not (chance := joint.sum()) > 0.0:
            raise InputError(f"seen {observations} has probability 0 after choice {actions}")
        return np.asarray(joint / chance)

    def value(self, choice: Sequence[int]) -> float:
        """``H(x_k) - E_z H(x_k | z_k)`` [nat] of a joint action, exactly (paper, eqs. (6)-(9), in gain form).

        Raises:
            InputError: not one index a platform, or too many joint observations.
        """
        actions = check_choice(choice, self.sensors, "choice")
        likelihoods = [own[u] for own, u in zip(self.sensors, actions, strict=True)]
        terms = math.prod(map(len, likelihoods)) * len(self.prior)
        if terms > MOST_TERMS:
            raise InputError(f"value: {terms} terms, at most {MOST_TERMS}; use sampled_value")
        return self._entropy - expected_entropy(self.predicted, likelihoods)

    def optimum(self) -> Exhaustive:
        """Return the best of all joint actions, the first among equals (paper, eq. (10)).

        Raises:
            InputError: too many joint actions or observations.
        """
        values = [(self.value(choice), choice) for choice in self._choices()]
        value, choice = max(values, key=lambda each: each[0])
        return Exhaustive(choice, value)

    def sampled_value(
        self, choice: Sequence[int], rng: np.random.Generator, samples: int = 10_000, miss: float = 0.05
    ) -> Between:
        """Return ``value`` from drawn states and observations, in an interval that holds it but for ``miss``.

        The interval is that of an empirical Bernstein bound: it holds for any model and any number of
        samples, and is wider for that than one by the normal distribution.

        Raises:
            InputError: not one index a platform, or fewer than two samples.
        """
        actions = check_choice(choice, self.sensors, "choice")
        states = rng.choice(len(self.prior), size=samples, p=self.predicted / self.predicted.sum())
        joint = np.broadcast_to(self.predicted, (samples, len(self.prior)))
        for own, u in zip(self.sensors, actions, strict=True):
            until = np.cumsum(own[u], axis=0)[:, states]  # (Z, samples)
            drawn = (rng.uniform(size=samples) * until[-1] >= until).sum(axis=0)
            joint = joint * own[u][np.minimum(drawn, len(own[u]) - 1)]
        left = -_plogp(joint / joint.sum(axis=1, keepdims=True)).sum(axis=1)
        return bernstein(self._entropy - left, math.log(len(self.prior)), miss)

    def sampled_optimum(
        self, rng: np.random.Generator, samples: int = 10_000, miss: float = 0.05
    ) -> tuple[tuple[int, ...], Between]:
        """Return the joint action that looks best, and an interval that holds the optimum but for ``miss``.

        All joint actions' intervals hold at once but for ``miss``, so the largest of their ends do.

        Raises:
            InputError: too many joint actions, or fewer than two samples.
        """
        choices = list(self._choices())
        found = [self.sampled_value(choice, rng, samples, miss / len(choices)) for choice in choices]
        best = max(range(len(found)), key=lambda k: found[k].estimate)
        ends = max(each.low for each in found), max(each.high for each in found)
        return choices[best], Between(found[best].estimate, *ends)

    @cached_property
    def _entropy(self) -> float:
        return entropy(self.predicted)

    def _choices(self) -> Iterator[tuple[int, ...]]:
        count = math.prod(len(own) for own in self.sensors)
        if count > MOST_CHOICES:
            raise InputError(f"optimum: {many(count, 'joint action')}, at most {MOST_CHOICES}")
        return itertools.product(*(range(len(own)) for own in self.sensors))


def entropy(probability: Float) -> float:
    """``-sum p ln p`` [nat] (paper, eq. (1))."""
    return -float(_plogp(probability).sum())


def expected_entropy(predicted: Float, likelihoods: Sequence[Float]) -> float:
    """``E_z H(x | z)`` [nat] over all joint observations (paper, eq. (9)); no likelihood: the entropy."""
    joint = predicted[None]  # (observations so far, S)
    for likelihood in likelihoods:
        joint = (joint[:, None] * likelihood).reshape(-1, len(predicted))
    return float(_plogp(joint.sum(axis=1)).sum() - _plogp(joint).sum())


def among(outcomes: Sequence[tuple[float, Float]]) -> Float:
    """Return the likelihood of an action after which the platform may be in one of several places.

    It then knows where it is, so what it observes is the place as well: row (y, z) is
    ``P(y | y_{k-1}, u) P(z | x, y)``.

    Args:
        outcomes: probability of each place, and the likelihood (Z, S) there.
    """
    return np.concatenate([chance * likelihood for chance, likelihood in outcomes])


def _plogp(p: Float) -> Float:
    """``p ln p``, 0 at 0."""
    return np.asarray(p * np.log(np.where(p > 0.0, p, 1.0)))


def _check_columns(given: object, name: str, shape: tuple[int, ...]) -> None:
    """Raise ``InputError`` for what is no array of probabilities whose columns sum to 1."""
    if (wrong := misfit(given, "probabilities", shape, (0.0, 1.0), np.float64)) is not None:
        raise InputError(f"{name}: {wrong}")
    sums = np.atleast_1d(np.asarray(given).sum(axis=0))
    if sums.size == 0 or np.abs(sums - 1.0).max() > _ROUNDING:
        worst = float(sums[np.argmax(np.abs(sums - 1.0))]) if sums.size else 0.0
        raise InputError(f"{name}: probabilities must sum to 1 over what can happen; got {worst:.9g}")
