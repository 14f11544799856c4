"""Looking for each other: unknown ground is worth more where a guess says that another component knows it.

docs/align.md, section 6
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.fusion.frame_edges import FrameEdge
from vedette.fusion.link import Key
from vedette.kernels.coverage import CellWeights
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.layout import Box

MORE = 1.0  # of its worth that a cell gains where it is sure that another component knows it

Floats = NDArray[np.float64]


class Guess(NamedTuple):
    """How one component's ground may lie on another's."""

    ground: Box  # of the one component on the plane [m]
    there: Transform  # from where that lies on the plane to where it would lie on the other
    chance: float  # 0..1


def worth_more(belief: MapBelief, chances: Floats) -> MapBelief:
    """Return a plane's belief with each planning cell worth ``1 + MORE q`` times as much, (V211).

    ``chances``: ``(r, c)`` that another component knows the cell, q, over the belief's window.
    """
    window = belief.weights.window * (1.0 + MORE * chances).astype(np.float32)
    weights = belief.weights
    return replace(belief, weights=CellWeights(window, weights.first, weights.shape, weights.beyond))


def chances(belief: MapBelief, guesses: Iterable[Guess]) -> Floats:
    """Return ``(r, c)`` how likely each planning cell of the window is known in another component.

    Guesses are taken to be independent of each other.
    """
    known = belief.unknown < belief.factor**2  # partly
    missed = np.ones(known.shape)
    cells = np.flatnonzero(known)
    row, col = np.divmod(cells, known.shape[1])
    middles = belief.planning.centres((row + belief.first[0]) * belief.planning.cols + col + belief.first[1])
    for (left, low, right, high), there, chance in guesses:
        of = (middles >= (left, low)).all(axis=1) & (middles <= (right, high)).all(axis=1)
        x, y = there.places(middles[of]).T
        to_col = np.floor((x - belief.planning.origin_x) / belief.planning.resolution).astype(int)
        to_row = np.floor((y - belief.planning.origin_y) / belief.planning.resolution).astype(int)
        to_row, to_col = to_row - belief.first[0], to_col - belief.first[1]
        inside = (to_row >= 0) & (to_row < known.shape[0]) & (to_col >= 0) & (to_col < known.shape[1])
        reached = np.zeros(known.shape, np.bool_)
        reached[to_row[inside], to_col[inside]] = True
        missed[reached] *= 1.0 - chance
    return 1.0 - missed


def guessed(
    edges: Iterable[FrameEdge], plane: Mapping[Key, Transform], parts: Mapping[Key, Box]
) -> list[Guess]:
    """Return what guesses between components mean on the plane, each both ways.

    Args:
        edges: that anybody guesses.
        plane: T_plane_contributor.
        parts: the box on the plane of the component of each who is on it.
    """
    found = []
    for edge in edges:
        if edge.a in parts and edge.b in parts and parts[edge.a] != parts[edge.b]:
            for one in (edge, edge.inverse):  # what b's component knows, laid on a's
                there = plane[one.a].after(one.there).after(plane[one.b].inverse())
                found.append(Guess(parts[one.b], there, min(edge.weight, 100) / 100.0))
    return found
