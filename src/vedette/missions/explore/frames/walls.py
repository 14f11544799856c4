"""Walls that lie askew in the cells, drawn from several robots' maps: beside them is no ground to see."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.maps import OCCUPIED, UNKNOWN


def closed(classes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return ``(R, C)`` classes in which unknown cells beside an occupied one, or at its corner, are too."""
    walls = np.pad(classes == OCCUPIED, 1)
    across = walls[:, :-2] | walls[:, 1:-1] | walls[:, 2:]
    beside = across[:-2] | across[1:-1] | across[2:]
    return np.where((classes == UNKNOWN) & beside, np.uint8(OCCUPIED), classes)
