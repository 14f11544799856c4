"""A domain of vehicles as one object: all that simulator, processes, Python and commands need to run it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from msgspec import Struct

from vedette.agent.mission import FlightMission
from vedette.missions.flights import DomainCaseT, FlightTeam, TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.outcome import Outcome
from vedette.record.display import Display
from vedette.record.flights import FlightObserver, FlightScene, FlightSnapshot
from vedette.record.folder import OutputFolder
from vedette.record.log import Sink, VehicleSample
from vedette.record.mcap import McapFile, Medium, Place
from vedette.record.summary import Setting
from vedette.sim.domains import DomainEntry
from vedette.sim.network import Spawn
from vedette.sim.vehicles import Vehicles

ContentT = TypeVar("ContentT", bound=Struct)
SceneT = TypeVar("SceneT", bound=FlightScene)
SnapshotT = TypeVar("SnapshotT", bound=FlightSnapshot)
ReportT = TypeVar("ReportT")


class Domain(ABC, Generic[DomainCaseT, ContentT, SceneT, SnapshotT, ReportT]):
    """All of a domain; ``vedette.sim.domains`` says where it is found.

    It has no state: everything belongs to a case, a team or a mission.
    """

    content: ClassVar[type[Any]]  # a ``msgspec.Struct``: what a vehicle tells of its mission
    leaves: ClassVar[Sequence[str]]  # names of the files that a mission leaves

    def __init__(self, declared: DomainEntry) -> None:
        """Take its name, and the ways of coordination that it knows."""
        self.name, self.coordinations = declared.name, declared.coordinations
        self.networked = [word for word in declared.coordinations if word not in declared.simulated]

    # -- a mission ----------------------------------------------------------------------------------

    @abstractmethod
    def case(self, scenario: Path | Mapping[str, Any] | None) -> DomainCaseT:
        """Return what a scenario comes to: of a file, of its fields, or the one that is built in.

        Raises:
            InputError: it cannot be used; the line names file and field.
        """

    @abstractmethod
    def team(self, case: DomainCaseT, options: TeamOptions, times: RoundTimes) -> FlightTeam[DomainCaseT]:
        """Return what all vehicles know beforehand, and how their agents are made.

        Raises:
            InputError: these options cannot be.
        """

    def spawn(self, team: FlightTeam[DomainCaseT]) -> Spawn:
        """Return who makes agents in the simulator, where an oracle may look into all of them at once.

        Raises:
            InputError: the oracle cannot do what the team's options ask for.
        """
        return team.assemble

    @abstractmethod
    def vehicles(self, case: DomainCaseT, seed: int, over: Callable[[float], Outcome | None]) -> Vehicles:
        """Return the vehicles at their starts, with what their sensors see of the truth.

        ``seed`` decides the truth and all chance, the same for everybody who simulates a part of it.
        """

    @abstractmethod
    def tell(self, mission: FlightMission[Any, Any, Any], step: int) -> ContentT:
        """Return what a vehicle tells of its mission as it stands at a step."""

    def check(self, content: ContentT, case: DomainCaseT) -> None:
        """Raise ValueError for what no vehicle of the case can tell; it comes from the network."""

    def known(self, content: ContentT, case: DomainCaseT) -> Any:
        """Return what is worked out of what a vehicle tells, for ``seen``; nothing."""
        return None

    @abstractmethod
    def seen(self, t: float, vehicles: Sequence[VehicleSample], known: Any) -> SnapshotT:
        """Return a mission at a time [s] as one sees it who does not know the truth."""

    # -- what it leaves -----------------------------------------------------------------------------

    @abstractmethod
    def scene(self, case: DomainCaseT) -> SceneT:
        """Return what stays the same all through a mission."""

    @abstractmethod
    def observer(
        self, team: FlightTeam[DomainCaseT], setting: Setting, sinks: Sequence[Sink[SnapshotT]]
    ) -> FlightObserver[ContentT, SnapshotT, ReportT]:
        """Return who measures a mission that has not begun, against the truth of its seed."""

    @abstractmethod
    def display(self, scene: SceneT, quiet: bool) -> Display[SnapshotT]:
        """Return the live view."""

    @abstractmethod
    def recorder(self, place: Place | Medium, scene: SceneT) -> McapFile[Any]:
        """Open the run record, or speak to a medium."""

    @abstractmethod
    def write(self, report: ReportT, folder: OutputFolder, animate: bool) -> None:
        """Write figures and pictures."""

    @abstractmethod
    def closing(self, summary: Any, folder: Path) -> list[str]:
        """Say in a few lines how it went."""

    def others(self, case: DomainCaseT, coordination: str) -> Sequence[str]:
        """Return the other ways of coordination that a mission is compared with."""
        return [name for name in self.coordinations if name != coordination]

    def compared(self, report: ReportT, others: Mapping[str, ReportT], outcome: Outcome) -> ReportT:
        """Return the report of a mission with those of other ways of coordination beside it."""
        return report
