"""A whole mission in one process: the links, the faults, and every robot's own agent in a physical world.

The agents are those that run on a network; only who delivers their events differs. Time is simulated and
randomness seeded: the same arguments give the same mission, event for event.
"""

from __future__ import annotations

import heapq
import time as wall
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from vedette.agent import Agent, step
from vedette.agent.effects import Effect, Job, Send
from vedette.agent.events import Event, JobDone, Message, TreeChanged
from vedette.agent.messages import Negotiate, decode
from vedette.negotiation import Tree
from vedette.record.summary import Outcome
from vedette.sim.field import Field
from vedette.sim.links import Links

BOOT = 1  # simulated robots start once
TICK = 0.1  # of bodies and poses [s]
JOB_TIME = 0.03  # charged for preparing a round [s]
NOTICED_AFTER = 1.0  # a dead robot is missed, and the tree made anew, after so long [s]


@dataclass(frozen=True)
class Setup:
    """What all simulated missions share, beside the world and the team."""

    scheme: str = "token"
    seed: int = 0
    max_time: float = 3600.0  # [s]
    link_delay: float = 0.02  # [s]
    link_loss: float = 0.0
    kills: tuple[tuple[int, float], ...] = ()  # robot index, time [s]


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


def random_streams(seed: int, robots: int) -> list[np.random.Generator]:
    """Return one stream of chance a robot, and a last one that ``Simulation`` draws lost messages from."""
    return [np.random.default_rng(each) for each in np.random.SeedSequence(seed).spawn(robots + 1)]


class Simulation:
    """One mission; ``run`` steps it to its end."""

    def __init__(self, agents: Sequence[Agent], field: Field, setup: Setup) -> None:
        """Bring agents, by index the robots of the field, to life."""
        n = len(agents)
        self.agents, self.field, self.setup = list(agents), field, setup
        self.links = Links(n, setup.link_delay, setup.link_loss, random_streams(setup.seed, n)[n])
        self.clock = Clock()
        self.now = 0.0
        self._jobs: list[tuple[float, int, Job]] = []
        self._tree_due = [0.0]
        self._epoch = 0
        self._kills = sorted(setup.kills, key=lambda kill: kill[1])
        self._stopped = False

    @property
    def living(self) -> list[int]:
        """Indexes of the robots that are alive."""
        return np.flatnonzero(self.field.alive).tolist()

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad] of a robot, team frame."""
        return self.field.pose(i)

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
                self.field.advance(self.now, TICK)
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
        outcome = self.field.over(self.now)
        if outcome is None and self.now >= self.setup.max_time:
            return Outcome.TIME_LIMIT
        return outcome

    def _tick(self) -> None:
        """Let faults happen, then tell every agent what its robot senses."""
        while self._kills and self._kills[0][1] <= self.now:
            robot, _ = self._kills.pop(0)
            self.field.kill(robot)
            self._tree_due.append(self.now + NOTICED_AFTER)
        if self._tree_due and self._tree_due[0] <= self.now:
            self._tree_due.pop(0)
            self._plant_tree()
        for i in self.living:
            self._step(i, self.field.sense(i, self.now))

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

    def _deliver_until(self, time: float) -> None:
        """Deliver messages and finished jobs in order of time."""
        while True:
            job_due = self._jobs[0][0] if self._jobs else float("inf")
            message_due = self.links.next_arrival()
            if min(job_due, message_due) >= time:
                return
            if job_due <= message_due:
                self.now, robot, job = heapq.heappop(self._jobs)
                if self.field.alive[robot]:
                    self._step(robot, [JobDone(job.key)])
            else:
                self.now, sender, receiver, payload = self.links.arrive()
                if self.field.alive[receiver]:
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
            case Job():
                began = wall.perf_counter()
                effect.run()
                key = i, *effect.key
                self.clock.planning[key] = self.clock.planning.get(key, 0.0) + wall.perf_counter() - began
                heapq.heappush(self._jobs, (self.now + JOB_TIME, i, effect))
            case motion:
                self.field.carry_out(i, motion, self.now)


def _negotiates(event: Event) -> bool:
    return isinstance(event, Message) and isinstance(decode(event.payload), Negotiate)
