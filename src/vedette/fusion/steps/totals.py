"""The team's totals, step by step, with a digest kept up and the earliest change noted."""

from __future__ import annotations

import hashlib
from typing import Generic, TypeVar

from vedette.fusion.steps.elements import Elements

E = TypeVar("E")


class Totals(Generic[E]):
    """A sum for each step; one step's total changes in O(its size), and so does the digest."""

    def __init__(self, elements: Elements[E]) -> None:
        self._elements = elements
        self._sums: dict[int, E] = {}
        self._prints: dict[int, int] = {}  # step -> fingerprint of its total
        self._unprinted: set[int] = set()
        self._digest = 0  # exclusive or of the fingerprints
        self._changed: int | None = None

    def __getitem__(self, step: int) -> E:
        return self._sums.get(step, self._elements.zero())

    def steps(self) -> list[int]:
        """Return the steps with evidence, increasing."""
        return sorted(self._sums)

    def add(self, step: int, element: E) -> None:
        """Add to a step's total."""
        self._sums[step] = self._elements.add(self[step], element)
        if not self._elements.is_zero(element):
            self._unprinted.add(step)
            self._changed = step if self._changed is None else min(step, self._changed)

    def forget(self, before: int) -> None:
        """Drop the totals of earlier steps."""
        self.seal(before)
        self._sums = {step: total for step, total in self._sums.items() if step >= before}

    def seal(self, before: int) -> None:
        """Leave earlier steps out of the digest."""
        for step in [step for step in self._prints if step < before]:
            self._digest ^= self._prints.pop(step)
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
            silent = self._elements.is_zero(total)
            fresh = 0 if silent else fingerprint(self._elements.encode(total), step)
            self._digest ^= self._prints.get(step, 0) ^ fresh
            self._prints[step] = fresh
        self._unprinted.clear()
        return self._digest


def fingerprint(data: bytes, step: int) -> int:
    """Return a 64-bit hash of some bytes and the step they belong to."""
    salt = step.to_bytes(8, "little")
    return int.from_bytes(hashlib.blake2b(data, digest_size=8, salt=salt).digest(), "little")
