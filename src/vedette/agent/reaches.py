"""What robots tell each other of where they can make a difference, so that messages leave out the rest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil, floor

from vedette.agent.messages import Area, Areas
from vedette.problem import Reach
from vedette.problem.reach import behind


def reaches_to_tell(
    own: Reach | None, heard: Mapping[int, Reach | None], neighbours: Iterable[int]
) -> dict[int, Areas | None]:
    """Return for each neighbour the reach of all on this side of the link, in whole metres.

    None is anywhere: somebody's who knows no bounds, so that nothing may be left out for that side.
    """
    unbounded = {k for k, reach in heard.items() if reach is None}
    bounded = {k: heard.get(k) or () for k in neighbours}
    return {
        k: None if own is None or unbounded - {k} else tuple(_outwards(box) for box in reach)
        for k, reach in behind(own or (), bounded).items()
    }


def _outwards(box: tuple[float, float, float, float]) -> Area:
    return floor(box[0]), floor(box[1]), ceil(box[2]), ceil(box[3])
