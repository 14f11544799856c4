"""Tracks as bytes (float64), and as vectors of whole numbers that add exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.fusion.gaussian.information import BELOW, Information
from vedette.fusion.steps import FixedPoint, Sparse, SparseIntegers

MOST_ROBOTS = 1024  # whose rounding errors add up in a sum


@dataclass(frozen=True)
class TrackPacking:
    """T targets of dimension d: upper triangles of the matrices, row by row, then the vectors."""

    targets: int
    dimension: int

    @property
    def size(self) -> int:
        """Numbers in all: ``T (d (d + 1) / 2 + d)``."""
        return self.targets * self.dimension * (self.dimension + 3) // 2

    def flat(self, tracks: Information) -> NDArray[np.float64]:
        """Return the ``(size,)`` numbers."""
        upper = np.triu_indices(self.dimension)
        return np.concatenate([tracks.matrix[:, upper[0], upper[1]].ravel(), tracks.vector.ravel()])

    def tracks(self, flat: NDArray[np.float64]) -> Information:
        """Return the tracks of which these are the numbers."""
        t, d = self.targets, self.dimension
        upper = np.triu_indices(d)
        split = t * len(upper[0])
        matrix = np.zeros((t, d, d))
        matrix[:, upper[0], upper[1]] = matrix[:, upper[1], upper[0]] = flat[:split].reshape(t, -1)
        return Information(matrix, flat[split:].reshape(t, d).copy())

    def encode(self, tracks: Information) -> bytes:
        """Return the tracks' bytes."""
        return self.flat(tracks).astype("<f8").tobytes()

    def decode(self, data: bytes) -> Information:
        """Return the tracks; ValueError unless they have the right size and are finite and sound."""
        if len(data) != 8 * self.size:
            raise ValueError(f"track payload: {len(data)} bytes of tracks; {8 * self.size} are expected")
        flat = np.frombuffer(data, dtype="<f8").astype(np.float64)
        if not np.isfinite(flat).all():
            raise ValueError("track payload: a number is not finite")
        tracks = self.tracks(flat)
        if not tracks.is_sound:
            raise ValueError("track payload: an information matrix is not positive definite, or out of range")
        return tracks


class LikelihoodElements(SparseIntegers):
    """Sparse integers of which payloads hold only such as stand for likelihoods, or for sums of some.

    Their matrices are positive semidefinite but for rounding: each robot's likelihood was rounded once, entry
    by entry, to a unit, and may have been below zero by ``BELOW`` before.
    """

    def __init__(self, packing: TrackPacking, scale: FixedPoint) -> None:
        super().__init__(packing.size)
        self._packing, self._scale = packing, scale
        self._row, self._col = np.triu_indices(packing.dimension)

    def decode(self, data: bytes) -> Sparse:
        """Return the element; ValueError if malformed, out of range, or below zero in some direction."""
        element = super().decode(data)
        if not self._is_semidefinite(element):
            raise ValueError("track evidence: a likelihood is not positive semidefinite")
        return element

    def _is_semidefinite(self, element: Sparse) -> bool:
        """Tell whether all matrices are, up to rounding; in units of matrix entries, which are all alike."""
        d, triangle = self._packing.dimension, len(self._row)
        number = int(np.searchsorted(element.index, self._packing.targets * triangle))
        target, entry = np.divmod(element.index[:number], triangle)
        value, row, col = element.value[:number].astype(np.float64), self._row[entry], self._col[entry]
        seen, place = np.unique(target, return_inverse=True)
        matrix = np.zeros((len(seen), d, d))
        matrix[place, row, col] = matrix[place, col, row] = value
        below = d * MOST_ROBOTS / 2 + BELOW * np.abs(value[row == col]).sum()
        matrix[:, range(d), range(d)] += below
        try:
            np.linalg.cholesky(matrix)
        except np.linalg.LinAlgError:
            return False
        return True

    def tracks(self, total: Sparse) -> Information:
        """Return the likelihood that a sum of elements stands for."""
        return self._packing.tracks(self._scale.numbers(self.dense(total)))


class Likelihoods:
    """Likelihoods of a step as sparse integers: only what was seen is sent, and sums are exact.

    Matrix entries up to ``most_matrix``, vector entries up to ``most_vector``, each kept to 2^-50 of that.
    """

    def __init__(self, packing: TrackPacking, most_matrix: float, most_vector: float) -> None:
        self._packing = packing
        vectors = packing.targets * packing.dimension
        largest = np.repeat([most_matrix, most_vector], [packing.size - vectors, vectors])
        self._scale = FixedPoint.holding(largest)
        self.elements = LikelihoodElements(packing, self._scale)

    def quantise(self, likelihood: Information) -> Sparse:
        """Return a robot's likelihood as an element; InputError if a number exceeds the largest stated."""
        whole = self._scale.quantise(self._packing.flat(likelihood))
        index = np.flatnonzero(whole)
        return self.elements.of(index, whole[index])

    def tracks(self, total: Sparse) -> Information:
        """Return the likelihood that a sum of elements stands for."""
        return self.elements.tracks(total)


def check_shape(packing: TrackPacking, most_elements: int = 1 << 20) -> None:
    """Raise InputError for a team of tracks that is empty or absurdly large."""
    if packing.targets < 1 or packing.dimension < 1 or packing.size > most_elements:
        raise InputError(f"{packing.targets} targets of dimension {packing.dimension}; at least one of each")
