"""Exploration from Python: ``explore``, and ``Explore`` to step through it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias, Unpack

import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import NoGo, Priority
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.planners import DEFAULT
from vedette.domains.mapping.tour import Tour
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.maps.area import Area
from vedette.missions.explore.old_map import read_prior
from vedette.missions.pairs import tell_unheeded
from vedette.record.explore.log import ExploreLog, ExploreScene, ExploreSnapshot
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.explore.observer import ExploreReport
from vedette.record.explore.summary import ExploreSummary
from vedette.record.explore.views import union_map
from vedette.run.inputs import (
    ROBOTS,
    AnyTeam,
    AnyWorld,
    Conditions,
    files_of,
    links_of,
    order_file,
    setup_of,
    team_of,
    world_of,
)
from vedette.run.mission import Followers, ProgressSink, StepwiseMission
from vedette.run.result import MissionResult
from vedette.run.saved import read_saved_map
from vedette.sim.explore.run import ExploreRun, prepare, views
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.orders import OrderAt, check_frames, check_orders

_Mission: TypeAlias = StepwiseMission[ExploreSnapshot, Tour, Impact, ExploreReport]


@dataclass(frozen=True, kw_only=True, eq=False)
class ExploreResult(MissionResult[ExploreReport], ExploreSummary):
    """The figures of ``summary.json``, the map and the log."""

    @property
    def map(self) -> NDArray[np.uint8]:
        """``(R, C)`` what a living robot knows in the end: UNKNOWN, FREE or OCCUPIED; row 0 the lowest y."""
        return self.report.classes

    @property
    def frame(self) -> GridFrame:
        """Where the map lies."""
        return self.log.scene.frame

    @property
    def log(self) -> ExploreLog:
        """Curves, poses and maps over time."""
        return self.report.log

    def save(self, folder: Path | str, animate: bool = False) -> None:
        """Write the files of ``vedette explore`` into a folder, all but the run record."""
        from vedette.record.explore.outputs import write_outputs  # draws: takes a second to import

        with self._folder(folder) as made:
            write_outputs(self.report, made, animate)


class Explore(_Mission):
    """A team of robots that explores a building in simulation: every robot runs its own agent."""

    def __init__(
        self,
        world: AnyWorld = None,
        team: AnyTeam = ROBOTS,
        seed: int = 0,
        *,
        planner: str = DEFAULT,
        scheme: str | None = None,
        fusion: str = "replicated",
        max_time: float = 3600.0,
        return_home: bool = False,
        area: Sequence[Sequence[float]] | None = None,
        unbounded: bool = False,
        frames: str = "known",
        rendezvous: bool = False,
        saved: str | Path | None = None,
        prior: str | Path | None = None,
        record: str | Path | None = None,
        **conditions: Unpack[Conditions],
    ) -> None:
        """Put a team at its starts.

        Args:
            world: a World, a map file, ``(image file or solid cells (R, C), resolution [m])``; None: the
                seed's office of 30 x 20 m.
            team: so many robots alike, their platforms, or a team file.
            seed: of the office, the starts and all chance.
            planner, scheme, fusion: how the team decides, negotiates and shares what it sees.
            max_time: simulated time limit [s].
            return_home: whether the robots drive back to their starts in the end.
            area: corners x, y [m] of the ground that is the team's; None: all of the world.
            unbounded: whether the robots are not told how far their ground goes.
            frames: "unknown": each robot reckons in a frame of its own, and the team finds how these lie.
            rendezvous: frames unknown: ground is worth more where another component may know it.
            saved: folder of an earlier run, whose map the team starts from: its first robot has it.
            prior: an old map of the building, a map's file, which may be out of date or wrong.
            record: a folder for the run record, ``run.mcap``.
            conditions: see `vedette.run.inputs.Conditions`.

        Raises:
            InputError: something of it cannot be.
        """
        specs = team_of(team)
        setup = ExploreSetup(
            **vars(
                setup_of(len(specs), scheme=scheme, seed=seed, max_time=max_time, clocks=True, **conditions)
            ),
            planner=planner,
            fusion=fusion,
            return_home=return_home,
            area=None if area is None else Area.of(area).corners,
            unbounded=unbounded,
            frames=frames,
            rendezvous=rendezvous,
        )
        setup.options.check()
        if frames == "unknown" and (saved or prior) is not None:
            raise InputError("frames unknown: a saved map lies in a frame that nobody has; leave it out")
        tell_unheeded(setup.planner, len(specs), **links_of(setup))
        self.world = world_of(world, setup.seed)
        if saved is not None:
            setup = replace(setup, saved=read_saved_map(Path(saved), self.world.frame.resolution))
        if prior is not None:
            lattice = setup.options.lattice_on(self.world.frame)
            setup = replace(setup, prior=read_prior(Path(prior), lattice))
        orders = conditions.get("orders", ())
        check_orders(setup.orders, self.world, specs, order_file(orders))
        check_frames(setup.orders, frames, len(specs))
        simulation = prepare(self.world, specs, setup)
        files = files_of(world, team, conditions.get("faults"), orders, prior)
        self._begin(simulation, ExploreRun, record, files)

    def _begin(
        self,
        simulation: ExploreSimulation,
        kind: type[ExploreRun],
        record: str | Path | None,
        inputs: tuple[Path, ...],
    ) -> None:
        """Make the simulation one that a caller steps."""
        self.simulation = simulation
        self.scene = ExploreScene.of(self.world, [spec.name for spec in simulation.specs])
        followers = Followers[ExploreSnapshot]()
        super().__init__(
            simulation,
            kind(simulation, (followers,)),
            followers,
            lambda place: ExploreMcapWriter(place, self.scene),
            record,
            inputs,
        )

    @property
    def map(self) -> NDArray[np.uint8]:
        """``(R, C)`` what the living robots know together now: UNKNOWN, FREE or OCCUPIED."""
        return union_map(views(self.simulation), self.world.frame)

    def _check_order(self, given: OrderAt, known: Sequence[NoGo | Priority]) -> None:
        """Raise InputError for an order that makes no sense in this world."""
        check_orders([given], self.world, self.simulation.specs, "order", known)
        check_frames([given], self.simulation.setup.frames, len(self.simulation.specs))

    def run(self, progress: Callable[[ExploreSnapshot], object] | None = None) -> ExploreResult:
        """Explore to the end; ``progress`` is called with a snapshot every second."""
        self.play([] if progress is None else [ProgressSink(progress)])
        return self.result()

    def result(self) -> ExploreResult:
        """Return how it went; a mission that goes on is interrupted."""
        return ExploreResult.of(self.finish(), self.inputs)


def explore(
    world: AnyWorld = None,
    team: AnyTeam = ROBOTS,
    seed: int = 0,
    *,
    progress: Callable[[ExploreSnapshot], object] | None = None,
    **options: Any,
) -> ExploreResult:
    """Let a team explore a building to the end, as ``vedette explore`` does.

    Args:
        world, team, seed, options: see `Explore`.
        progress: called with a snapshot every second of the mission.

    Raises:
        InputError: something of it cannot be.
    """
    return Explore(world, team, seed, **options).run(progress)
