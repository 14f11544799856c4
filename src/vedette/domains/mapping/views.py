"""From where one robot can look at which frontiers, the nearest first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.stops import LEFT_ALONE, Ground, nearest_view, seen_from
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
    last: bool = False,
    effort: int = 1,
) -> Viewpoints:
    """Find from where the nearest frontiers can be looked at: ``MOST_STOPS`` of them, times ``effort``.

    A frontier is looked at from the nearest place that sees its middle, however slantingly, or, if ``close``,
    from one within a metre; one by the places ``closer`` [m] from as near as the robot gets, and if this is
    the ``last`` try, from within a metre where there is nothing nearer.
    """
    bounds, away = (
        (belief.frontier_cells, belief.frontier_starts),
        seen_from(spec, belief.frame.resolution, close),
    )
    found = views_within(belief, ground, bounds, away, effort)
    return _from_nearer(belief, ground, spec, found, closer, last) if len(closer) else found


def views_within(
    belief: MapBelief, ground: Ground, frontiers: Frontiers, away: float, effort: int
) -> Viewpoints:
    """Find from where on the ground frontiers are seen from so near [m]."""
    resolution = belief.frame.resolution
    reach, most, work = max(2, round(away / resolution)), effort * MOST_STOPS, effort * MOST_WORK
    return coverage.viewpoints(
        ground.field, ground.source, resolution, belief.classes, *frontiers, reach, most, work
    )


def _from_nearer(
    belief: MapBelief,
    ground: Ground,
    spec: PlatformSpec,
    found: Viewpoints,
    places: Sequence[tuple[float, float]],
    last: bool,
) -> Viewpoints:
    """Return the viewpoints, those of frontiers by the places from nearer, if there are any."""
    starts, resolution = belief.frontier_starts, belief.frame.resolution
    targets, views = found.targets.copy(), found.views.copy()
    by = (np.hypot(*(belief.frame.centres(targets)[:, None] - places).T) < LEFT_ALONE).any(axis=0)
    for k in np.flatnonzero(by):
        cells = belief.frontier_cells[slice(*starts[found.clusters[k] :][:2])]
        views[k] = -1
        for away in (nearest_view(spec, resolution), *([seen_from(spec, resolution, close=True)] * last)):
            near = views_within(belief, ground, (cells, np.array([0, len(cells)])), away, 1)
            if len(near):
                targets[k], views[k] = near.targets[0], near.views[0]
                break
    return replace(found, targets=targets, views=views).only(views >= 0)


def by_way(found: Viewpoints, ground: Ground) -> list[Viewpoints]:
    """Split viewpoints into lots of ``MOST_STOPS``, those with the shortest way first; at least one lot."""
    order = np.argsort(ground.field.ravel()[found.views], kind="stable")
    lots = range(0, max(1, len(order)), MOST_STOPS)
    return [found.only(np.sort(order[k : k + MOST_STOPS])) for k in lots]
