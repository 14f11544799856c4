"""Right of way in narrow places: who makes room for whom, and who goes first.

Robots that meet in the open pass each other by themselves (``vedette.kernels.motion.steer``). Where two
cannot pass side by side, one of them makes room: a standing robot for a moving one, the higher index for the
lower; but the other way round where the one that should has nowhere to go. Of robots that go the same way
the one nearer to the narrow place goes first, and those close behind wait until it is through. The longer
somebody is held up, the more room everybody near gives. Each robot works this out for itself from what all
beacon, twice a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from vedette.agent.intents import GAP, HORIZON, Intent, apart
from vedette.agent.narrows import Narrows
from vedette.agent.refuges import refuge, retreat

SLOWED = 2.0  # without progress for this long: not just about to pass [s]
SPREAD = 0.3  # further room for each second that somebody is held up beyond that [m/s]
MOST_SPREAD = 0.6  # [m]
CLOSE = 1.2  # centres nearer than this when slowed hinder each other, whatever the width [m]
JOINED = 0.15  # ways that come this near to each other lead through the same place [m]
QUEUE = 1.5  # so far before a narrow place robots let each other go first [m]
HEADWAY = 0.55  # a robot so far behind another does not hinder it [m]


def give_way(
    traversable: NDArray[np.bool_], resolution: float, me: Intent, others: Sequence[Intent]
) -> NDArray[np.float64] | None:
    """Return the path to a refuge if I must make room for a team-mate; None if not, or if there is no refuge.

    ``traversable`` ``(R, C)``: cells where my map allows my centre. ``me.path`` is where I want to go, even
    while I am making room. The path ``(L, 2)`` [m] starts where I am; a single point means: wait here.
    The mate has passed when a later call returns None.
    """
    narrows = Narrows(traversable, resolution)
    near = [mate for mate in others if len(mate.path) > 0 and me.away(mate) < 2.0 * HORIZON]
    near.sort(key=lambda mate: mate.rank)
    for mate, between in zip(near, apart(me.foreseen, [mate.foreseen for mate in near]), strict=True):
        if not _conflict(narrows, me, mate, between):
            continue
        bystanders = [other for other in others if other is not mate]
        further = _spread(me, mate)
        last = not _goes_before(narrows, mate, me)
        if last and (
            max(me.slowed, mate.slowed) < 2.0 * SLOWED
            or refuge(traversable, resolution, mate, me, bystanders, further) is not None
        ):
            continue
        path = refuge(traversable, resolution, me, mate, bystanders, further)
        if path is None and not last and mate.slowed >= SLOWED:
            path = retreat(traversable, resolution, me, mate.foreseen, others)
        if path is not None:
            return path
    return None


def queues(traversable: NDArray[np.bool_], resolution: float, me: Intent, others: Sequence[Intent]) -> bool:
    """Tell whether I must let a mate that goes the same way go before me through a narrow place."""
    narrows = Narrows(traversable, resolution)
    mine = narrows.way_to(me)
    if mine > QUEUE:
        return False
    for mate in others:
        if me.away(mate) > QUEUE + HEADWAY or len(mate.path) == 0:
            continue
        theirs = narrows.way_to(mate)
        before = 0.0 < theirs < inf and (theirs, mate.priority) < (mine, me.priority)
        if before and mine - theirs < HEADWAY and _same_narrow(narrows, me, mate):
            return True
    return False


def _same_narrow(narrows: Narrows, me: Intent, mate: Intent) -> bool:
    """Tell whether the mate comes through the same narrow place, the same way."""
    places, theirs = me.foreseen[narrows.on_the_way(me)], mate.foreseen
    through = (np.hypot(*(places[:, None] - theirs).T) < JOINED).any()
    return bool(through) and not _opposed(me.foreseen, theirs, JOINED)


def _goes_before(narrows: Narrows, a: Intent, b: Intent) -> bool:
    """Tell whether a goes before b: on the same way who is nearer to a narrow place, else by rank."""
    if len(a.path) and len(b.path) and not _opposed(a.foreseen, b.foreseen, a.radius + b.radius + GAP):
        to_a, to_b = narrows.way_to(a), narrows.way_to(b)
        if to_a != to_b:
            return to_a < to_b
    return a.rank < b.rank


def _conflict(narrows: Narrows, me: Intent, mate: Intent, between: NDArray[np.float64]) -> bool:
    """Tell whether we meet head-on, or I stand in the mate's way, where two cannot pass side by side.

    ``between`` ``(T,)``: how far we are apart, as foreseen [m].
    """
    limit = me.radius + mate.radius + GAP + _spread(me, mate)
    if between.min() >= limit:
        return False
    if max(me.slowed, mate.slowed) >= SLOWED and between[0] < CLOSE:
        return True
    if not _opposed(me.foreseen, mate.foreseen, limit):
        return False
    place = min(int(np.argmax(between < limit)), len(mate.foreseen) - 1)
    return narrows.width(mate.foreseen, place) < limit + narrows.resolution


def _spread(me: Intent, mate: Intent) -> float:
    """Further room [m] between two robots: the longer a jam lasts, the more it is drawn apart."""
    return min(SPREAD * max(me.slowed - SLOWED, mate.slowed - SLOWED, 0.0), MOST_SPREAD)


def _opposed(mine: NDArray[np.float64], theirs: NDArray[np.float64], limit: float) -> bool:
    """Tell whether, within ``limit``, our ways oppose each other; to stand in a mate's way counts too."""
    if len(mine) < 2:
        return len(theirs) > 1
    a, b = np.diff(mine, axis=0), np.diff(theirs, axis=0)
    near = np.hypot(*(mine[:-1, None] - theirs[None, :-1]).transpose(2, 0, 1)) < limit
    dot = a @ b.T
    scale = np.hypot(*a.T)[:, None] * np.hypot(*b.T)[None, :]
    return bool((near & (dot < -0.3 * scale)).any())
