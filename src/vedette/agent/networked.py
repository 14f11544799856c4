"""An agent on a network: the overlay gives it a tree, and reliable links carry what it says to neighbours.

Sans-I/O as its parts are: the simulator and the network process hand it what happens, and send what it wants
sent. A datagram may be lost, repeated, late or out of order; what it says is checked wherever it is read.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import inf
from typing import TypeAlias

from vedette.agent.acquaintance import Acquaintance
from vedette.agent.agent import step
from vedette.agent.effects import Job, Motion, Send, Shun, TrafficKind
from vedette.agent.events import CertificatesRevoked, Event, Message, TreeChanged
from vedette.agent.mates import MOST_MATES
from vedette.agent.state import Agent
from vedette.agent.terms import Terms, fingerprint_of
from vedette.fusion.trust import APART
from vedette.overlay import Overlay, Place, ReliableLink

HELLO, PACKET, BEACON, TERMS = b"H", b"P", b"B", b"T"  # a datagram's first byte
SETTLED = 0.5  # a first place on a tree has to last so long before the agent is told of it [s]
ALONE_AT_FIRST = 2.0  # a robot waits so long to be taken in by others before it begins on its own [s]
MUCH = 20  # messages of one neighbour that make no sense are worth a complaint
MOST_WAITING = 4096  # events that wait for a job to end, beside new places on the tree


@dataclass(frozen=True)
class Datagram:
    """Send bytes to a robot that the transport reaches; they may get lost."""

    to: int
    payload: bytes


Output: TypeAlias = Datagram | Motion | Job


class NetworkedAgent:
    """One robot's agent, overlay and links; no I/O, no clock, no randomness.

    Every method takes the transport's time ``now`` [s], a clock that never goes back, and returns what is to
    be done, in order. ``step`` is to be called whenever ``wake`` has come.

    While a job runs (``hold``) the agent is told nothing, since the job works on its state; what happens
    waits. The overlay and the links go on, so that heavy computing never looks like a failure.
    """

    def __init__(
        self,
        agent: Agent,
        now: float,
        *,
        lease: float = 3.0,
        mission_time: Callable[[float], float] = lambda now: now,
        tempo: float = 1.0,
        terms: Terms | None = None,
        time_of_day: Callable[[float], float] = lambda now: now,
        admitted: int = MOST_MATES,
    ) -> None:
        """Start alone.

        Args:
            agent: a fresh one.
            now: [s].
            lease: after which a silent neighbour is given up [s].
            mission_time: what the agent's clock shows when the transport's shows ``now`` [s].
            tempo: by how much the agent's clock goes on in a second of the transport's, at most [s].
            terms: what the team has to agree on: no link is used to who differs.
            admitted: robots of the team are numbered below it, whatever anybody says.
            time_of_day: what the host's clock shows when the transport's shows ``now`` [s].
        """
        self.agent = agent
        agent.rounds.patience.tempo = tempo
        agent.rounds.admitted = agent.mates.admitted = admitted
        self.overlay = Overlay(agent.robot, agent.boot, now, lease, fingerprint_of(terms or {}))
        far = inf if agent.signed is None else APART / 10.0 / tempo
        self._acquaintance = Acquaintance(terms or {}, time_of_day, far)
        self.hold = False
        self.malformed = 0  # datagrams that did not make sense
        self.messages_sent: Counter[TrafficKind] = Counter()
        self.bytes_sent: Counter[TrafficKind] = Counter()
        self._mission_time = mission_time
        self._lease = lease
        self._alone_until = now + ALONE_AT_FIRST
        self._told: Place | None = None  # the place on the tree that the agent knows of
        self._found, self._settled = self.overlay.place, now  # latest place, and when it has proved lasting
        self._links: dict[int, ReliableLink] = {}
        self._sessions: dict[int, tuple[int, int]] = {}  # boot and epoch that each link is open to
        self._waiting: list[Event] = []
        self.drowning: frozenset[int] = frozenset()  # neighbours that say more than the process can hear
        self._reached: frozenset[int] = frozenset()  # robots that the transport reaches
        self._excluded: dict[int, str] = {}  # robots to have nothing to do with, and why

    @property
    def wake(self) -> float:
        """Return when ``step`` next has something to do, if nothing happens before [s]."""
        times = [self.overlay.wake, *(link.wake for link in self._links.values())]
        if self._told is None:
            times.append(self._begin_at)
        return min(times)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot; this robot's own number among them."""
        known, agent = self._acquaintance, self.agent
        much = [robot for robot, count in agent.dropped_of.items() if count >= MUCH]
        odd = dict.fromkeys(much, "much of what it says makes no sense or cannot be, and is dropped")
        odd |= dict.fromkeys(self.drowning, "it says more than can be heard; what is too much is dropped")
        said = known.warnings | odd | self.overlay.complaints | known.complaints
        return said | agent.complaints | self._excluded

    # -- what happens --------------------------------------------------------------------------------

    def peers(self, robots: Iterable[int], now: float) -> list[Output]:
        """Take these as the robots that the transport reaches."""
        self._reached = frozenset(robots)
        self.overlay.peers(self._reached - self._excluded.keys(), now)
        return self.step((), now)

    def exclude(self, robots: Mapping[int, str], now: float) -> list[Output]:
        """Have nothing to do with robots whose certificates count no more, whatever the transport reaches.

        ``robots``: what is wrong with each.
        """
        for robot in robots.keys() - self._excluded.keys():
            self.overlay.lost(robot, now)
        self._excluded = dict(robots)
        self._waiting.append(CertificatesRevoked(frozenset(robots)))
        return self.peers(self._reached, now)

    def lost(self, robot: int, now: float) -> list[Output]:
        """Note that the transport has lost a robot."""
        self.overlay.lost(robot, now)
        return self.step((), now)

    def hear(self, sender: int, datagram: bytes, now: float) -> list[Output]:
        """Take in a datagram; one that makes no sense is counted and dropped."""
        if sender in self._excluded:
            return []
        events: list[Event] = []
        answers: list[bytes] = []
        kind, data, boot = datagram[:1], datagram[1:], self.agent.boot
        try:
            if kind == TERMS:
                answers = self._acquaintance.hear(sender, data, boot, now)
            elif kind == HELLO:
                self.overlay.hear(sender, data, now)
                answers = self._acquaintance.ask(sender, self.overlay.boot_of(sender), boot, now)
            else:
                events = self._take(sender, kind, data, now)
        except ValueError:
            self.malformed += 1
        return [*(self._datagram(sender, TERMS + told) for told in answers), *self.step(events, now)]

    def step(self, events: Iterable[Event], now: float) -> list[Output]:
        """Let the agent take in what its robot senses, or just the time."""
        effects: list[Output] = []
        self._waiting += events
        for to, hello in self.overlay.tick(now):
            effects.append(self._datagram(to, HELLO + hello))
        self._follow_overlay(now)
        if self._waiting and self._told is not None and not self.hold:
            happened, self._waiting = self._waiting, []
            effects += self._agree(happened, now)
        if len(self._waiting) > MOST_WAITING:
            old, self._waiting = self._waiting[:-MOST_WAITING], self._waiting[-MOST_WAITING:]
            self._waiting[:0] = [
                event for event in old if isinstance(event, TreeChanged | CertificatesRevoked)
            ]
        return effects + self._poll(now)

    def leave(self, now: float) -> list[Datagram]:
        """Return the goodbyes to send; the robot is on nobody's tree from then on."""
        return [self._datagram(to, HELLO + goodbye) for to, goodbye in self.overlay.leave(now)]

    # -- hearing -------------------------------------------------------------------------------------

    def _take(self, sender: int, kind: bytes, data: bytes, now: float) -> list[Event]:
        if kind == PACKET:
            link = self._links.get(sender)
            return [] if link is None else [Message(sender, payload) for payload in link.hear(data, now)]
        if kind == BEACON:
            return [Message(sender, data)]
        raise ValueError(f"datagram of unknown kind {kind!r}")

    def _follow_overlay(self, now: float) -> None:
        """Open links to new neighbours on the tree, close the others, and tell the agent of its new place."""
        place = self.overlay.place
        for k in self._sessions.keys() - set(place.neighbours):
            self._links.pop(k).close()
            del self._sessions[k]
        for k in place.neighbours:
            session = self.overlay.boot_of(k), place.epoch
            if self._sessions.get(k) != session:
                link = self._links.setdefault(k, ReliableLink(self.agent.boot, 2 * self._lease))
                link.open(*session, now)
                self._sessions[k] = session
        if place != self._found:
            self._found, self._settled = place, now + SETTLED
        if place != self._told and (self._told or now >= self._begin_at):
            tree = TreeChanged(place.epoch, place.parent, place.neighbours, place.size, place.distance)
            # What came before the first tree, came from neighbours on it.
            self._waiting.insert(len(self._waiting) if self._told else 0, tree)
            self._told = place

    @property
    def _begin_at(self) -> float:
        """Return when to tell the agent its first place [s]: it would map mates that it does not know of."""
        return min(self._settled, self._alone_until) if self.overlay.place.neighbours else self._alone_until

    # -- speaking ------------------------------------------------------------------------------------

    def _agree(self, events: Iterable[Event], now: float) -> list[Output]:
        """Run the agent, and give its messages to the links."""
        effects: list[Output] = []
        for effect in step(self.agent, events, self._mission_time(now)):
            if isinstance(effect, Shun):
                self.overlay.shun(effect.robot, now)
                continue
            effects += self._say(effect, now) if isinstance(effect, Send) else [effect]
        return effects

    def _say(self, send: Send, now: float) -> list[Output]:
        """Give a message to its link; return what goes as a datagram of its own."""
        if send.to not in self._links:  # no longer a neighbour; the agent is yet to be told
            return []
        self.messages_sent[send.traffic] += 1
        self.bytes_sent[send.traffic] += len(send.payload)
        if send.traffic is TrafficKind.BEACONS:  # the next one is worth more than this one again
            return [self._datagram(send.to, BEACON + send.payload, len(send.payload))]
        self._links[send.to].send(send.payload, now)
        return []

    def _poll(self, now: float) -> list[Output]:
        datagrams: list[Output] = []
        for to, link in self._links.items():
            carried = link.carried
            packets = link.poll(now)
            datagrams += [self._datagram(to, PACKET + packet) for packet in packets]
            self.bytes_sent[TrafficKind.OVERLAY] -= link.carried - carried
            if link.lost:  # though hellos come: where they do not, the lease is sooner over
                self.overlay.shun(to, now)
        return datagrams

    def _datagram(self, to: int, payload: bytes, carried: int = 0) -> Datagram:
        """Count what a datagram adds to the messages that it carries."""
        self.bytes_sent[TrafficKind.OVERLAY] += len(payload) - carried
        self.messages_sent[TrafficKind.OVERLAY] += 1
        return Datagram(to, payload)
