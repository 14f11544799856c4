"""The overlay: a spanning tree over whatever links exist, kept up by hellos between neighbours."""

from __future__ import annotations

from collections.abc import Iterable

from vedette.overlay import hello as wire
from vedette.overlay.hello import BYE, PARENT, TICKS, TWICE, Hello, OtherVersion
from vedette.overlay.peer import Peer
from vedette.overlay.position import TreePosition
from vedette.overlay.stamp import BOOT_BITS, ROBOT_BITS
from vedette.overlay.status import LinkStatus, Place, Status

MOST_PEERS = 1024  # in a robot's life
RECOUNT = 0.05  # a change of the team's size is passed on within [s]
TOLD_AT_ONCE = 8  # neighbours told of a new tree before the others, lest one robot gets all for children
SHORTEST = 0.001  # sleep [s]
LATER = 0.1  # when the others are [s]


class Overlay:
    """One robot's part in forming, keeping and repairing the team's tree; no I/O, no clock, no randomness.

    Call ``tick`` when ``wake`` has come: it does what ``hear`` and the others have given cause for, and what
    time asks for. ``place`` is what it was at the latest tick. ``now`` is a clock that never goes back [s].
    """

    def __init__(self, robot: int, boot: int, now: float, lease: float = 3.0, terms: int = 0) -> None:
        """Start alone.

        ``boot < 2**38`` must be above those of the robot's earlier lives; ``terms < 2**63``: a fingerprint of
        what the team has to agree on, without which no link is used.
        """
        if not 0 <= robot < 1 << ROBOT_BITS:
            raise ValueError(f"robot must lie in 0..{(1 << ROBOT_BITS) - 1}; got {robot}")
        if not 0 <= boot < 1 << BOOT_BITS:
            raise ValueError(f"boot must lie in 0..2**{BOOT_BITS} - 1; got {boot}")
        if not lease > 0:
            raise ValueError(f"lease must be > 0 s; got {lease}")
        self.robot, self.boot, self.lease = robot, boot, lease
        self.terms = terms
        self.complaints: dict[int, str] = {}  # of neighbours, and of this robot's own number; the latest
        self.wake = now  # when ``tick`` next has something to do [s]
        self._now = now
        self._silent = False  # for good
        self._peers: dict[int, Peer] = {}
        self._position = TreePosition(robot, boot, self._peers, now)
        self.place = Place(self._position.stamp.name, None, (), 1)
        self._own_size = 1  # of this robot's part of the tree
        self._to_root = 0.0  # the root's clock minus ours [s]

    # -- what happens --------------------------------------------------------------------------------

    def peers(self, robots: Iterable[int], now: float) -> None:
        """Take these as the robots that the transport can send to; hellos from others are ignored.

        Raises:
            ValueError: too many in a robot's life; nothing changes.
        """
        wanted = set(robots) - {self.robot}
        if len(wanted | self._peers.keys()) > MOST_PEERS:
            raise ValueError(f"overlay: more than {MOST_PEERS} neighbours in the life of robot {self.robot}")
        now = self._pass(now)
        for robot in sorted(wanted - self._peers.keys()):
            self._peers[robot] = Peer(robot, self.lease, self.terms, due=now)
        for robot, peer in self._peers.items():
            if robot in wanted and not peer.reachable:
                peer.tell(now)
            peer.reachable = robot in wanted
        self.wake = now

    def hear(self, robot: int, payload: bytes, now: float) -> None:
        """Take in a neighbour's hello.

        Raises:
            ValueError: malformed; nothing changes.
        """
        hello = self._decode(robot, payload)
        peer = self._peers.get(robot)
        if peer is None or not peer.reachable or self._silent:
            return
        self._check(peer, hello)
        now = self._pass(now)
        peer.refuse_the_younger(hello, self.boot, now)
        if peer.is_double(now):
            self.complaints[robot] = "two processes have this number; the one started later is refused"
        if hello.flags & TWICE:
            self._told_of_another(hello)
        if not peer.is_news(hello, now):
            return
        if hello.boot == peer.boot and hello.stamp < peer.stamp:
            self.shun(peer.robot, now)
            self.complaints[peer.robot] = "it has gone back to a tree that it had left, as nobody does"
        peer.take(hello, self.boot, now)
        self.wake = now

    def alive(self, robot: int, now: float) -> None:
        """Note other traffic that can only come from a neighbour's present life: it is not silent."""
        now = self._pass(now)
        peer = self._peers.get(robot)
        if peer is not None and peer.up:
            peer.heard = now

    def lost(self, robot: int, now: float) -> None:
        """Note that the link to a neighbour has failed: cut it without waiting for the lease to run out."""
        now = self._pass(now)
        if robot in self._peers:
            self._peers[robot].forget()
            self.wake = now

    def shun(self, robot: int, now: float) -> None:
        """Do without the link to a neighbour for a while, longer each time: it is as good as dead."""
        now = self._pass(now)
        if robot in self._peers:
            self._peers[robot].shun(now)
            self.complaints[robot] = "no round gets anywhere by it; its link is left alone for a while"
            self.wake = now

    def leave(self, now: float) -> list[tuple[int, bytes]]:
        """Return the goodbyes to send; say nothing from then on."""
        now = self._pass(now)
        heard = [peer for peer in self._peers.values() if peer.reachable and peer.hello]
        goodbyes = [] if self._silent else [(peer.robot, self._hello(peer, now, BYE)) for peer in heard]
        self._fall_silent(now)
        return goodbyes

    def tick(self, now: float) -> list[tuple[int, bytes]]:
        """Do what time asks for; return the hellos to send, each with its receiver."""
        now = self._pass(now)
        if now < self.wake or self._silent:
            return []
        self._settle(now)
        due = [peer for peer in self._peers.values() if peer.reachable and peer.due <= now]
        hellos = [(peer.robot, self._hello(peer, now)) for peer in due]
        times = [peer.wake(now) for peer in self._peers.values()]
        # Never so late that it would look like not having run.
        self.wake = max(min([*times, self._position.wake(now), now + self.lease / 4]), now + SHORTEST)
        return hellos

    def boot_of(self, robot: int) -> int:
        """Return a neighbour's present boot; -1 if it has not been heard."""
        return self._peers[robot].boot if robot in self._peers else -1

    def status(self, now: float) -> Status:
        """Return everything for people to see."""
        at = self._position
        links = tuple(self._link_status(peer, now) for _, peer in sorted(self._peers.items()))
        age = max(now - at.since, 0.0)
        return Status(at.stamp.root, at.stamp.epoch, at.distance, self.place, age, self._to_root, links)

    # -- what cannot be ------------------------------------------------------------------------------

    def _decode(self, robot: int, payload: bytes) -> Hello:
        try:
            return wire.decode(robot, payload)
        except OtherVersion as error:
            self.complaints[robot] = f"it speaks another version of the protocol ({error}); update the older"
            raise

    def _check(self, peer: Peer, hello: Hello) -> None:
        """Raise ValueError for what no honest neighbour says; it makes nobody silent but who says it."""
        if hello.echo and hello.echo.boot == self.boot and hello.echo.sequence > peer.sent:
            self.complaints[peer.robot] = f"it has heard more of boot {self.boot} than this robot has said"
            raise ValueError(f"hello: robot {peer.robot} {self.complaints[peer.robot]}")
        if not self._position.stamp.may_follow(hello.epoch):
            self.complaints[peer.robot] = f"its epoch, {hello.epoch}, is far beyond any that there can be"
            raise ValueError(f"hello: robot {peer.robot}: {self.complaints[peer.robot]}")

    def _told_of_another(self, hello: Hello) -> None:
        """Note that a neighbour hears two processes of this robot's number."""
        refused = hello.echo is None or hello.echo.boot != self.boot
        mine = "this one is refused" if refused else "the other, started later, is refused"
        self.complaints[self.robot] = f"two processes have this number, as a neighbour hears: {mine}"

    # -- how it is taken in --------------------------------------------------------------------------

    def _pass(self, now: float) -> float:
        """Let time pass. If this robot did not run for long, its neighbours' silence proves nothing."""
        now = max(now, self._now)
        gap = now - self._now
        if gap > self.lease / 2:
            for peer in self._peers.values():
                peer.heard += gap
        self._now = now
        return now

    def _settle(self, now: float) -> None:
        for peer in self._peers.values():
            was_up = peer.up
            peer.judge(self.boot, now)
            if peer.up and not was_up:
                self.complaints.pop(peer.robot, None)
        before = self._position.stamp
        self._position.settle(self.place.size, now)
        if self._position.stamp != before:
            self._announce(now)
        self._count(now)

    def _announce(self, now: float) -> None:
        """Tell everybody of the new tree, the parent first."""
        parent, all_robots = self._position.parent, 1 << ROBOT_BITS
        order = sorted(
            self._peers.values(), key=lambda p: (p.robot != parent, (p.robot - self.robot) % all_robots)
        )
        for rank, peer in enumerate(order):
            peer.tell(now if rank < TOLD_AT_ONCE else now + LATER)

    def _count(self, now: float) -> None:
        """Count the team, read the root's clock, and pass the count on."""
        at = self._position
        children = [self._peers[k] for k in at.children]
        parts = (peer.hello.size for peer in children if peer.hello and peer.stamp == at.stamp)
        own = min(1 + sum(parts), 1 << ROBOT_BITS)
        size, self._to_root = own, 0.0
        if at.parent is not None:
            parent = self._peers[at.parent]
            assert parent.hello
            size = max(own, parent.hello.size if parent.stamp == at.stamp else self.place.size)
            self._to_root = parent.hello.to_root / TICKS + (parent.clock.offset or 0.0)
        place = Place(at.stamp.name, at.parent, tuple(at.edges), size, at.distance)
        if (place, own) == (self.place, self._own_size):
            return
        self.place, self._own_size = place, own
        for k in place.neighbours:
            self._peers[k].due = min(self._peers[k].due, now + RECOUNT)

    def _fall_silent(self, now: float) -> None:
        """Say nothing any more, and be on nobody's tree."""
        self._silent, self.wake = True, float("inf")
        self._position.go_alone(now)
        self.place = Place(self._position.stamp.name, None, (), 1)

    # -- what is told ----------------------------------------------------------------------------------

    def _hello(self, peer: Peer, now: float, flags: int = 0) -> bytes:
        sequence, link_flags, echo = peer.next_hello(self.boot, now)
        at = self._position
        is_parent = peer.robot == at.parent
        return wire.encode(
            Hello(
                self.boot,
                sequence,
                round(now * TICKS),
                *at.stamp,
                at.distance,
                flags | link_flags | (PARENT if is_parent else 0),
                self._own_size if is_parent else self.place.size,
                round(100 * peer.loss),
                round(self._to_root * TICKS),
                self.terms,
                echo,
            )
        )

    def _link_status(self, peer: Peer, now: float) -> LinkStatus:
        role = "other" if peer.usable else "left" if peer.said_goodbye else "down"
        if peer.robot in self.place.neighbours:
            role = "parent" if peer.robot == self.place.parent else "child"
        silent = None if peer.hello is None else max(now - peer.greeted, 0.0)
        return LinkStatus(peer.robot, role, peer.loss, peer.clock.offset, peer.clock.round_trip, silent)
