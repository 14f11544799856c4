"""How a team searches, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

from vedette.missions.pairs import SCHEME

COORDINATIONS = ("none", "shared", "negotiated")
FUSIONS = ("replicated", "sums")


class SearchOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    coordination: str = "negotiated"  # of COORDINATIONS
    scheme: str | None = None  # of negotiation; None: token
    fusion: str = "replicated"  # of FUSIONS

    @property
    def negotiates_by(self) -> str:
        """The scheme."""
        return self.scheme or SCHEME
