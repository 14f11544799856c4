"""How large the messages over a tree's links would be if nothing were left out of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.scale.post import ROOT
from bench.scale.team import Team
from vedette.negotiation import Tree

MIDDLE = 4  # links in the middle of the order that are coded


def whole_sizes(team: Team, tree: Tree, choice: Sequence[int | None]) -> tuple[float, int]:
    """Return the size of the impact over the median link, and over one that has most platforms behind it.

    In bytes, at this choice; a link counts once each way. Links are ordered by how many platforms are behind
    them, which over an area that grows with the team is nearly by size, and only those needed are coded.
    """
    parents = tree.parents(ROOT)
    below = _branches(parents)
    behind = sorted(
        [(len(below[i]), i, True) for i in range(tree.n) if parents[i] is not None]
        + [(tree.n - len(below[i]), i, False) for i in range(tree.n) if parents[i] is not None]
    )
    middle = max(0, len(behind) // 2 - MIDDLE // 2)

    def size(link: tuple[int, int, bool]) -> int:
        _, i, up = link
        inside = set(below[i])
        members = below[i] if up else [k for k in range(tree.n) if k not in inside]
        return len(team.codec.encode(_together(team, members, choice)))

    sizes = [size(link) for link in behind[middle : len(behind) - middle]]
    return float(np.median(sizes)), size(behind[-1])


def _branches(parents: Sequence[int | None]) -> list[list[int]]:
    """Return for each platform those of its branch, itself included."""
    below: list[list[int]] = [[] for _ in parents]
    for i in range(len(parents)):
        at: int | None = i
        while at is not None:
            below[at].append(i)
            at = parents[at]
    return below


def _together(team: Team, members: Sequence[int], choice: Sequence[int | None]) -> Any:
    """Return what these platforms achieve in sum, combined in pairs, for that is quick."""
    parts = []
    for i in members:
        k = choice[i]
        parts.append(team.objective.nothing(team.belief) if k is None else team.candidates[i][k])
    while len(parts) > 1:
        odd = parts[len(parts) // 2 * 2 :]
        parts = [team.objective.combine(a, b) for a, b in zip(parts[::2], parts[1::2], strict=False)] + odd
    return parts[0]
