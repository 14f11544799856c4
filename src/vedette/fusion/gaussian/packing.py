"""Tracks as bytes (float64), and as vectors of whole numbers that add exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.fusion.gaussian.information import Information
from vedette.fusion.steps import FixedPoint, Sparse, SparseIntegers


@dataclass(frozen=True)
class Packing:
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
        """Return the tracks; ValueError unless they have the right size and are finite and proper."""
        if len(data) != 8 * self.size:
            raise ValueError(f"track payload: {len(data)} bytes of tracks; {8 * self.size} are expected")
        flat = np.frombuffer(data, dtype="<f8").astype(np.float64)
        if not np.isfinite(flat).all():
            raise ValueError("track payload: a number is not finite")
        tracks = self.tracks(flat)
        if not tracks.is_proper:
            raise ValueError("track payload: an information matrix is not positive definite")
        return tracks


class Likelihoods:
    """Likelihoods of a step as sparse integers: only what was seen is sent, and sums are exact.

    Matrix entries up to ``most_matrix``, vector entries up to ``most_vector``, each kept to 2^-50 of that.
    """

    def __init__(self, packing: Packing, most_matrix: float, most_vector: float) -> None:
        self._packing = packing
        self.elements = SparseIntegers(packing.size)
        vectors = packing.targets * packing.dimension
        largest = np.repeat([most_matrix, most_vector], [packing.size - vectors, vectors])
        self._scale = FixedPoint.holding(largest)

    def quantise(self, likelihood: Information) -> Sparse:
        """Return a robot's likelihood as an element; InputError if a number exceeds the largest stated."""
        whole = self._scale.quantise(self._packing.flat(likelihood))
        index = np.flatnonzero(whole)
        return self.elements.of(index, whole[index])

    def tracks(self, total: Sparse) -> Information:
        """Return the likelihood that a sum of elements stands for."""
        return self._packing.tracks(self._scale.numbers(self.elements.dense(total)))


def check_shape(packing: Packing, most_elements: int = 1 << 20) -> None:
    """Raise InputError for a team of tracks that is empty or absurdly large."""
    if packing.targets < 1 or packing.dimension < 1 or packing.size > most_elements:
        raise InputError(f"{packing.targets} targets of dimension {packing.dimension}; at least one of each")
