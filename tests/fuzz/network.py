"""Targets that are whole agents on a network: hellos, packets and beacons come to them as datagrams."""

from __future__ import annotations

import heapq
import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import msgspec

from tests.fuzz.agents import DELAY, END, MOST_SCENES, TICK, explore
from tests.fuzz.keep import Kept
from tests.fuzz.scripts import Script, Stage, Told, scripted
from tests.fuzz.target import Target
from vedette.agent import NetworkedAgent
from vedette.agent.effects import Drive, Job
from vedette.agent.events import JobDone, Pose
from vedette.agent.networked import PACKET, Datagram, Output
from vedette.overlay import packet

CHAIN = ((1,), (0, 2), (1, 3), (2,))  # whom each robot reaches
CAUGHT = 1  # it has a neighbour on either side
BEGIN = 0.5  # of what is caught, the tree's forming included [s]
AFTER = 12  # times to go on after a script
_PARTS = msgspec.msgpack.Decoder(tuple[int, bytes])
_ENCODER = msgspec.msgpack.Encoder()
COUNTS = frozenset(
    {"malformed", "dropped", "dropped_of", "answers", "complaints"}
)  # what a refused datagram may change


@dataclass(eq=False)
class Caught:
    """A networked agent at a time."""

    node: NetworkedAgent
    now: float
    jobs: list[Job] = field(default_factory=list)

    def note(self, outputs: Sequence[Output]) -> None:
        """Keep the jobs to do."""
        self.jobs += [output for output in outputs if isinstance(output, Job)]


def _stage() -> Stage:
    """Let a chain of robots find each other and explore; catch one before datagrams of every kind."""
    simulation = explore()
    robots = simulation.field
    nodes = [NetworkedAgent(agent, 0.0) for agent in simulation.agents]
    scenes: list[Kept] = []
    scripts: list[Script] = []
    met: Counter[tuple[int, str]] = Counter()
    due: list[tuple[float, int, int, int, bytes | JobDone]] = []  # time, number, sender, robot, what comes
    numbers = itertools.count()

    def put(i: int, outputs: Sequence[Output], now: float) -> None:
        for output in outputs:
            match output:
                case Datagram(to, payload):
                    heapq.heappush(due, (now + DELAY, next(numbers), i, to, payload))
                case Job(key, run):
                    run()
                    heapq.heappush(due, (now + DELAY, next(numbers), i, i, JobDone(key)))
                case Drive():
                    robots.carry_out(i, output, now)

    def catch(sender: int, payload: bytes, now: float) -> None:
        kind = sender, _kind(payload)
        met[kind] += now >= BEGIN
        if 0 < met[kind] <= MOST_SCENES:
            told = Told(sender, _ENCODER.encode((payload[0], payload[1:])))  # so that mutations reach inside
            scripts.append(Script(len(scenes), (told,)))
            scenes.append(Kept(Caught(nodes[CAUGHT], now)))

    for i, node in enumerate(nodes):
        put(i, node.peers(CHAIN[i], 0.0), 0.0)
    for tick in range(round(END / TICK)):
        for i, node in enumerate(nodes):
            put(i, node.step(robots.sense(i, TICK * tick), TICK * tick), TICK * tick)
        while due and due[0][0] < TICK * (tick + 1):
            now, _, sender, i, what = heapq.heappop(due)
            if isinstance(what, JobDone):
                put(i, nodes[i].step([what], now), now)
                continue
            if i == CAUGHT:
                catch(sender, what, now)
            put(i, nodes[i].hear(sender, what, now), now)
        robots.advance(TICK * (tick + 1), TICK)
    return Stage(scenes, scripts)


def _datagram(payload: bytes) -> bytes:
    """Return the datagram of which these are the first byte and the others; other bytes are one."""
    try:
        kind, data = _PARTS.decode(payload)
        return bytes([kind % 256]) + data
    except (ValueError, RecursionError):
        return payload


def _kind(payload: bytes) -> str:
    """Name a datagram's kind; of a packet, those of its messages too."""
    if payload[:1] != PACKET:
        return payload[:1].decode()
    return "P" + " ".join(
        str(msgspec.msgpack.decode(each)[0]) for each in packet.decode(payload[1:]).messages
    )


def _ready(caught: Caught) -> None:
    caught.note(caught.node.step((), caught.now))


def _hear(caught: Caught, sender: int, payload: bytes) -> bool:
    """Take in a datagram; tell whether it was refused as a whole."""
    before = caught.node.malformed
    caught.note(caught.node.hear(sender, _datagram(payload), caught.now))
    return caught.node.malformed > before


def _go_on(caught: Caught) -> None:
    """Let jobs run and time pass."""
    node = caught.node
    for _ in range(AFTER):
        caught.now += 0.25
        jobs, caught.jobs = caught.jobs, []
        for job in jobs:
            job.run()
            caught.note(node.step([JobDone(job.key)], caught.now))
        pose = node.agent.pose  # None: the overlay has not told the agent its place
        sensed = [] if pose is None else [Pose(pose.x, pose.y, pose.heading, pose.slowed)]
        caught.note(node.step(sensed, caught.now))
    node.overlay.status(caught.now)


def networked() -> list[Target]:
    """Return them all; a first byte says whether it is a hello, a packet or a beacon."""
    return [scripted("network-explore", _stage, _hear, _go_on, COUNTS, _ready)]
