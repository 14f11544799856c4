"""How a team tracks, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

from vedette.missions.pairs import SCHEME

COORDINATIONS = ("none", "shared", "negotiated", "optimum")


class TrackOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    coordination: str = "negotiated"  # of COORDINATIONS; the optimum is to be had in simulation alone
    scheme: str | None = None  # of negotiation; None: token
    fusion: str = "replicated"  # a name of ``vedette.fusion.gaussian.WAYS``
    objective: str | None = None  # None: the scenario's
    continuous: bool = False  # the best course is improved by the objective's gradient

    @property
    def negotiates_by(self) -> str:
        """The scheme."""
        return self.scheme or SCHEME
