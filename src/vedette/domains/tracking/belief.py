"""What a round of tracking is decided on: Gaussian tracks, and where they are expected to be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.models import STATE, TargetModel
from vedette.domains.tracking.tail import Tail
from vedette.errors import InputError
from vedette.kernels.tracking import ChainMotion
from vedette.number import many


@dataclass(frozen=True, eq=False)
class Tracks:
    """T independent Gaussian targets in information form, ``Y = P^-1`` and ``y = Y (x - o)``, at step k0.

    All platforms linearise about the common track that this predicts without measurements: so what a platform
    observes depends on its own controls alone, and the objective stays partially separable.

    Vectors are relative to an origin o nearby: with Y and x both large, y would leave x without digits. All
    motion is the same about any origin, ``F o = o``.

    Raises:
        InputError: no target, wrong shapes, a number that is not finite, an information matrix that is not
            symmetric and positive definite.
    """

    k0: int  # step of this estimate; its time is k0 * dt
    dt: float  # [s]
    horizon: int  # K: plans are for the steps k0 + 1 ... k0 + K
    models: tuple[TargetModel, ...]  # (T,)
    Y: NDArray[np.float64]  # (T, 4, 4)
    y: NDArray[np.float64]  # (T, 4)
    origin: tuple[float, float] = (0.0, 0.0)  # o, team frame [m]
    layers: tuple[float, ...] = ()  # ends of the tail's layers, after the horizon [s]
    weights: tuple[float, ...] = ()  # (T,) how many times as much knowing each is worth; none: once, all

    def __post_init__(self) -> None:
        count = len(self.models)
        if count == 0:
            raise InputError("tracks: there is no target; give at least one")
        if not (np.isfinite(self.dt) and self.dt > 0.0):
            raise InputError(f"tracks: dt must be > 0 s; got {self.dt}")
        if self.horizon < 1:
            raise InputError(f"tracks: the horizon must be at least 1 step; got {self.horizon}")
        for name, array, shape in (("Y", self.Y, (count, STATE, STATE)), ("y", self.y, (count, STATE))):
            if array.shape != shape:
                raise InputError(
                    f"tracks: {name} has shape {array.shape}; {many(count, 'target')} would have {shape}"
                )
            if not np.isfinite(array).all():
                raise InputError(f"tracks: {name} of target {_first(~np.isfinite(array))} is not finite")
        skew = np.abs(self.Y - self.Y.swapaxes(1, 2)) > 1e-9 * np.abs(self.Y).max(axis=(1, 2), keepdims=True)
        if skew.any():
            raise InputError(f"tracks: the information matrix of target {_first(skew)} is not symmetric")
        if not is_positive_definite(self.Y):
            t = next(t for t, information in enumerate(self.Y) if not is_positive_definite(information))
            raise InputError(
                f"tracks: the information matrix of target {t} is not positive definite; give it a prior"
            )

    def __len__(self) -> int:
        return len(self.models)

    @cached_property
    def covariances(self) -> NDArray[np.float64]:
        """(T, 4, 4) ``P = Y^-1``."""
        return inverses(self.Y)

    @cached_property
    def means(self) -> NDArray[np.float64]:
        """(T, 4) ``x = o + P y`` [m, m, m/s, m/s], team frame."""
        return np.asarray((self.covariances @ self.y[:, :, None])[:, :, 0] + self.shift)

    @property
    def shift(self) -> NDArray[np.float64]:
        """(4,) The origin as a state at rest."""
        return np.array([*self.origin, 0.0, 0.0])

    @cached_property
    def motion(self) -> ChainMotion:
        """The tracks as the kernels take them."""
        transitions = np.stack([model.F for model in self.models])
        return ChainMotion(self.covariances, transitions, np.stack([model.Q for model in self.models]))

    @cached_property
    def predicted_means(self) -> NDArray[np.float64]:
        """(K, T, 4) at the steps k0 + 1 ... k0 + K without measurements: the round's common track."""
        out = np.empty((self.horizon, len(self), STATE))
        means = self.means - self.shift
        for k in range(self.horizon):
            out[k] = means = (self.motion.transitions @ means[:, :, None])[:, :, 0]
        return out + self.shift

    @cached_property
    def predicted_covariances(self) -> NDArray[np.float64]:
        """(K, T, 4, 4) at the steps k0 + 1 ... k0 + K without measurements."""
        out = np.empty((self.horizon, len(self), STATE, STATE))
        covariances, (_, transitions, noises) = self.covariances, self.motion
        for k in range(self.horizon):
            out[k] = covariances = transitions @ covariances @ transitions.swapaxes(1, 2) + noises
        return out

    @property
    def blocks(self) -> int:
        """Blocks of an impact: a step or a layer each."""
        return self.horizon + len(self.layers)

    @cached_property
    def tail(self) -> Tail:
        """The targets after the horizon, without measurements."""
        ends = np.array((0.0, *self.layers))
        ahead = self.horizon + np.rint((ends[1:] + ends[:-1]) / (2.0 * self.dt)).astype(int)
        leaps = [_leap(self.motion, int(steps)) for steps in ahead]
        start = (self.means - self.shift)[:, :, None]
        means = np.array([(F @ start)[:, :, 0] for F, _ in leaps]).reshape(-1, len(self), STATE) + self.shift
        spreads = [(F @ self.covariances @ F.swapaxes(1, 2) + Q)[:, :2, :2] for F, Q in leaps]
        return Tail(self.layers, self.dt, means, np.array(spreads).reshape(-1, len(self), 2, 2))

    @cached_property
    def entropies(self) -> NDArray[np.float64]:
        """(T,) ``1/2 ln((2 pi e)^d det P)`` of the d components of each target [nat]; paper, eq. (22)."""
        own = [p[: m.d, : m.d] for p, m in zip(self.covariances, self.models, strict=True)]
        return 0.5 * np.array([len(p) * np.log(2 * np.pi * np.e) + np.linalg.slogdet(p)[1] for p in own])


def tracks(
    models: Sequence[TargetModel],
    means: Sequence[ArrayLike],
    covariances: Sequence[ArrayLike],
    *,
    dt: float,
    horizon: int,
    k0: int = 0,
    origin: tuple[float, float] = (0.0, 0.0),
    layers: tuple[float, ...] = (),
) -> Tracks:
    """Return tracks from means and covariances of the components that each target has.

    Args:
        models: of T targets.
        means: for each x, y (static) or x, y, vx, vy [m, m/s].
        covariances: for each (2, 2) or (4, 4).
        dt: step [s].
        horizon: steps to plan.
        k0: step of this estimate.
        origin: a place not far from the targets [m], to which numbers are kept relative.
        layers: ends of the tail's layers, after the horizon [s].

    Raises:
        InputError: lists of different lengths, wrong shapes, not finite, or a covariance that is not
            symmetric and positive definite; the line names the target.
    """
    if not len(models) == len(means) == len(covariances):
        raise InputError(
            f"tracks: {len(models)} models, {len(means)} means, {len(covariances)} covariances; give one each"
        )
    information = np.tile(np.eye(STATE), (len(models), 1, 1))
    state = np.zeros((len(models), STATE))
    for t, (model, mean, covariance) in enumerate(zip(models, means, covariances, strict=True)):
        x, p, d = np.asarray(mean, np.float64), np.asarray(covariance, np.float64), model.d
        if x.shape != (d,) or p.shape != (d, d):
            raise InputError(
                f"tracks: target {t} has a mean of shape {x.shape} and a covariance of shape {p.shape}; "
                f"its model needs ({d},) and ({d}, {d})"
            )
        if not (np.isfinite(x).all() and np.isfinite(p).all()):
            raise InputError(f"tracks: mean or covariance of target {t} is not finite")
        if not np.allclose(p, p.T, rtol=1e-9, atol=0.0) or not is_positive_definite(p):
            raise InputError(f"tracks: the covariance of target {t} is not symmetric and positive definite")
        information[t, :d, :d] = inverses(p[None])[0]
        state[t, :d] = x
        state[t, :2] -= origin
    y = (information @ state[:, :, None])[:, :, 0]
    return Tracks(k0, dt, horizon, tuple(models), information, y, origin, layers)


def _leap(motion: ChainMotion, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return F and Q (T, 4, 4) of so many steps at once, by doubling."""
    F, Q = np.broadcast_to(np.eye(STATE), motion.transitions.shape), np.zeros(motion.noises.shape)
    f, q = motion.transitions, motion.noises
    while steps:
        if steps % 2:
            F, Q = f @ F, f @ Q @ f.swapaxes(1, 2) + q
        f, q = f @ f, f @ q @ f.swapaxes(1, 2) + q
        steps //= 2
    return F, Q


def is_positive_definite(matrices: NDArray[np.float64]) -> bool:
    """Tell whether all symmetric matrices (..., d, d) have a Cholesky factor."""
    try:
        np.linalg.cholesky(matrices)
    except np.linalg.LinAlgError:
        return False
    return True


def inverses(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inverses of positive definite (..., d, d) by their Cholesky factors."""
    factors = np.linalg.cholesky(matrices)
    half = np.linalg.solve(factors, np.broadcast_to(np.eye(matrices.shape[-1]), matrices.shape))
    return np.asarray(half.swapaxes(-1, -2) @ half)


def _first(wrong: NDArray[np.bool_]) -> int:
    return int(np.argwhere(wrong)[0][0])
