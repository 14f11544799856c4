"""How a team searches, as its files and commands say it."""

from __future__ import annotations

from vedette.missions.flights import COORDINATIONS, FUSIONS, FlightOptions

__all__ = ["COORDINATIONS", "FUSIONS", "SearchOptions"]


class SearchOptions(FlightOptions, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team: one of COORDINATIONS, of SCHEMES, of FUSIONS."""
