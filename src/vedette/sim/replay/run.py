"""Let a log go through one agent, or in shares through a team of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.domains.mapping.planners import DEFAULT
from vedette.domains.mapping.sightings import empty_counts
from vedette.errors import InputError
from vedette.logs import RecordedLog, Sight
from vedette.logs.recorded import way_of
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.bounds import Bounds, Extent
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.frames.matching import EVERY, SETTLED
from vedette.missions.explore.options import ExploreOptions
from vedette.number import many
from vedette.record.replay.summary import Replayed
from vedette.sim.explore.frames import FrameWatch
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.replay.field import RecordedRobots
from vedette.sim.replay.following import Following, FramedFollowing
from vedette.sim.replay.frames import laid_back, share_frames
from vedette.sim.simulation import Simulation
from vedette.sim.worlds.logged import frame_of
from vedette.team import Most, PlatformSpec

SETTLING = 15.0  # after its last scan a team has so long to tell each other of it [s]
LOOK_PERIOD = 1.0  # [s]


@dataclass(frozen=True)
class ReplaySetup:
    """How a log is replayed."""

    robots: int = 1  # shares into which it is cut, one after the other in time
    resolution: float = 0.1  # [m]
    reach: float = 20.0  # of the beams [m]
    no_return: str = "ignore"  # as for `logged`
    planner: str = DEFAULT
    scheme: str | None = None  # None: the planner's own
    fusion: str = "replicated"
    seed: int = 0  # of what befalls messages, and of frames
    link_loss: float = 0.0
    frames: str = "known"  # as in ``ExploreOptions``: unknown, each share lies in a frame of its own

    def shares(self, log: RecordedLog) -> list[tuple[Sight, ...]]:
        """Cut a log into as many pieces of as many scans, or maps.

        Raises:
            InputError: it has too few.
        """
        sights, what = log.sights, "map" if log.maps else "scan"
        if len(sights) < (self.robots if log.maps else 2 * self.robots):
            raise InputError(
                f"{log.name} has {many(len(sights), what)}, too few for {many(self.robots, 'robot')}"
            )
        ends = np.linspace(0, len(sights), self.robots + 1).round().astype(int).tolist()
        return [sights[a:b] for a, b in pairwise(ends)]


class Replay:
    """A log on its way through a team of agents."""

    def __init__(self, log: RecordedLog, setup: ReplaySetup) -> None:
        """Prepare to replay a log.

        Raises:
            InputError: it cannot be cut so, or covers too much; planner, scheme or fusion are unknown, or
                maps cannot be fused so, or not in unknown frames.
        """
        self.log, self.setup = log, setup
        if log.maps:
            _check_maps(log, setup)
        self.specs = [_spec(log, setup.reach, number) for number in range(1, setup.robots + 1)]
        self._options = ExploreOptions(setup.planner, setup.scheme, setup.fusion, frames=setup.frames)
        self._options.check()
        _ = self._options.negotiates_by
        self._frame = frame_of(log, setup.resolution, setup.reach)
        known, shares = setup.frames == "known", setup.shares(log)
        self.lattice = self._options.lattice(setup.resolution, _middle(self._frame) if known else (0.0, 0.0))
        ground = setup.reach, setup.seed, self.lattice.frame
        self.frames = None if known else share_frames(log, shares, *ground)
        self.robots = RecordedRobots(shares, setup.reach, setup.no_return, self.frames)
        links = ExploreSetup(seed=setup.seed, link_loss=setup.link_loss, scheme=setup.scheme)
        self.simulation = Simulation(self._agent, self.robots, links)
        self._watch: FrameWatch | None = None
        if self.frames is not None:
            self._watch = FrameWatch(self.simulation, [spec.name for spec in self.specs], self.frames)
        self._stopped = False

    def _agent(self, robot: int, boot: int) -> Agent:
        spec, most = self.specs[robot], Most.of(self.specs)
        return assemble(
            self.lattice, spec, self._options, robot, boot,
            robots=len(self.specs), most=most,
            explorer=Following if self.frames is None else FramedFollowing,
        )  # fmt: skip

    @property
    def missions(self) -> list[Following]:
        """Everybody's share of the mission."""
        found = [agent.mission for agent in self.simulation.agents]
        assert all(isinstance(mission, Following) for mission in found)
        return found  # type: ignore[return-value]

    def stop(self) -> None:
        """End the replay at the end of the present tick; may be called from a signal handler."""
        self._stopped = True

    def run(self, told: Callable[[float], None] = lambda share: None) -> Replayed:
        """Replay to the end, or until stopped; ``told`` hears, now and then, which share of it is done."""
        simulation, end = self.simulation, self.robots.duration + self._settling
        times, known, due = [0.0], [0.0], 0.0
        while simulation.now < end and not self._stopped:
            simulation.step()
            if simulation.now >= due:
                due += LOOK_PERIOD
                times.append(simulation.now)
                known.append(self._known())
                if self._watch is not None:
                    self._watch.look()
                told(min(simulation.now / end, 1.0))
        return self._replayed(times, known)

    @property
    def _settling(self) -> float:
        """How long a team goes on after the last scan [s]: until maps that stand still are judged."""
        if self.frames is None:
            return SETTLING
        return SETTLING + SETTLED[0] + 2.0 * EVERY * len(self.specs)

    def _known(self) -> float:
        """Area that the robot knows that knows most [m^2]."""
        most = max(np.count_nonzero(mission.fusion.classes.blocks != UNKNOWN) for mission in self.missions)
        return float(most) * self.setup.resolution**2

    def _extent(self, mission: Following) -> Extent:
        """Return the rows and columns of the lattice where the log lies, and where a robot knows anything."""
        bounds, frame = Bounds(), self._frame
        row, col = self.lattice.frame.cell(*frame.centres(np.zeros(1, np.int64))[0].tolist())
        bounds.hold(row, row + frame.rows, col, col + frame.cols)
        rows, cols = mission.known
        if rows.stop > rows.start:
            bounds.hold(rows.start, rows.stop, cols.start, cols.stop)
        return bounds.extent

    def _replayed(self, times: Sequence[float], known: Sequence[float]) -> Replayed:
        missions = self.missions
        most = max(
            range(len(missions)), key=lambda i: int(np.count_nonzero(missions[i].fusion.classes.blocks))
        )
        frame, classes = self._map(most)
        counts = sum((mission.own.counts for mission in missions), empty_counts())
        return Replayed(
            name=self.log.name,
            frame=frame,
            classes=classes,
            counts=counts,
            times=tuple(times),
            known_m2=tuple(known),
            sights=self.robots.told,
            of_sights=len(self.log.sights),
            maps=bool(self.log.maps),
            way_m=self.log.way,
            reach_m=self.setup.reach,
            agreed=len({mission.fusion.digest for mission in missions}) == 1,
            names=tuple(spec.name for spec in self.specs),
            whose=self.specs[most].name,
            ways=tuple(way_of(share) for share in self.robots.shares),
            frames=None if self._watch is None else self._watch.look(last=True),
        )

    def _map(self, robot: int) -> tuple[GridFrame, NDArray[np.uint8]]:
        """Return a robot's map in the log's frame, where its own truly lies."""
        mission, frame = self.missions[robot], self.lattice.frame
        if self.frames is None:
            extent = self._extent(mission)
            return frame.window(*extent), mission.fusion.classes.window(*extent)
        classes = mission.fusion.classes.window(*mission.known)
        return laid_back(classes, frame.window(*mission.known), self.frames[robot], self._frame)


def _check_maps(log: RecordedLog, setup: ReplaySetup) -> None:
    if setup.fusion == "channel":
        raise InputError(
            f"{log.name} holds maps, and --fusion channel cannot take back what an older one said; leave it "
            "out"
        )
    if not any(each.classes.any() for each in log.maps):
        raise InputError(f"{log.name}: nothing of its maps is known; record some of a mission")


def _middle(frame: GridFrame) -> tuple[float, float]:
    """Return the corner of a frame's cells [m] about which an open lattice has room for all of it."""
    x = frame.origin_x + frame.cols // 2 * frame.resolution
    return x, frame.origin_y + frame.rows // 2 * frame.resolution


def _spec(log: RecordedLog, reach: float, number: int) -> PlatformSpec:
    """Return the robot that a log is of, as far as the log tells."""
    if not log.scans:
        return PlatformSpec(f"robot-{number}", range=reach)
    scan = log.scans[0]
    count = len(scan.angles)
    step = float(np.median(np.diff(scan.angles))) if count > 1 else math.radians(1.0)
    view = min(max(math.degrees(abs(step)) * count, 1.0), 360.0)
    return PlatformSpec(f"robot-{number}", range=reach, view=view, beams=min(max(count, 8), 4096))
