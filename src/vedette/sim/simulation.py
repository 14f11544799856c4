"""A whole mission in one process: the world, the bodies, the links, and every robot's own agent.

The agents are those that run on a network; only who delivers their events differs. Time is simulated and
randomness seeded: the same arguments give the same mission, event for event.
"""

from __future__ import annotations

import heapq
import time as wall
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, step
from vedette.agent.effects import Drive, Effect, Job, Send
from vedette.agent.events import Arrived, Event, JobDone, Message, Pose, Scan, Stuck, TreeChanged
from vedette.agent.messages import Negotiate, decode
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS
from vedette.fusion import ChannelFilter, Fusion, ReplicatedEvidence
from vedette.kernels.lidar import cast_rays
from vedette.missions.explore import Exploration
from vedette.negotiation import Tree
from vedette.record.summary import Outcome
from vedette.sim.body import Bodies
from vedette.sim.links import Links
from vedette.sim.world import World
from vedette.team import PlatformSpec

BOOT = 1  # simulated robots start once
TICK = 0.1  # of bodies and poses [s]
JOB_TIME = 0.03  # charged for preparing a round [s]
STUCK_AFTER = 4.0  # without progress [s]
NOTICED_AFTER = 1.0  # a dead robot is missed, and the tree made anew, after so long [s]
NO_PROGRESS = 300.0  # no robot has got a new route for so long: give up [s]


SCHEMES = ("token", "jacobi")
FUSIONS: Mapping[str, type[ReplicatedEvidence] | type[ChannelFilter]] = {
    "replicated": ReplicatedEvidence,
    "channel": ChannelFilter,
}


@dataclass(frozen=True)
class Setup:
    """What to simulate, beside the world and the team."""

    planner: str = "tours"
    scheme: str = "token"
    fusion: str = "replicated"
    seed: int = 0
    max_time: float = 3600.0  # [s]
    link_delay: float = 0.02  # [s]
    link_loss: float = 0.0
    kills: tuple[tuple[int, float], ...] = ()  # robot index, time [s]
    return_home: bool = False


@dataclass
class Clock:
    """Wall-clock figures of a run, apart from all that is simulated; on an idle core also its CPU time."""

    started: float = 0.0
    planning: dict[tuple[int, int, int], float] = field(default_factory=dict)  # robot, epoch, round: [s]
    answers: list[float] = field(default_factory=list)  # a negotiation message, each [s]

    def start(self) -> None:
        """Begin counting."""
        self.started = wall.perf_counter()

    def elapsed(self) -> float:
        """Return the wall time since the start [s]."""
        return wall.perf_counter() - self.started


class Simulation:
    """One mission; ``run`` steps it to its end."""

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        setup: Setup,
    ) -> None:
        """Put the team at its starts, (n, 3) x, y, heading [m, m, rad], team frame."""
        self.world, self.specs, self.starts, self.setup = world, tuple(specs), starts, setup
        n = len(self.specs)
        self._corner = np.array((world.frame.origin_x, world.frame.origin_y))
        local = starts.copy()
        local[:, :2] -= self._corner
        self.bodies = Bodies(world.solid, world.frame.resolution, self.specs, local)
        seeds = np.random.SeedSequence(setup.seed).spawn(n + 1)
        self._noise = [np.random.default_rng(seed) for seed in seeds[:n]]
        self.links = Links(n, setup.link_delay, setup.link_loss, np.random.default_rng(seeds[n]))
        self.missions = [self._mission(i) for i in range(n)]
        self.agents = [
            Agent(i, BOOT, spec, world.frame, mission, setup.scheme, setup.return_home)
            for i, (spec, mission) in enumerate(zip(self.specs, self.missions, strict=True))
        ]
        self.clock = Clock()
        self.now = 0.0
        self._jobs: list[tuple[float, int, Job]] = []
        self._tree_due = [0.0]
        self._epoch = 0
        self._kills = sorted(setup.kills, key=lambda kill: kill[1])
        self._radii = np.array([spec.radius for spec in self.specs])
        self._beams = [
            np.radians(spec.view) * ((np.arange(spec.beams) + 0.5) / spec.beams - 0.5) for spec in self.specs
        ]
        self._next_scan = [0.0] * n
        self._stuck_told = [0.0] * n
        self._told_arrival = [True] * n
        self._last_change = 0.0
        self._stopped = False

    def _mission(self, i: int) -> Exploration:
        fusion: Fusion = FUSIONS[self.setup.fusion](i, BOOT, self.world.frame.shape, 4 * BINS)
        return Exploration(self.world.frame, self.specs[i], planner(self.setup.planner), fusion)

    @property
    def living(self) -> list[int]:
        """Indexes of the robots that are alive."""
        return np.flatnonzero(self.bodies.alive).tolist()

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad] of a robot, team frame."""
        x, y, heading = self.bodies.poses[i].tolist()
        return x + self._corner[0], y + self._corner[1], heading

    # -- the loop -----------------------------------------------------------------------------------

    def run(self, observe: Callable[[], None], period: float = 1.0) -> Outcome:
        """Run to the end of the mission, calling ``observe`` every ``period`` simulated seconds."""
        next_look = 0.0
        ticks = 0
        try:
            while True:
                self._tick()
                if self.now >= next_look - 1e-9:
                    observe()
                    next_look += period
                outcome = self._over()
                if outcome is not None:
                    break
                ticks += 1
                self._deliver_until(ticks * TICK)
                self.now = ticks * TICK
                self.bodies.step(TICK)
        except KeyboardInterrupt:
            outcome = Outcome.INTERRUPTED
        return outcome

    def stop(self) -> None:
        """Interrupt the mission at the end of the present tick; may be called from a signal handler."""
        self._stopped = True

    def _over(self) -> Outcome | None:
        if not self.living:
            return Outcome.TEAM_LOST
        if all(self.agents[i].done for i in self.living):
            return Outcome.COMPLETE
        if self._stopped:
            return Outcome.INTERRUPTED
        if self.now >= self.setup.max_time:
            return Outcome.TIME_LIMIT
        if self.now > self._last_change + NO_PROGRESS:
            return Outcome.NO_PROGRESS
        return None

    def _tick(self) -> None:
        """Let faults happen, then tell every agent what its robot senses."""
        while self._kills and self._kills[0][1] <= self.now:
            robot, _ = self._kills.pop(0)
            self.bodies.kill(robot)
            self._tree_due.append(self.now + NOTICED_AFTER)
        if self._tree_due and self._tree_due[0] <= self.now:
            self._tree_due.pop(0)
            self._plant_tree()
        for i in self.living:
            self._step(i, self._sensed(i))

    def _plant_tree(self) -> None:
        """Give the living robots a balanced tree."""
        living = self.living
        if not living:
            return
        tree = Tree.balanced(len(living))
        self._epoch += 1
        for place, i in enumerate(living):
            parent = tree.parents(0)[place]
            neighbours = tuple(living[k] for k in tree.neighbours(place))
            event = TreeChanged(
                self._epoch, None if parent is None else living[parent], neighbours, len(living)
            )
            self._step(i, [event])

    def _sensed(self, i: int) -> list[Event]:
        x, y, heading = self.pose(i)
        slowed = self.bodies.stuck_for(i)
        events: list[Event] = [Pose(x, y, heading, slowed)]
        if self.now >= self._next_scan[i] - 1e-9:
            self._next_scan[i] += 1.0 / self.specs[i].rate
            events.append(self._scan(i, x, y, heading))
        if not self._told_arrival[i] and self.bodies.arrived(i):
            self._told_arrival[i] = True
            events.append(Arrived())
        elif slowed < STUCK_AFTER:
            self._stuck_told[i] = 0.0
        elif slowed - self._stuck_told[i] >= STUCK_AFTER:
            self._stuck_told[i] = slowed
            events.append(Stuck())
        return events

    def _scan(self, i: int, x: float, y: float, heading: float) -> Scan:
        spec = self.specs[i]
        angles = heading + self._beams[i]
        discs = np.column_stack((self.bodies.poses[:, :2], self._radii))[np.arange(len(self.specs)) != i]
        local = self.bodies.poses[i]
        ranges = cast_rays(
            self.world.solid, self.world.frame.resolution, local[0], local[1], angles, spec.range, discs
        )
        noise = self._noise[i].normal(0.0, spec.range_noise, spec.beams)
        return Scan(angles, np.maximum(ranges + noise, 0.0))

    def _deliver_until(self, time: float) -> None:
        """Deliver messages and finished jobs in order of time."""
        while True:
            job_due = self._jobs[0][0] if self._jobs else float("inf")
            message_due = self.links.next_arrival()
            if min(job_due, message_due) >= time:
                return
            if job_due <= message_due:
                self.now, robot, job = heapq.heappop(self._jobs)
                if self.bodies.alive[robot]:
                    self._step(robot, [JobDone(job.key)])
            else:
                self.now, sender, receiver, payload = self.links.arrive()
                if self.bodies.alive[receiver]:
                    self._step(receiver, [Message(sender, payload)])

    def _step(self, i: int, events: list[Event]) -> None:
        agent = self.agents[i]
        began = wall.perf_counter()
        before = agent.rounds.decisions
        effects = step(agent, events, self.now)
        took = wall.perf_counter() - began
        if agent.rounds.busy or agent.rounds.decisions != before:
            key = i, *agent.rounds.stamp
            self.clock.planning[key] = self.clock.planning.get(key, 0.0) + took
            if agent.rounds.decisions == before and _negotiates(events[0]):
                self.clock.answers.append(took)
        for effect in effects:
            self._carry_out(i, effect)

    def _carry_out(self, i: int, effect: Effect) -> None:
        match effect:
            case Send():
                self.links.send(i, effect, self.now)
            case Drive(route):
                self._told_arrival[i] = route is None
                if route is None:
                    self.bodies.command(i, None)
                else:
                    self.bodies.command(i, route.path - self._corner, route.passable)
                    self._last_change = self.now
            case Job():
                began = wall.perf_counter()
                effect.run()
                key = i, *effect.key
                self.clock.planning[key] = self.clock.planning.get(key, 0.0) + wall.perf_counter() - began
                heapq.heappush(self._jobs, (self.now + JOB_TIME, i, effect))


def _negotiates(event: Event) -> bool:
    return isinstance(event, Message) and isinstance(decode(event.payload), Negotiate)
