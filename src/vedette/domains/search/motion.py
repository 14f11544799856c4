"""How a target moves: it stays, drifts, diffuses, or both."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.kernels.search import Stencil
from vedette.maps import GridFrame

WIDEST = 1000.0  # widest step that a stencil is made for [cells]
CUT = 3e-4  # probability of the farthest moves that a stencil leaves out


@dataclass(frozen=True)
class TargetMotion:
    """``x' = x + v dt + N(0, 2 D dt I)``; at the area's borders reflected, or gone; docs/search.md (V41).

    Raises:
        InputError: a number that is not finite, or a negative diffusion.
    """

    drift: tuple[float, float] = (0.0, 0.0)  # v [m/s], team frame
    diffusion: float = 0.0  # D [m^2/s]: the variance along each axis grows by 2 D a second
    leaves: bool = False  # whether a target that crosses the border is gone for good

    def __post_init__(self) -> None:
        if len(self.drift) != 2 or not all(map(math.isfinite, self.drift)):
            raise InputError(f"drift must be two finite speeds [m/s]; got {self.drift}")
        if not (math.isfinite(self.diffusion) and self.diffusion >= 0.0):
            raise InputError(f"diffusion must be a number >= 0 m^2/s; got {self.diffusion}")

    def stencil(self, resolution: float, dt: float) -> Stencil:
        """Return the step of ``dt`` [s] on cells of side ``resolution`` [m]."""
        variance = 2.0 * self.diffusion * dt / resolution**2
        first_row, row_taps = moves(self.drift[1] * dt / resolution, variance)
        first_col, col_taps = moves(self.drift[0] * dt / resolution, variance)
        return Stencil((first_row, first_col), row_taps, col_taps, self.leaves)

    def move(
        self, rng: np.random.Generator, places: NDArray[np.float64], frame: GridFrame, dt: float
    ) -> NDArray[np.float64]:
        """Move targets at ``places`` (n, 2) [m], team frame, by one step of ``dt`` [s].

        A target that has left stays where its last step took it.
        """
        sigma = math.sqrt(2.0 * self.diffusion * dt)
        moved = places + np.multiply(self.drift, dt) + sigma * rng.standard_normal(places.shape)
        if self.leaves:
            return np.asarray(np.where(frame.holds(places)[:, None], moved, places))
        corner = np.array([frame.origin_x, frame.origin_y])
        size = np.array([frame.cols, frame.rows]) * frame.resolution
        inside = (moved - corner) % (2.0 * size)
        return np.asarray(corner + np.minimum(inside, 2.0 * size - inside))


STILL = TargetMotion()


def moves(mean: float, variance: float) -> tuple[int, NDArray[np.float64]]:
    """Probabilities of whole moves along one axis with this mean and variance [cells, cells^2].

    A sub-cell mean is shared linearly between two cells, which alone has the variance ``f (1 - f)``, f its
    fraction; the rest comes from the kernel ``exp(-t) I_n(t)``, whose variance is t however small. So the
    variance is right wherever it is at least ``f (1 - f)``, and that otherwise.

    Returns:
        the smallest move and the probabilities of it and the following ones, of sum 1.

    Raises:
        InputError: the step is too wide for a stencil.
    """
    if abs(mean) > WIDEST or variance > WIDEST**2 / 16:
        raise InputError(
            f"the target moves {mean:.0f} cells and spreads {math.sqrt(variance):.0f} a step, at most "
            f"{WIDEST:.0f} and {WIDEST / 4:.0f}; take shorter steps or larger cells"
        )
    whole = math.floor(mean)
    fraction = mean - whole
    spread = _discrete_gaussian(max(0.0, variance - fraction * (1.0 - fraction)))
    shared = np.array([1.0 - fraction, fraction]) if fraction > 1e-12 else np.ones(1)
    taps = np.convolve(spread, shared)
    return whole - len(spread) // 2, taps / taps.sum()


def _discrete_gaussian(variance: float) -> NDArray[np.float64]:
    """``exp(-t) I_n(t)`` for n = -r..r, by its generating function ``exp(t (cos - 1))``."""
    size = 1 << math.ceil(math.log2(16.0 + 16.0 * math.sqrt(variance)))
    spectrum = np.exp(variance * (np.cos(2.0 * np.pi * np.arange(size // 2 + 1) / size) - 1.0))
    half = np.maximum(np.fft.irfft(spectrum, size)[: size // 2], 0.0)
    beyond = 1.0 - half[0] - 2.0 * np.cumsum(half[1:])  # probability outside -n..n, n = 1, 2, ...
    reach = 0 if 1.0 - half[0] <= CUT else 1 + int(np.argmax(beyond <= CUT))
    kernel = np.concatenate((half[reach:0:-1], half[: reach + 1]))
    return np.asarray(kernel / kernel.sum())
