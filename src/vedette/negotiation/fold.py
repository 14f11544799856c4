"""Many parts combined, any one of which can be replaced or left out at little cost."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic

from vedette.problem.objective import ImpactT


class Fold(Generic[ImpactT]):
    """``* of part_k``, and the same without one k, by O(log d) combinations for d parts.

    A binary tree: leaf ``d + k`` holds part k, every inner node what its two children make together, worked
    out when that is asked for. To leave a part out, combine the siblings of all nodes on its way to the top.
    """

    def __init__(self, size: int, combine: Callable[[ImpactT, ImpactT], ImpactT]) -> None:
        """Hold nothing in any of ``size`` places."""
        self._size = size
        self._combine = combine
        self._nodes: list[ImpactT | None] = [None] * (2 * size)
        self._stale = set[int]()  # inner nodes below which a part has been replaced

    def __getitem__(self, place: int) -> ImpactT | None:
        """Return the part in a place, ``None`` if there is none yet."""
        return self._nodes[self._size + place]

    def put(self, place: int, part: ImpactT) -> None:
        """Put a part in its place."""
        node = self._size + place
        self._nodes[node] = part
        while node > 1:
            node //= 2
            self._stale.add(node)

    @property
    def total(self) -> ImpactT | None:
        """All parts together, ``None`` if there is none."""
        return self._at(1) if self._size else None

    def without(self, place: int) -> ImpactT | None:
        """All parts but one together, ``None`` if there is none."""
        node, rest = self._size + place, None
        while node > 1:
            rest = self._together(rest, self._at(node ^ 1))
            node //= 2
        return rest

    def _at(self, node: int) -> ImpactT | None:
        """Return what a node's parts make together."""
        if node in self._stale:
            self._nodes[node] = self._together(self._at(2 * node), self._at(2 * node + 1))
            self._stale.remove(node)
        return self._nodes[node]

    def _together(self, a: ImpactT | None, b: ImpactT | None) -> ImpactT | None:
        if a is None or b is None:
            return b if a is None else a
        return self._combine(a, b)
