"""Whether the grid of a search suits its sensors: what cannot be is refused, what may mislead is told."""

from __future__ import annotations

import warnings

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import COARSEST, Detector
from vedette.domains.search.prediction import too_coarse
from vedette.errors import InputError, InputWarning

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
