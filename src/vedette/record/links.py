"""The team's links as they are seen from outside, and the parts that they leave it in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from vedette.overlay.status import LinkStatus, Status

_EDGES = ("parent", "child")


@dataclass(frozen=True)
class Link:
    """Two robots that hear each other."""

    a: int  # index in the team
    b: int  # index in the team, above a
    on_tree: bool  # an edge of the team's tree, by the word of both
    loss: float  # share of what is sent over it that is lost, 0..1; of the worse direction


def parts(alive: Sequence[bool], links: Iterable[Link] | None) -> tuple[tuple[int, ...], ...]:
    """Return the living robots in groups on one tree each, by their least robot; None: an ideal network."""
    living = [i for i, lives in enumerate(alive) if lives]
    if links is None:
        return (tuple(living),) if living else ()
    group = {i: {i} for i in living}
    for link in links:
        if link.on_tree and link.a in group and link.b in group:
            both = group[link.a] | group[link.b]
            group.update(dict.fromkeys(both, both))
    return tuple(tuple(sorted(group[i])) for i in living if i == min(group[i]))


def links_of(statuses: Sequence[Status | None]) -> tuple[Link, ...]:
    """Return the links that overlays report: those that are up at both ends.

    ``statuses`` by index in the team, which is the robot's number; None: dead, or never heard of.
    """
    told = {
        (i, link.robot): (status.place.epoch, link)
        for i, status in enumerate(statuses)
        if status is not None
        for link in status.links
        if link.role not in ("down", "left")
    }
    return tuple(_link(a, b, told[a, b], told[b, a]) for a, b in sorted(told) if a < b and (b, a) in told)


def _link(a: int, b: int, there: tuple[int, LinkStatus], back: tuple[int, LinkStatus]) -> Link:
    edge = there[1].role in _EDGES and back[1].role in _EDGES and there[0] == back[0]
    return Link(a, b, edge, max(there[1].loss, back[1].loss))
