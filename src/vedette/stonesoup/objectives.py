"""What measurements of Gaussian tracks are worth: by entropy, or as Stone Soup's reward counts it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.problem import Objective

_ROUNDING = 1e-12  # of the largest variance: a smaller one may be 0


@dataclass(frozen=True, eq=False)
class StoneSoupTracks:
    """The predicted tracks' covariances: what both rewards depend on."""

    roots: NDArray[np.float64]  # (m, d, d), P = L L', in the units of the tracks' states
    norms: NDArray[np.float64]  # (m,), Frobenius norm of P

    @classmethod
    def of(cls, covariances: NDArray[np.float64], names: Sequence[str] = ()) -> StoneSoupTracks:
        """Return the belief with these covariances, (m, d, d); components may be known exactly.

        ``names`` of the tracks are for messages; without them they are numbered.

        Raises:
            InputError: another shape, or a covariance that is none.
        """
        shape = covariances.shape
        if len(shape) != 3 or shape[1] != shape[2]:
            raise InputError(f"tracks: covariances must have shape (tracks, d, d); got {shape}")
        roots = np.zeros(shape)
        for i, covariance in enumerate(covariances):
            root = _root(covariance)
            if root is None:
                name = names[i] if names else i
                raise InputError(f"tracks: the covariance of track {name} has a negative variance; mend it")
            roots[i] = root
        norms = np.linalg.norm(covariances, axis=(1, 2))
        return cls(roots, np.asarray(norms, dtype=np.float64))


class TrackReward(Objective[StoneSoupTracks, NDArray[np.float64]]):
    """``psi(I) = sum_t g(P_t, I_t)``, with ``*`` the sum of information matrices.

    Impact: ``H' R^-1 H`` of a sensor's measurement of every track, (m, d, d), zero where it has none in view.
    Source: paper, eqs. (23)-(28).
    """

    monotone = True

    @abstractmethod
    def gains(
        self, belief: StoneSoupTracks, tracks: NDArray[np.int64], information: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return ``g`` of N tracks, given by number, with ``information`` (N, d, d); 0 for none."""

    def nothing(self, belief: StoneSoupTracks) -> NDArray[np.float64]:
        """Return zeros: no track is measured."""
        return np.zeros_like(belief.roots)

    def combine(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``a + b``: information of independent measurements adds."""
        return a + b  # paper, eq. (27)

    def remove(self, total: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``total - own`` (paper, eq. (31) and its footnote 2)."""
        return total - own

    def value(self, belief: StoneSoupTracks, impact: NDArray[np.float64]) -> float:
        """Return the sum over the tracks."""
        return float(self.gains(belief, np.arange(len(belief.roots)), impact).sum())

    def values(
        self, belief: StoneSoupTracks, others: NDArray[np.float64], own: Sequence[NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        """Return the sum over the tracks with each own impact; only tracks in its view are computed anew."""
        if len(own) == 0:
            return np.empty(0)
        stacked = np.stack(own)
        k, t = np.nonzero(stacked.any(axis=(2, 3)))
        m = len(belief.roots)
        tracks = np.concatenate([np.arange(m), t])
        gains = self.gains(belief, tracks, np.concatenate([others, others[t] + stacked[k, t]]))
        base, after = gains[:m], gains[m:]
        more = np.bincount(k, weights=after - base[t], minlength=len(own))
        return np.asarray(base.sum() + more, dtype=np.float64)


class LogDetReward(TrackReward):
    """``g = 1/2 ln det(1 + L' I L)`` [nat]: the entropy that the measurements take off a track."""

    submodular = True

    def gains(
        self, belief: StoneSoupTracks, tracks: NDArray[np.int64], information: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the entropy removed from each track [nat]."""
        log_dets = np.linalg.slogdet(_whitened(belief.roots[tracks], information))[1]
        return np.asarray(0.5 * log_dets, dtype=np.float64)


class UncertaintyReward(TrackReward):
    """``g = |P|_F - |(P^-1 + I)^-1|_F``: Stone Soup's ``UncertaintyRewardFunction``, not submodular.

    It mixes the units of the state: with metres and metres per second, mostly the larger numbers count.
    """

    def gains(
        self, belief: StoneSoupTracks, tracks: NDArray[np.int64], information: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return by how much the norm of each track's covariance falls, in the covariance's units."""
        roots = belief.roots[tracks]
        after = roots @ np.linalg.solve(_whitened(roots, information), np.swapaxes(roots, 1, 2))
        return np.asarray(belief.norms[tracks] - np.linalg.norm(after, axis=(1, 2)), dtype=np.float64)


def _root(covariance: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return L with ``P = L L'`` for a P that may be singular; None if it is no covariance."""
    if not np.isfinite(covariance).all():
        return None
    variances, axes = np.linalg.eigh(covariance)
    if variances[0] > _ROUNDING * variances[-1]:
        return np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
    if variances[0] < -_ROUNDING * variances[-1]:
        return None
    return np.asarray(axes * np.sqrt(np.maximum(variances, 0.0)), dtype=np.float64)


def _whitened(roots: NDArray[np.float64], information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``1 + L' I L``, positive definite: the information in units of the prior."""
    whitened = np.swapaxes(roots, 1, 2) @ information @ roots
    return np.asarray(whitened + np.eye(roots.shape[-1]), dtype=np.float64)


REWARDS: dict[str, TrackReward] = {"logdet": LogDetReward(), "uncertainty": UncertaintyReward()}
