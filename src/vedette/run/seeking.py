"""Looking for somebody in an unknown building, from Python: ``seek``, and ``Seek`` to step through it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

from vedette.missions.seek.options import SeekOptions
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.observer import ExploreReport
from vedette.record.seek.summary import SeekSummary
from vedette.run.exploring import Explore, ExploreResult
from vedette.run.inputs import (
    ROBOTS,
    AnyTeam,
    AnyWorld,
    Conditions,
    files_of,
    order_file,
    setup_of,
    team_of,
    world_of,
)
from vedette.run.mission import ProgressSink
from vedette.sim.orders import check_orders
from vedette.sim.seek.run import SeekRun, prepare
from vedette.sim.seek.simulation import SeekSetup


@dataclass(frozen=True, kw_only=True, eq=False)
class SeekResult(ExploreResult, SeekSummary):
    """The figures of ``summary.json``, the map and the log."""

    report: ExploreReport


class Seek(Explore):
    """A team of robots that looks for somebody in a building that it does not know, in simulation."""

    def __init__(
        self,
        world: AnyWorld = None,
        team: AnyTeam = ROBOTS,
        seed: int = 0,
        *,
        order: str = SeekOptions.order,
        reach: float = SeekOptions.reach,
        detection: float = SeekOptions.detection,
        scheme: str | None = None,
        max_time: float = 3600.0,
        record: str | Path | None = None,
        **conditions: Unpack[Conditions],
    ) -> None:
        """Put a team at its starts, and somebody in the building.

        Args:
            world, team, scheme, max_time, record, conditions: as for `Explore`.
            seed: also of where somebody is.
            order: ``map-first``, or whether the team maps and searches ``together``.
            reach: within which a robot may see somebody [m].
            detection: probability that it does, a look; there are two a second.

        Raises:
            InputError: something of it cannot be.
        """
        specs = team_of(team)
        common = setup_of(len(specs), scheme=scheme, seed=seed, max_time=max_time, clocks=True, **conditions)
        setup = SeekSetup(**vars(common), seek=SeekOptions(order, reach, detection))
        self.world = world_of(world, setup.seed)
        simulation = prepare(self.world, specs, setup)
        orders = conditions.get("orders", ())
        check_orders(common.orders, self.world, specs, order_file(orders))
        self._begin(simulation, SeekRun, record, files_of(world, team, conditions.get("faults"), orders))

    def run(self, progress: Callable[[ExploreSnapshot], object] | None = None) -> SeekResult:
        """Search to the end; ``progress`` is called with a snapshot every second."""
        self.play([] if progress is None else [ProgressSink(progress)])
        return self.result()

    def result(self) -> SeekResult:
        """Return how it went; a mission that goes on is interrupted."""
        return SeekResult.of(self.finish(), self.inputs)


def seek(
    world: AnyWorld = None,
    team: AnyTeam = ROBOTS,
    seed: int = 0,
    *,
    progress: Callable[[ExploreSnapshot], object] | None = None,
    **options: Any,
) -> SeekResult:
    """Let a team look for somebody in an unknown building, as ``vedette search --unknown-map`` does.

    Args:
        world, team, seed, options: see `Seek`.
        progress: called with a snapshot every second of the mission.

    Raises:
        InputError: something of it cannot be.
    """
    return Seek(world, team, seed, **options).run(progress)
