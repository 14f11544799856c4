"""When a team with false alarms says that it has found the target, and where."""

from __future__ import annotations

import numpy as np

from vedette.domains.search.belief import TargetPdf


def declared_place(pdf: TargetPdf, probability: float, radius: float) -> tuple[float, float] | None:
    """Return the most probable cell's middle [m] if the target is near it, sure enough; else None.

    Whoever declares by this rule is wrong with a probability of at most ``1 - probability``, for a pdf that
    is the posterior of what was seen: whenever it passes, so probably the target is within ``radius`` [m].
    """
    row, col = pdf.best_cell
    x, y = pdf.frame.centres(np.array([row * pdf.frame.cols + col]))[0].tolist()
    return (x, y) if pdf.probability_near(x, y, radius) >= probability else None
