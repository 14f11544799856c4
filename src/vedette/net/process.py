"""One robot as a process: its agent, over Zenoh, in a body."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

from vedette.agent import Datagram, NetworkedAgent
from vedette.agent.body import Body, Shown
from vedette.agent.effects import Drive, Fly, Job
from vedette.agent.events import JobDone, Ordered
from vedette.agent.networked import Output
from vedette.net.clock import Clockwork
from vedette.net.inbox import Inbox, PeerGone, PeerSeen
from vedette.net.inbox import ReceivedDatagram as Received
from vedette.net.keeping import Keeper
from vedette.net.names import Topic, robot_name
from vedette.net.orders import TAKEN, Judge
from vedette.net.report import encode
from vedette.net.revocations import KIND as REVOKED
from vedette.net.revocations import Revocations
from vedette.net.transport import Published, ToldOrder, Transport
from vedette.net.witness import Witness

REPORT_PERIOD = 0.5  # of mission time, but not more often than LEAST_REPORTS apart [s]
LEAST_REPORTS = 0.1  # [s]
MOST_HEARING = 0.05  # at a stretch, before the body moves on [s]


@dataclass(frozen=True)
class _Done:
    """A job has run."""

    job: Job
    error: BaseException | None


class Staged(Protocol):
    """Faults of links, done to what the robot sends; ``now`` by the process's clock [s]."""

    def put(self, to: int, payload: bytes, now: float) -> None:
        """Take a datagram; it may get lost."""

    def take(self, now: float) -> Iterable[tuple[int, bytes]]:
        """Yield what is to be sent by now: to whom, and the datagram."""


@dataclass
class AgentProcess:
    """Runs a robot until it is told to stop; only this touches the clock, the network and threads.

    The agent, its overlay and its links run in one thread. Heavy computing runs in another, while the agent
    waits and the overlay goes on.
    """

    node: NetworkedAgent
    body: Body
    shown: Shown | None  # the body, where it is simulated and others are to see it
    transport: Transport
    inbox: Inbox
    witness: Witness
    mission: Clockwork
    show: Callable[[float], None] | None  # the robot to those beside it, at a mission's time [s]
    say: Callable[[str], None]  # tells whoever watches this process, a line each
    revocations: Revocations | None = None  # of certificates; None: links are open to everybody
    staged: Staged | None = None  # what befalls its links, to try a team
    keeper: Keeper | None = None  # of what the robot finds out
    judge: Judge | None = None  # of the operator's orders; None: it takes none
    clock: Callable[[], float] = time.monotonic
    stopped: bool = False
    _reported: float = -1e9  # [s]
    _reported_at: float = -1e9  # mission time [s]
    _remarked: bool = False  # on itself
    _said: dict[int, str] = field(default_factory=dict)  # complaints, by robot
    _heeded: int = 0  # number of the list of revoked certificates

    def stop(self) -> None:
        """End ``run`` soon; may be called from a signal handler."""
        self.stopped = True

    def run(self) -> None:
        """Run until stopped; then say goodbye."""
        if self.shown is not None:
            self.transport.subscribe(Topic.BODY, self.inbox.put)
        self.transport.answer_status(lambda: self.witness.status)
        if self.judge is not None:
            self.transport.answer_orders(self.inbox.put)
        self.mission.start(self.clock())
        with (
            ThreadPoolExecutor(1, thread_name_prefix="planning") as self._worker,
            ThreadPoolExecutor(1, thread_name_prefix="errands") as self._errands,
        ):
            while not self.stopped:
                self._turn()
        self.body.stop(self.mission.shows(self.clock()))
        for goodbye in self.node.leave(self.clock()):
            self.transport.send(goodbye.to, goodbye.payload)
        self._report(self.clock(), state="left")

    def _turn(self) -> None:
        """Wait until something happens or is due, and see to it.

        What has been said is heard before the body moves on: where the host is too slow, the mission's time
        slows down, and messages do not grow old.
        """
        due = min(self.node.wake, self.mission.next)
        event = self.inbox.get(timeout=due - self.clock())
        until = self.clock() + MOST_HEARING
        while event is not None:
            self._take(event)
            event = self.inbox.get(timeout=0.0) if self.clock() < until else None
        now = self.clock()
        if self.staged is not None:
            for to, payload in self.staged.take(now):
                self.transport.send(to, payload)
        if now >= self.mission.next:
            self._tick(now)
        elif now >= self.node.wake:
            self._do(partial(self.node.step, (), now))

    def _take(self, event: object) -> None:
        now = self.clock()
        match event:
            case Received(robot, payload) if payload.startswith(REVOKED):
                self._hear_of_revoked(robot, payload, now)
            case Received(robot, payload):
                self._do(partial(self.node.hear, robot, payload, now))
            case PeerSeen():
                self._do(partial(self.node.peers, self.transport.peers, now))
            case PeerGone(robot):
                self._do(partial(self.node.lost, robot, now))
                self._do(partial(self.node.peers, self.transport.peers, now))
            case ToldOrder() if self.judge is not None:
                event.answer(verdict := self.judge.verdict(event.payload))
                if verdict == TAKEN:
                    self._do(partial(self.node.step, [Ordered(event.payload)], now))
            case Published(robot=robot, payload=payload):
                self._see(robot, payload, now)
            case _Done(job, error):
                if error is not None:
                    raise error
                if not job.beside:
                    self.node.hold = False
                    self._do(partial(self.node.step, [JobDone(job.key)], now))

    def _tick(self, now: float) -> None:
        """Move the body, and let the agent know what it senses."""
        self.mission.tick(now)
        at = self.mission.at
        sensed = self.body.sense(at)
        if self.shown is not None:
            self.transport.publish(Topic.BODY, self.shown.show(now))
        self._do(partial(self.node.step, sensed, now))
        due = at >= self._reported_at + REPORT_PERIOD and now >= self._reported + LEAST_REPORTS
        if due and not self.node.hold:  # not while the agent is at work in another thread
            self._report(now)

    def _hear_of_revoked(self, robot: int, payload: bytes, now: float) -> None:
        if self.revocations is None:
            return
        try:
            for to, answer in self.revocations.hear(robot, payload[1:]):
                self.transport.send(to, answer)
        except ValueError:
            self.witness.malformed += 1
        self._heed_revoked(now)

    def _heed_revoked(self, now: float) -> None:
        """Have nothing to do with whose certificate has been revoked, and let the neighbours know."""
        revocations = self.revocations
        if revocations is None:
            return
        revocations.look(now)
        if revocations.latest.number > self._heeded:
            self._heeded = revocations.latest.number
            self._do(partial(self.node.exclude, revocations.complaints, now))
        for to, told in revocations.tell(self.transport.peers, now):
            self.transport.send(to, told)

    def _see(self, robot: int, payload: bytes, now: float) -> None:
        if self.shown is None:
            return
        try:
            self.shown.see(robot, payload, now)
        except ValueError:
            self.witness.malformed += 1

    def _report(self, now: float, state: str | None = None) -> None:
        """Tell the operator, if any, how it goes, and keep what has come to be known."""
        self._heed_revoked(now)
        at = self.mission.shows(now)
        self._reported, self._reported_at = now, at
        self.node.drowning = self.inbox.drowning
        if self.show is not None:
            self.show(at)
        for robot, what in self.node.complaints.items():
            if self._said.get(robot) != what:
                self._said[robot] = what
                self.say(f"{robot_name(robot)}: {what}")
        alerts = () if self.keeper is None else self.keeper.alerts
        report = self.witness.report(now, at, state, alerts)
        self.transport.publish(Topic.REPORT, encode(report))
        if self.keeper is not None:
            self.keeper.take(report, now)
        if (remark := self.witness.remark) is not None and not self._remarked:
            self._remarked = True
            self.say(remark)

    def _do(self, act: Callable[[], Iterable[Output]]) -> None:
        """Let the robot do something, and carry out what it wants done."""
        agent = self.node.agent
        for output in self.witness.clock.measured(agent.robot, agent.rounds, act):
            match output:
                case Datagram(to, payload) if self.staged is not None:
                    self.staged.put(to, payload, self.clock())
                case Datagram(to, payload):
                    self.transport.send(to, payload)
                case Job(beside=True):
                    self._errands.submit(self._run, output)
                case Job():
                    self.node.hold = True
                    self._worker.submit(self._run, output)
                case Drive() | Fly():
                    self.body.carry_out(output, self.mission.shows(self.clock()))
        self.witness.note(self.clock())

    def _run(self, job: Job) -> None:
        error: BaseException | None = None
        try:
            if job.beside:
                job.run()
            else:
                self.witness.clock.run(self.node.agent.robot, job)
        except BaseException as raised:  # raised again where somebody sees it
            error = raised
        self.inbox.put(_Done(job, error))
