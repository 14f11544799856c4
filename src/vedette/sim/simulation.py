"""A whole mission in one process: the links, the faults, and every robot's own agent in a physical world.

The agents are those that run on a network; only who delivers their events differs. Time is simulated and
randomness seeded: the same arguments give the same mission, event for event.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Sequence
from functools import partial
from queue import Queue

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.agent.body import TICK
from vedette.agent.effects import Drive, Fly, Job
from vedette.agent.events import Event, JobDone, Ordered
from vedette.agent.orders import Given, Order, OrderT, encode
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.outcome import Agreement, Outcome
from vedette.record.clock import Clock
from vedette.sim.datagrams import Datagrams
from vedette.sim.faults import Timeline
from vedette.sim.field import Field
from vedette.sim.links import Wires
from vedette.sim.network import Act, Network, Spawn
from vedette.sim.overlaid import OverlaidNetwork
from vedette.sim.planted import PlantedTree
from vedette.sim.radio import Radio
from vedette.sim.setup import Setup

OPEN = World(GridFrame(1.0, 1, 1), np.zeros((1, 1), np.bool_), "open")  # no walls at all
JOB_TIME = 0.03  # charged for preparing a round [s]


def random_streams(seed: int, robots: int) -> list[np.random.Generator]:
    """Return one stream of chance a robot, and a last one that ``Simulation`` draws lost messages from."""
    return [np.random.default_rng(each) for each in np.random.SeedSequence(seed).spawn(robots + 1)]


class Simulation:
    """One mission; ``step`` takes it on, ``run`` to its end."""

    def __init__(self, spawn: Spawn, field: Field, setup: Setup, walls: World | None = None) -> None:
        """Bring the robots of the field to life; ``walls``: what weakens their radios.

        Raises:
            InputError: something is to befall robots that the field has not.
        """
        setup.check_team(len(field.alive))
        self.field, self.setup = field, setup
        self.network: Network = self._planted(spawn) if setup.ideal else self._overlaid(spawn, walls)
        self.clock = Clock()
        self.now = 0.0
        self._ticks = -1  # that have passed; none has been lived yet, not even that of time 0
        self.sensed: dict[int, list[Event]] = {}  # by robot, what its agent was told of the world last
        self._jobs: list[tuple[float, int, int, Job]] = []  # when done, number, robot
        self._job_numbers = itertools.count()
        self._kills = sorted(setup.kills, key=lambda kill: kill[1])
        self._stopped = False
        self._agreement = Agreement()
        self._orders, self._given = list(setup.orders), 0
        self._told = Queue[Order]()  # from other threads

    def _planted(self, spawn: Spawn) -> Network:
        wires = Wires(len(self.field.alive), self.setup.link_delay)
        return PlantedTree(spawn, lambda: self.field.alive, wires, self.setup.apart)

    def _overlaid(self, spawn: Spawn, walls: World | None) -> Network:
        n, setup = len(self.field.alive), self.setup
        datagrams = Datagrams(n, random_streams(setup.seed, n)[n], (setup.link_delay, setup.link_delay))
        datagrams.set_links(np.full((n, n), 1.0 if setup.apart else setup.link_loss))
        timeline = None if setup.faults is None else Timeline(setup.faults, n)
        losses = None
        if setup.radio is not None and not setup.apart:
            losses = partial(self._losses, setup.radio, walls or OPEN)
        return OverlaidNetwork(spawn, self.field, datagrams, timeline=timeline, losses=losses)

    def _losses(self, radio: Radio, walls: World) -> NDArray[np.float64]:
        """Return the ``(n, n)`` share of datagrams lost between robots where they are now."""
        corner = walls.frame.origin_x, walls.frame.origin_y
        places = np.array([self.field.pose(i)[:2] for i in range(len(self.field.alive))]) - corner
        lost = radio.quality(walls.solid, walls.frame.resolution, places)
        return 1.0 - (1.0 - lost) * (1.0 - self.setup.link_loss)

    @property
    def agents(self) -> list[Agent]:
        """Everybody's agent, by index."""
        return list(self.network.agents)

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
        try:
            while True:
                self.step()
                if self.now >= next_look - 1e-9:
                    observe()
                    next_look += period
                if (outcome := self.over) is not None:
                    return outcome
        except KeyboardInterrupt:
            return Outcome.INTERRUPTED

    def step(self) -> None:
        """Let the next tick pass, the first time none, and tell every agent what its robot senses then."""
        if self._ticks < 0:
            self.clock.start()
        self._ticks += 1
        if self._ticks:
            self._deliver_until(self._ticks * TICK)
            self.now = self._ticks * TICK
            self.field.advance(self.now, TICK)
        self._tick()

    def stop(self) -> None:
        """Interrupt the mission at the end of the present tick; may be called from a signal handler."""
        self._stopped = True

    @property
    def over(self) -> Outcome | None:
        """How the mission ends as it stands now; None: it goes on."""
        living = self.living
        if not living:
            return Outcome.TEAM_LOST
        agents = self.network.agents
        if all(agents[i].done for i in living):
            ended = self._agreement.reached(self.held(living), [agents[i].ending for i in living], self.now)
            if ended is not None:
                return ended
        else:
            self._agreement.off()
        if self._stopped:
            return Outcome.INTERRUPTED
        outcome = self.field.over(self.now)
        if outcome is None and self.now >= self.setup.max_time:
            return Outcome.TIME_LIMIT
        return outcome

    def held(self, robots: Sequence[int]) -> list[int]:
        """Return a digest each of what these have to agree on before their mission ends: of nothing."""
        return []

    def order(self, order: Order) -> None:
        """Give an order at the next tick; any thread may."""
        self._told.put(order)

    def as_told(self, order: Order) -> Order:
        """Return an order of this world as the operator gives it to the robots."""
        return order

    def as_meant(self, order: OrderT) -> OrderT:
        """Return an order that robots hold as it is of this world."""
        return order

    def _give_orders(self) -> None:
        """Let the operator tell the first living robot what is due, who passes it on; if nobody does, all."""
        due = [each.what for each in self._orders if each.at <= self.now + 1e-9]
        del self._orders[: len(due)]
        while not self._told.empty():
            due.append(self._told.get())
        for order in due:
            self._given += 1
            for i in self.living if self.setup.apart else self.living[:1]:
                told = Ordered(encode(Given(self._given, "operator", self.as_told(order))))
                self._let(i, self.network.tell(i, [told], self.now))

    def _tick(self) -> None:
        """Let orders be given and faults happen, then tell every agent what its robot senses."""
        self._give_orders()
        while self._kills and self._kills[0][1] <= self.now:
            robot, _ = self._kills.pop(0)
            self.field.kill(robot)
            self.network.killed(robot, self.now)
        for i, act in self.network.tick(self.now):
            self._let(i, act)
        self.sensed = {}
        for i in self.living:
            self.sensed[i] = self.field.sense(i, self.now)
            self._let(i, self.network.tell(i, self.sensed[i], self.now))

    def _deliver_until(self, time: float) -> None:
        """Deliver messages and finished jobs in order of time."""
        while True:
            job_due = self._jobs[0][0] if self._jobs else float("inf")
            if min(job_due, self.network.due()) >= time:
                return
            if job_due <= self.network.due():
                self.now, _, robot, job = heapq.heappop(self._jobs)
                act = self.network.tell(robot, [JobDone(job.key)], self.now)
            else:
                self.now, robot, act = self.network.happen()
            if self.field.alive[robot]:
                self._let(robot, act)

    def _let(self, i: int, act: Act) -> None:
        """Let a robot do something, and carry out what comes of it."""
        for effect in self.clock.measured(i, self.network.agents[i].rounds, act):
            match effect:
                case Job():
                    self._run(i, effect)
                case Drive() | Fly():
                    self.field.carry_out(i, effect, self.now)
                case _:
                    self.network.send(i, effect, self.now)

    def _run(self, i: int, job: Job) -> None:
        self.clock.run(i, job)
        heapq.heappush(self._jobs, (self.now + JOB_TIME, next(self._job_numbers), i, job))
