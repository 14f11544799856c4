"""From where one robot can look at which frontiers, the nearest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.stops import LEFT_ALONE, Ground, seen_from
from vedette.kernels import coverage
from vedette.kernels.coverage import Viewpoints
from vedette.team import PlatformSpec

MOST_STOPS = 40  # nearest first; the rest waits until none of them is any good
MOST_WORK = 500_000  # for these [pieces of lines]; a building takes 5000, one with holes in all walls 200 000
Frontiers = tuple[NDArray[np.int64], NDArray[np.int64]]  # as ``find_frontiers`` returns them


def look(
    belief: MapBelief,
    ground: Ground,
    spec: PlatformSpec,
    *,
    close: bool = False,
    closer: Sequence[tuple[float, float]] = (),
    effort: int = 1,
) -> Viewpoints:
    """Find from where the nearest frontiers can be looked at: ``MOST_STOPS`` of them, times ``effort``.

    A frontier is looked at from the nearest place that sees its middle, however slantingly, or, if ``close``
    or by one of the places ``closer`` [m], from one within a metre.
    """
    bounds = belief.frontier_cells, belief.frontier_starts
    found = _viewpoints(belief, ground, spec, bounds, close, effort)
    return found if close or not len(closer) else _from_close_by(belief, ground, spec, found, closer)


def _viewpoints(
    belief: MapBelief, ground: Ground, spec: PlatformSpec, frontiers: Frontiers, close: bool, effort: int
) -> Viewpoints:
    resolution = belief.frame.resolution
    reach = max(2, round(seen_from(spec, resolution, close) / resolution))
    most, work = effort * MOST_STOPS, effort * MOST_WORK
    return coverage.viewpoints(
        ground.field, ground.source, resolution, belief.classes, *frontiers, reach, most, work
    )


def _from_close_by(
    belief: MapBelief,
    ground: Ground,
    spec: PlatformSpec,
    found: Viewpoints,
    places: Sequence[tuple[float, float]],
) -> Viewpoints:
    """Return the viewpoints, those of frontiers by the places within a metre, if there are any."""
    middles, starts, views = belief.frame.centres(found.targets), belief.frontier_starts, found.views.copy()
    for k in np.flatnonzero((np.hypot(*(middles[:, None] - places).T) < LEFT_ALONE).any(axis=0)):
        cells = belief.frontier_cells[slice(*starts[found.clusters[k] :][:2])]
        near = _viewpoints(belief, ground, spec, (cells, np.array([0, len(cells)])), True, 1)
        views[k] = near.views[0] if len(near) else -1
    return replace(found, views=views).only(views >= 0)


def by_way(found: Viewpoints, ground: Ground) -> list[Viewpoints]:
    """Split viewpoints into lots of ``MOST_STOPS``, those with the shortest way first; at least one lot."""
    order = np.argsort(ground.field.ravel()[found.views], kind="stable")
    lots = range(0, max(1, len(order)), MOST_STOPS)
    return [found.only(np.sort(order[k : k + MOST_STOPS])) for k in lots]
