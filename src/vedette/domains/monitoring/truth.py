"""The field as it truly is, step by step: of a file, of elevations that matplotlib ships, or generated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.scenario import FieldFile, Jacksboro, MonitorScenario, Plume, Topobathy
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.maps.raster import Extent, read_numbers
from vedette.number import many

Floats = NDArray[np.float64]

_SHIPPED = {  # file, array, and whether its first row is the northernmost
    Jacksboro: ("jacksboro_fault_dem.npz", "elevation", True),
    Topobathy: ("topobathy.npz", "topo", False),
}
_LEAST_COVERED = 0.5  # of a cell, by pixels that hold a number
_PUFFS = 12  # of a cloud
_MOST = 1e9  # that a number of a raster may be, as those of a scenario


@dataclass(eq=False)
class TrueField:
    """A field that is worked out as far as it is asked for; ``at(step)`` is the same whoever asks first."""

    first: Floats  # (R, C) at step 0 [unit]
    later: Callable[[Floats, int], Floats]  # of a step's field, and that step: the next one's
    _kept: list[Floats] = field(default_factory=list)

    def at(self, step: int) -> Floats:
        """Return the field (R, C) at a step."""
        self._kept = self._kept or [self.first]
        while len(self._kept) <= step:
            self._kept.append(self.later(self._kept[-1], len(self._kept) - 1))
        return self._kept[step]


def still(first: Floats) -> TrueField:
    """Return a field that stays as it is."""
    return TrueField(first, lambda present, step: present)


def drawn(model: FieldModel, dt: float, rng: np.random.Generator) -> TrueField:
    """Return a field drawn from the model, which changes as the model says in steps of dt [s]."""
    return TrueField(
        model.sample(rng), lambda present, step: model.later(present, step * dt, (step + 1) * dt, rng)
    )


def plume(frame: GridFrame, of: Plume, dt: float, rng: np.random.Generator) -> TrueField:
    """Return what the puffs of a cloud come to that the wind carries, in steps of dt [s]."""
    puffs = _Puffs(frame, of, dt, rng)
    return TrueField(puffs.sum(), lambda present, step: puffs.go_on().sum())


def read_field(scenario: MonitorScenario, folder: Path) -> Floats | None:
    """Return a field of numbers that are there already, (R, C); None: it is generated.

    Raises:
        InputError: a file that cannot be read, holds what is no number, or lies beside the area.
    """
    source, frame = scenario.field, scenario.frame
    if isinstance(source, FieldFile):
        path = folder / source.file
        raster = read_numbers(path, "field")
        return averaged(frame, raster.values, source.extent or raster.extent, f"field.file: {path}")
    if type(source) in _SHIPPED:
        name, array, north_first = _SHIPPED[type(source)]
        from matplotlib.cbook import get_sample_data  # ships the file; takes half a second to import

        with np.load(str(get_sample_data(name, asfileobj=False))) as data:
            numbers = np.asarray(data[array], np.float64)
        return averaged(frame, numbers[::-1] if north_first else numbers, None, name)
    return None


def averaged(frame: GridFrame, values: Floats, extent: Extent | None, what: str) -> Floats:
    """Return the mean of a raster's numbers over each cell, bottom row first; no extent: stretched.

    Raises:
        InputError: the raster does not cover the area, has no number somewhere in it, or a huge one.
    """
    x0, x1, y0, y1 = frame.extent
    left, low, right, high = extent or (x0, y0, x1, y1)
    slack = 1e-6 * frame.resolution
    if left > x0 + slack or right < x1 - slack or low > y0 + slack or high < y1 - slack:
        raise InputError(
            f"{what} lies at x {left:.10g} to {right:.10g} m, y {low:.10g} to {high:.10g} m and does not "
            f"cover the area's whole cells, x {x0:.10g} to {x1:.10g} m, y {y0:.10g} to {y1:.10g} m; take a "
            "smaller area"
        )
    rows = _shares(frame.rows, (y0 - low) / (high - low), (y1 - low) / (high - low), values.shape[0])
    cols = _shares(frame.cols, (x0 - left) / (right - left), (x1 - left) / (right - left), values.shape[1])
    there = np.isfinite(values)
    covered = rows @ there @ cols.T
    if (missing := int(np.count_nonzero(covered < _LEAST_COVERED))) > 0:
        raise InputError(f"{what} has no number in {many(missing, 'cell')} of the area; take a smaller one")
    if (largest := float(np.abs(values[there]).max())) > _MOST:
        raise InputError(
            f"{what} has numbers up to {largest:.3g}, at most {_MOST:g} make sense; give them in another "
            "unit, and say which stand for no data (GDAL_NODATA in a TIFF, nan in an array)"
        )
    return np.asarray(rows @ np.where(there, values, 0.0) @ cols.T / covered)


class _Puffs:
    def __init__(self, frame: GridFrame, of: Plume, dt: float, rng: np.random.Generator) -> None:
        """Put them about the source."""
        self.frame, self.of, self.dt, self.rng = frame, of, dt, rng
        self.places = np.array(of.source) + of.width * rng.normal(size=(_PUFFS, 2))  # (k, 2) [m]
        self.age = 0.0  # [s]

    def go_on(self) -> _Puffs:
        """Let a step pass: all drift alike, and each wanders."""
        wander = math.sqrt(2.0 * self.of.wander * self.dt) * self.rng.normal(size=self.places.shape)
        self.places = self.places + self.dt * np.array(self.of.wind) + wander
        self.age += self.dt
        return self

    def sum(self) -> Floats:
        """Return the concentration (R, C); a puff that spreads keeps its mass."""
        square = self.of.width**2 + 2.0 * self.of.spreading * self.age
        peak = self.of.strength * self.of.width**2 / square
        rows, cols = self.frame.shape
        x = self.frame.origin_x + (np.arange(cols) + 0.5) * self.frame.resolution
        y = self.frame.origin_y + (np.arange(rows) + 0.5) * self.frame.resolution
        across, along = (
            np.exp(-0.5 * (at[:, None] - places) ** 2 / square)
            for at, places in zip((x, y), self.places.T, strict=True)
        )
        return np.asarray(peak * along @ across.T)


def _shares(cells: int, start: float, end: float, pixels: int) -> Floats:
    """``(cells, pixels)`` weights of pixels in each cell's mean; cells go from start to end, as shares."""
    edges = np.linspace(start, end, cells + 1) * pixels
    first = np.arange(pixels)
    covered = np.minimum(edges[1:, None], first + 1) - np.maximum(edges[:-1, None], first)
    weights = np.maximum(covered, 0.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
