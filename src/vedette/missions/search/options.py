"""How a team searches, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

COORDINATIONS = ("none", "shared", "negotiated")
FUSIONS = ("replicated", "sums")


class SearchOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    coordination: str = "negotiated"  # of COORDINATIONS
    scheme: str = "token"  # of negotiation
    fusion: str = "replicated"  # of FUSIONS
