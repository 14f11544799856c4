"""Platforms outside any round: what each holds of the others, and news carried over links one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vedette.negotiation import Chooser, Tree
from vedette.negotiation.node import TreeLinks
from vedette.problem import Objective


@dataclass(frozen=True, eq=False)
class Member:
    """A platform: its chooser and its ends of the links."""

    seat: Chooser[Any, Any]
    links: TreeLinks[Any]


def members_of(
    objective: Objective[Any, Any],
    belief: Any,
    candidates: Sequence[Sequence[Any]],
    neighbours: Sequence[Sequence[int]],
    start: Sequence[int],
) -> list[Member]:
    """Return the members of a team that holds its first candidates, and has not told each other yet.

    Until it hears otherwise a platform takes the others to observe nothing. The neighbours need not make a
    tree.
    """
    members = []
    for own, near, first in zip(candidates, neighbours, start, strict=True):
        seat = Chooser(objective, belief, own, start=first)
        links = TreeLinks(seat, near)
        for k in near:
            links.receive(k, objective.nothing(belief))
        links.changed()
        members.append(Member(seat, links))
    return members


def team_on(
    tree: Tree,
    objective: Objective[Any, Any],
    belief: Any,
    candidates: Sequence[Sequence[Any]],
    start: Sequence[int],
) -> list[Member]:
    """Return the members of a team on a tree."""
    return members_of(objective, belief, candidates, [tree.neighbours(i) for i in range(tree.n)], start)


def tell(members: Sequence[Member], sender: int, receiver: int) -> bool:
    """Carry what a platform has to say over a link; return whether that was news."""
    mu = members[sender].links.outgoing(receiver)
    if mu is None:
        return False
    members[receiver].links.receive(sender, mu)
    return True


def sweep(members: Sequence[Member], tree: Tree) -> int:
    """Carry everybody's news inwards to platform 0 and outwards again; return the number of messages."""
    parents = tree.parents(0)
    outwards = list(dict.fromkeys(tree.tour(0)))  # each after its parent
    ways = [(i, parent) for i in reversed(outwards) if (parent := parents[i]) is not None]
    return sum(tell(members, *way) for way in (*ways, *((k, i) for i, k in reversed(ways))))
