"""Sparse log-misses by cell and layer: the form in which impacts of looks are combined and priced."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STEPS_PER_NAT = 16.0
CERTAIN = 255  # log-misses saturate here

Keys = NDArray[np.uint32]
Misses = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class SparseMisses:
    """Log-misses that start in a layer; an absent entry is a miss probability of 1 (identity)."""

    keys: Keys  # (M,) strictly increasing, cell * layers + layer
    misses: Misses  # (M,) log-miss in steps of 1/16 nat, 1..255

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, SparseMisses)
            and np.array_equal(self.keys, other.keys)
            and np.array_equal(self.misses, other.misses)
        )

    def __hash__(self) -> int:
        return hash((self.keys.tobytes(), self.misses.tobytes()))

    @property
    def sparse(self) -> tuple[Keys, Misses]:
        """The two arrays, as the kernels take them."""
        return self.keys, self.misses
