"""Fusing Gaussian tracks: one interface, four ways by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from vedette.errors import InputError, nearest_name
from vedette.fusion.gaussian.channel import GaussianChannel
from vedette.fusion.gaussian.information import Information, TrackMotion
from vedette.fusion.gaussian.intersection import IntersectionFusion, intersect
from vedette.fusion.gaussian.packing import Likelihoods, TrackPacking
from vedette.fusion.gaussian.refiltered import RefilteredTracks
from vedette.fusion.link import RESEND_AFTER
from vedette.fusion.seals import Notary
from vedette.fusion.steps import StepSums, replicated_steps

__all__ = [
    "WAYS",
    "GaussianChannel",
    "Information",
    "IntersectionFusion",
    "Likelihoods",
    "RefilteredTracks",
    "TrackFusion",
    "TrackMotion",
    "TrackPacking",
    "intersect",
    "track_fusion",
]

WAYS = ("replicated", "sums", "channel", "intersection")
WINDOW = 30  # [steps]


class TrackFusion(Protocol):
    """One robot's share in the team's tracks: no I/O and no clock; payloads go between neighbours.

    At each step a robot calls ``advance``, linearises its measurements about ``estimate``, calls ``observe``,
    then ``outgoing`` for each neighbour and ``receive`` for each payload that arrives.
    """

    @property
    def digest(self) -> int:
        """Equal for two robots that hold the same tracks (see each way for how nearly)."""
        ...

    def observe(self, step: int, likelihood: Information) -> None:
        """Take in this robot's likelihood of a step: ``(T, d, d)``, ``(T, d)``, zero where it saw nothing."""
        ...

    def advance(self, step: int) -> None:
        """Go on to a step."""
        ...

    def estimate(self) -> tuple[int, Information]:
        """Return the present step and the team's tracks, as this robot knows them."""
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


def track_fusion(
    way: str,
    robot: int,
    boot: int,
    prior: Information,
    motion: TrackMotion,
    start: int,
    *,
    most_matrix: float,
    most_vector: float,
    window: int = WINDOW,
    resend_after: float = RESEND_AFTER,
    notary: Notary | None = None,
) -> TrackFusion:
    """Return one of the ``WAYS`` of fusing tracks; InputError for another name.

    ``prior`` are the tracks at step ``start``, ahead of its evidence, and ``motion`` one step of theirs; both
    the same for every robot. ``boot < 2**38`` must differ from those of the robot's earlier starts.
    For "replicated" and "sums", likelihoods have entries up to ``most_matrix`` and ``most_vector``, and are
    kept to 2^-50 of these. For "sums", evidence later than ``window`` steps is lost. ``resend_after`` [s].
    ``notary`` signs what is "replicated"; sums and whole tracks of many robots nobody can sign.
    """
    if way == "channel":
        return GaussianChannel(robot, boot, prior, motion, start, resend_after=resend_after)
    if way == "intersection":
        return IntersectionFusion(robot, boot, prior, motion, start, resend_after=resend_after)
    likelihoods = Likelihoods(TrackPacking(*prior.vector.shape), most_matrix, most_vector)
    if way == "replicated":
        replicated = replicated_steps(robot, boot, likelihoods.elements, notary, resend_after)
        return RefilteredTracks(replicated, likelihoods, prior, motion, start)
    if way == "sums":
        sums = StepSums(robot, boot, likelihoods.elements, window=window, resend_after=resend_after)
        return RefilteredTracks(sums, likelihoods, prior, motion, start)
    raise InputError(f"unknown track fusion {way!r}: {nearest_name(way, WAYS)}")
