"""How a team explores, as its files and commands say it."""

from __future__ import annotations

from msgspec import Struct

from vedette.domains.mapping.planners import DEFAULT, planner
from vedette.errors import InputError, check_word
from vedette.maps import GridFrame
from vedette.maps.area import Area
from vedette.maps.lattice import Lattice
from vedette.missions.pairs import scheme_of

FRAMES = ("known", "unknown")


class ExploreOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """The same for the whole team."""

    planner: str = DEFAULT  # a name of ``vedette.domains.mapping.planners``
    scheme: str | None = None  # of negotiation; None: the planner's own, or token
    fusion: str = "replicated"  # a name of ``vedette.missions.explore.assemble.FUSIONS``
    return_home: bool = False  # robots drive back to their starts in the end
    area: tuple[tuple[float, float], ...] | None = None  # corners, x, y [m]: all outside is nobody's ground
    unbounded: bool = False  # robots with a map of their world are not told how far it goes
    prior: str | None = None  # an old map of the building, a map's file
    frames: str = "known"  # or "unknown": each robot's frame is its own, and the team finds how they lie

    rendezvous: bool = False  # frames unknown: ground is worth more where another component may know it

    def check(self) -> None:
        """Raise InputError for what cannot go together."""
        check_word("frames", self.frames, FRAMES)
        if self.frames == "known":
            if self.rendezvous:
                raise InputError(
                    "rendezvous looks for robots of unknown frames; add frames unknown, or leave it out"
                )
            return
        if self.fusion != "replicated":
            raise InputError(
                f"frames unknown: fusion {self.fusion} cannot move what it has added up into another frame; "
                "leave it out"
            )
        if planner(self.planner).worlds > 1:
            what = f"planner {self.planner} predicts on a map that all have in one frame"
            raise InputError(f"frames unknown: {what}; choose another")
        if not planner(self.planner).negotiates:
            raise InputError(f"frames unknown: planner {self.planner} does not negotiate; choose another")
        if self.prior is not None:
            raise InputError("frames unknown: an old map lies in a frame that nobody has; leave it out")
        if self.area is not None or self.unbounded:
            what = "an area" if self.area is not None else "unbounded"
            raise InputError(f"frames unknown: {what} would be in a frame that nobody has; leave it out")

    @property
    def negotiates_by(self) -> str:
        """The scheme; InputError if it is not the one that is part of the planner."""
        return scheme_of(self.planner, self.scheme)

    def lattice(self, resolution: float, origin: tuple[float, float] = (0.0, 0.0)) -> Lattice:
        """Return the lattice of a team that knows of its ground no more than the area.

        Raises:
            InputError: the area is none, or too large.
        """
        return Lattice.open(resolution, origin, self._area)

    def lattice_on(self, frame: GridFrame) -> Lattice:
        """Return the lattice of a team on a map; InputError if the area is none, or too large."""
        if self.frames == "unknown":
            return self.lattice(frame.resolution)
        if self.unbounded:
            x = frame.origin_x + frame.cols // 2 * frame.resolution
            return self.lattice(frame.resolution, (x, frame.origin_y + frame.rows // 2 * frame.resolution))
        return Lattice(frame, self._area)

    @property
    def _area(self) -> Area | None:
        return None if self.area is None else Area.of(self.area)
