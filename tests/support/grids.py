"""Grids kept by tiles, as plain arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.tiles import TiledGrid


def on_dense(
    kernel: Callable[..., NDArray[np.int64]], log_odds: NDArray[np.int8], *scan: Any
) -> NDArray[np.int64]:
    """Let a kernel that changes a tiled grid change an array, and return what it returns."""
    grid = TiledGrid.of(log_odds)
    returned = kernel(grid, *scan)
    log_odds[:] = grid.window()
    return returned
