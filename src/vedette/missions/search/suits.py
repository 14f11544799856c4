"""Whether grid and area of a search suit it: what cannot be is refused, what may mislead is told."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import COARSEST, Detector
from vedette.domains.search.prediction import too_coarse
from vedette.errors import InputError, InputWarning
from vedette.missions.search.scenario import SearchScenario

MOST_CELLS = 400_000


def check_cells(pdf: TargetPdf, detectors: tuple[Detector, ...], names: list[str]) -> None:
    """Say that cells are large for a sensor.

    Raises:
        InputError: so large that what it detects cannot be worked out either.
        InputWarning: more than half of its half width.
    """
    cell = pdf.frame.resolution
    if (i := too_coarse(pdf, detectors)) is not None:
        seen = detectors[i].half_width
        raise InputError(
            f"cell: {cell:g} m is {cell / seen:.3g} times what {names[i]} sees to a side, {seen:.3g} m, and "
            "over so large an area nobody can work out what it detects; take smaller cells and a smaller area"
        )
    least = min(range(len(detectors)), key=lambda i: detectors[i].half_width)
    seen = detectors[least].half_width
    if cell > seen / COARSEST * (1.0 + 1e-9):
        better = seen / COARSEST
        smaller = ", and a smaller area" if pdf.frame.size * (cell / better) ** 2 > MOST_CELLS else ""
        line = (
            f"cell: {cell:g} m is more than half of what {names[least]} sees to a side, {seen:.3g} m: "
            f"vehicles forget where in a cell they have looked; better take {better:.3g} m or less{smaller}"
        )
        warnings.warn(line, InputWarning, stacklevel=4)


def check_drift(places: Mapping[str, tuple[float, float]], scenario: SearchScenario) -> None:
    """Say which of these places [m] drifts to the area's border first, and what happens there.

    Raises:
        InputWarning: one does, before the search ends.
    """
    reached = {name: time_to_border(place, scenario) for name, place in places.items()}
    first = min(reached, key=reached.__getitem__)
    if reached[first] > scenario.duration:
        return
    if scenario.target.border == "hold":
        then = "the target is held there; take border: leave, or a larger area, if it may go on"
    else:
        then = "what leaves is not found again, and is shown as outside"
    line = f"target.drift: it takes {first} to the area's border after {reached[first]:.0f} s: {then}"
    warnings.warn(line, InputWarning, stacklevel=4)


def time_to_border(place: tuple[float, float], scenario: SearchScenario) -> float:
    """Return when a place [m] that drifts with the target is at the area's border [s]; inf: never."""
    x0, x1, y0, y1 = scenario.frame.extent
    times = [math.inf]
    for at, speed, low, high in zip(place, scenario.target.drift, (x0, y0), (x1, y1), strict=True):
        if speed != 0.0:
            times.append(((high if speed > 0.0 else low) - at) / speed)
    return min(times)
