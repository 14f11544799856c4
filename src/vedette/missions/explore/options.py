"""How a team explores, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

from vedette.domains.mapping.planners import DEFAULT
from vedette.missions.pairs import scheme_of


class ExploreOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    planner: str = DEFAULT  # a name of ``vedette.domains.mapping.planners``
    scheme: str | None = None  # of negotiation; None: the planner's own, or token
    fusion: str = "replicated"  # a name of ``vedette.missions.explore.assemble.FUSIONS``
    return_home: bool = False  # robots drive back to their starts in the end

    @property
    def negotiates_by(self) -> str:
        """The scheme; InputError if it is not the one that is part of the planner."""
        return scheme_of(self.planner, self.scheme)
