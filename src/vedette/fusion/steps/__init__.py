"""Evidence that comes in time steps, shared exactly: one interface, two ways, and the filter on top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

from vedette.fusion.link import RESEND_AFTER
from vedette.fusion.seals import Notary
from vedette.fusion.steps.elements import Elements, FixedPoint, Sparse, SparseIntegers
from vedette.fusion.steps.refilter import Refilter
from vedette.fusion.steps.replicated import ReplicatedSteps
from vedette.fusion.steps.signed import SignedSteps
from vedette.fusion.steps.sums import StepSums

E = TypeVar("E")

__all__ = [
    "Elements",
    "FixedPoint",
    "Refilter",
    "ReplicatedSteps",
    "SignedSteps",
    "Sparse",
    "SparseIntegers",
    "StepEvidence",
    "StepSums",
    "replicated_steps",
]


class StepEvidence(Protocol[E]):
    """One robot's share in the team's step evidence: no I/O and no clock; payloads go between neighbours.

    A robot publishes what it saw at a step, then calls ``outgoing`` for each neighbour and ``receive`` for
    each payload that arrives; these may be lost, repeated or reordered. A new link opens with a greeting
    either way; evidence follows with the next ``outgoing``.
    """

    @property
    def digest(self) -> int:
        """Equal for two robots iff their totals are equal (of the steps that may still change)."""
        ...

    @property
    def open_from(self) -> int:
        """First step whose total may still change."""
        ...

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step; more than once a step is fine."""
        ...

    def total(self, step: int) -> E:
        """Return the team's evidence of a step, as this robot knows it."""
        ...

    def steps(self) -> list[int]:
        """Return the steps with evidence, increasing."""
        ...

    def take_changed(self) -> int | None:
        """Return the earliest step whose total changed since last asked, or None: refilter from there."""
        ...

    def forget(self, before: int) -> None:
        """Note that the caller needs no totals of earlier steps; those that are closed may be dropped."""
        ...

    def contributors(self) -> int:
        """Return the number of robots with evidence in the totals."""
        ...

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on."""
        ...

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return the next payload for a neighbour (KeyError if it is none), or None if there is no news."""
        ...

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a payload (ValueError if malformed, and nothing changes)."""
        ...


def replicated_steps(
    robot: int, boot: int, elements: Elements[E], notary: Notary | None, resend_after: float = RESEND_AFTER
) -> ReplicatedSteps[E] | SignedSteps[E]:
    """Return the way of sharing on any graph: signed, where there is a notary."""
    if notary is None:
        return ReplicatedSteps(robot, boot, elements, resend_after=resend_after)
    return SignedSteps(robot, boot, elements, notary=notary, resend_after=resend_after)
