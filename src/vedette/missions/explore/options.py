"""How a team explores, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

from vedette.domains.mapping.planners import DEFAULT, planner


class ExploreOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    planner: str = DEFAULT  # a name of ``vedette.domains.mapping.planners``
    scheme: str = "token"  # of negotiation
    fusion: str = "replicated"  # a name of ``vedette.missions.explore.assemble.FUSIONS``
    return_home: bool = False  # robots drive back to their starts in the end

    @property
    def negotiates_by(self) -> str:
        """The scheme, as the planner has it if it is part of the planner."""
        return planner(self.planner).scheme or self.scheme
