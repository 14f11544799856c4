"""How a team searches, as its files and commands say it."""

from __future__ import annotations

from vedette.missions.flights import COORDINATIONS, FUSIONS, TeamOptions

__all__ = ["COORDINATIONS", "FUSIONS", "SearchOptions"]


class SearchOptions(TeamOptions, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team: one of COORDINATIONS, of SCHEMES, of FUSIONS."""
