"""The simulated missions that several parts look at, each run once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from vedette.maps.world import World
from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.observer import ExploreReport
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office
from vedette.team import PlatformSpec

ROBOTS = 3  # as in the paper
PAPERS = "rate"  # the planner of eq. (42), section 5.1


@dataclass(frozen=True)
class Case:
    """A mission of three robots that start together in a generated office."""

    planner: str
    seed: int  # of the office, the starts and all chance
    width: float  # [m]
    height: float  # [m]


@dataclass(frozen=True, eq=False)
class ReproducedMission:
    """A case and how it went."""

    case: Case
    world: World
    report: ExploreReport


def specs() -> list[PlatformSpec]:
    """Return the team, named as the paper's Pioneers are (paper, Fig. 5)."""
    return [PlatformSpec(name=name) for name in ("Hornet", "Buzz", "Mozzy")]


@dataclass(eq=False)
class Missions:
    """Missions by case; a mission that was interrupted is not kept."""

    tell: Callable[[str], None]
    _done: dict[Case, ReproducedMission] = field(default_factory=dict)

    def get(self, case: Case) -> ReproducedMission:
        """Return the mission, run now unless it has been.

        Raises:
            KeyboardInterrupt: it was interrupted.
        """
        if case not in self._done:
            world = office(np.random.default_rng(case.seed), case.width, case.height)
            simulation = prepare(world, specs(), ExploreSetup(planner=case.planner, seed=case.seed))
            report = explore(simulation, [_Ticker(case, self.tell)])
            if report.summary.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            self._done[case] = ReproducedMission(case, world, report)
        return self._done[case]


@dataclass(eq=False)
class _Ticker:
    """Tells how far a mission is; ``vedette.record.explore.log.Sink``."""

    case: Case
    tell: Callable[[str], None]
    _next: float = 0.0  # [s] of simulated time

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Tell it every few simulated seconds."""
        if snapshot.t >= self._next:
            assert snapshot.coverage is not None, "the ground is known"
            self._next = snapshot.t + 5.0
            self.tell(
                f"mission with {self.case.planner}, seed {self.case.seed}: {snapshot.t:.0f} s, "
                f"{100 * snapshot.coverage:.0f} % covered"
            )
