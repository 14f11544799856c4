"""The team's totals, step by step, with a digest kept up and the earliest change noted."""

from __future__ import annotations

from typing import Generic, TypeVar

from vedette.fusion.digest import Digest
from vedette.fusion.steps.elements import Elements

E = TypeVar("E")


class Totals(Generic[E]):
    """A sum for each step; one step's total changes in O(its size), and so does the digest."""

    def __init__(self, elements: Elements[E]) -> None:
        self._elements = elements
        self._sums: dict[int, E] = {}
        self._digest = Digest()  # of the totals
        self._unprinted: set[int] = set()
        self._changed: int | None = None

    def total(self, step: int) -> E:
        """Return the team's evidence of a step, as this robot knows it."""
        return self._sums.get(step, self._elements.zero())

    def steps(self) -> list[int]:
        """Return the steps with evidence, increasing."""
        return sorted(self._sums)

    def add(self, step: int, element: E) -> None:
        """Add to a step's total."""
        self._sums[step] = self._elements.add(self.total(step), element)
        if not self._elements.is_zero(element):
            self._unprinted.add(step)
            self._changed = step if self._changed is None else min(step, self._changed)

    def forget(self, before: int) -> None:
        """Drop the totals of earlier steps."""
        self.seal(before)
        self._sums = {step: total for step, total in self._sums.items() if step >= before}

    def seal(self, before: int) -> None:
        """Leave earlier steps out of the digest."""
        self._digest.drop(before)
        self._unprinted = {step for step in self._unprinted if step >= before}

    def take_changed(self) -> int | None:
        """Return the earliest step whose total changed since last asked, or None."""
        changed, self._changed = self._changed, None
        return changed

    @property
    def digest(self) -> int:
        """64 bits that agree (up to 2^-64) iff the totals do."""
        for step in self._unprinted:
            total = self._sums[step]
            self._digest.put(step, b"" if self._elements.is_zero(total) else self._elements.encode(total))
        self._unprinted.clear()
        return self._digest.value
