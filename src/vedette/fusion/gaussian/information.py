"""Gaussian tracks in information form, and how they move: the algebra that all ways of fusing share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.fusion.digest import fingerprint

Floats = NDArray[np.float64]

LARGEST = 1e18  # entry that tracks may have: at a precision of 1 nm, or 10^9 km away
SMALLEST = 1e-18  # on the diagonal: known to 10^6 km
BELOW = 1e-9  # of its largest entry: a likelihood may have eigenvalues so far below zero, by rounding
MARGIN = 1e-13  # least eigenvalue of the correlations, far above what rounding takes from it


@dataclass(frozen=True, eq=False)
class Information:
    """``Y = P^-1`` and ``y = P^-1 x`` of T targets; a likelihood has the same form, positive semidefinite."""

    matrix: Floats  # (T, d, d) symmetric, Y or I = H' R^-1 H
    vector: Floats  # (T, d), y or i = H' R^-1 (z - h(x) + H x)

    def __post_init__(self) -> None:
        shape = self.matrix.shape
        if len(shape) != 3 or shape[1] != shape[2] or self.vector.shape != shape[:2]:
            raise InputError(
                f"information matrix has shape {shape} and vector {self.vector.shape}; "
                "they must be (T, d, d) and (T, d)"
            )
        if not (np.isfinite(self.matrix).all() and np.isfinite(self.vector).all()):
            raise InputError("information holds NaN or infinity")

    def __add__(self, other: Information) -> Information:
        return Information(self.matrix + other.matrix, self.vector + other.vector)

    def __sub__(self, other: Information) -> Information:
        return Information(self.matrix - other.matrix, self.vector - other.vector)

    @property
    def is_proper(self) -> bool:
        """Whether every matrix is positive definite, so that it has means and covariances."""
        try:
            np.linalg.cholesky(self.matrix)
        except np.linalg.LinAlgError:
            return False
        return True

    @property
    def is_sound(self) -> bool:
        """Whether rounding leaves them proper in all that follows: entries in range, no correlation near 1.

        ``SMALLEST <= Y_ii``, ``|Y_ij|, |y_i| <= LARGEST``; with ``Y_ij / sqrt(Y_ii Y_jj)`` no eigenvalue is
        below ``MARGIN``. What a robot sees for itself is far from these bounds; what it is told may be
        anything.
        """
        scale = np.diagonal(self.matrix, axis1=1, axis2=2)
        most = max(np.abs(self.matrix).max(initial=0.0), np.abs(self.vector).max(initial=0.0))
        if most > LARGEST or (scale < SMALLEST).any():
            return False
        shares = self.matrix / np.sqrt(scale[:, :, None] * scale[:, None, :])
        return Information(shares - MARGIN * np.eye(scale.shape[1]), self.vector).is_proper

    @classmethod
    def from_moments(cls, mean: Floats, covariance: Floats) -> Information:
        """Return the information of Gaussians with ``(T, d)`` means and ``(T, d, d)`` covariances.

        Raises InputError unless the covariances are positive definite.
        """
        checked_prior(cls(covariance, mean), "covariance")
        matrix = inverse(covariance)
        return cls(matrix, np.einsum("tij,tj->ti", matrix, mean))

    def moments(self) -> tuple[Floats, Floats]:
        """Return ``(T, d)`` means and ``(T, d, d)`` covariances; LinAlgError unless positive definite."""
        covariance = inverse(self.matrix)
        return np.einsum("tij,tj->ti", covariance, self.vector), covariance

    def print_of(self, step: int) -> int:
        """Return 64 bits that agree if two tracks at a step differ by rounding alone.

        Taken from correlations, logarithms of scales, and vectors in thousandths of their scale. A number
        may lie at the edge: tracks that differ by 1e-12 get different bits once in some 10^4 times.
        """
        scale = np.sqrt(np.diagonal(self.matrix, axis1=1, axis2=2))
        shares = self.matrix / (scale[:, :, None] * scale[:, None, :])
        rounded = [shares * 2.0**20, np.log2(scale) * 2.0**20, self.vector / scale * 2.0**10]
        data = b"".join((np.rint(part) + 0.0).tobytes() for part in rounded)
        return fingerprint(data, step)


@dataclass(frozen=True, eq=False)
class TrackMotion:
    """``x(k+1) = F x(k) + w``, ``w ~ N(0, Q)``, for every target; Q may be singular, F x F' + Q may not."""

    transition: Floats  # (T, d, d) F, for one step
    noise: Floats  # (T, d, d) Q, positive semidefinite

    def __post_init__(self) -> None:
        shape = self.transition.shape
        if len(shape) != 3 or shape[1] != shape[2] or self.noise.shape != shape:
            raise InputError(f"F has shape {shape} and Q {self.noise.shape}; both must be (T, d, d)")
        if not (np.isfinite(self.transition).all() and np.isfinite(self.noise).all()):
            raise InputError("F or Q holds NaN or infinity")
        least = np.linalg.eigvalsh(self.noise).min(initial=0.0)
        most = np.abs(self.noise).max(initial=0.0)
        if least < -1e-9 * most or not np.allclose(self.noise, self.noise.swapaxes(1, 2)):
            raise InputError(
                f"Q must be symmetric and positive semidefinite; its least eigenvalue is {least}"
            )
        spread = self.transition @ self.transition.swapaxes(1, 2) + self.noise
        checked_prior(Information(spread, np.zeros(shape[:2])), "F F' + Q")

    def predict(self, track: Information, steps: int = 1) -> Information:
        """Return ``Y' = (F Y^-1 F' + Q)^-1``, ``y' = Y' F Y^-1 y``, by way of moments: Q may be singular."""
        if steps == 0:
            return track
        mean, covariance = track.moments()
        for _ in range(steps):
            mean = np.einsum("tij,tj->ti", self.transition, mean)
            covariance = self.transition @ covariance @ self.transition.swapaxes(1, 2) + self.noise
        matrix = inverse(covariance)
        return Information(matrix, np.einsum("tij,tj->ti", matrix, mean))


def inverse(matrix: Floats) -> Floats:
    """Return the symmetric inverse of each positive definite matrix, by Cholesky; LinAlgError otherwise."""
    factor = np.linalg.inv(np.linalg.cholesky(matrix))
    result: Floats = factor.swapaxes(-1, -2) @ factor
    return result


def log_det(matrix: Floats) -> Floats:
    """Return the logarithm of the determinant of each positive definite matrix, by Cholesky."""
    diagonal = np.diagonal(np.linalg.cholesky(matrix), axis1=-2, axis2=-1)
    result: Floats = 2.0 * np.log(diagonal).sum(axis=-1)
    return result


def checked_prior(prior: Information, name: str = "prior information matrix") -> Information:
    """Return the tracks; InputError names the first target whose matrix is not positive definite."""
    for target, matrix in enumerate(prior.matrix):
        symmetric = np.abs(matrix - matrix.T).max() <= 1e-9 * np.abs(matrix).max()
        if not symmetric or np.linalg.eigvalsh(matrix)[0] <= 0.0:
            raise InputError(
                f"{name} of target {target} must be symmetric and positive definite; "
                "give every target a proper prior, however wide"
            )
    return prior


def checked_start(prior: Information) -> Information:
    """Return tracks to begin with; InputError unless they are proper, and sound to the last digit."""
    if not checked_prior(prior).is_sound:
        raise InputError(
            f"prior information is too near to certain or to nothing for its numbers: entries must lie in "
            f"{SMALLEST:g}..{LARGEST:g}, and correlations below 1 by {MARGIN:g}; choose another unit or prior"
        )
    return prior


def check_likelihood(likelihood: Information, prior: Information) -> None:
    """Raise InputError unless a likelihood fits the tracks: same shape, positive semidefinite."""
    if likelihood.matrix.shape != prior.matrix.shape:
        raise InputError(
            f"likelihood has shape {likelihood.matrix.shape}; the tracks have {prior.matrix.shape}"
        )
    least = np.linalg.eigvalsh(likelihood.matrix).min(initial=0.0)
    if least < -BELOW * np.abs(likelihood.matrix).max(initial=0.0):
        raise InputError(f"likelihood must be positive semidefinite; its least eigenvalue is {least}")
