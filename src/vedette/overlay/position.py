"""One robot's position on the tree: which tree, at what distance from its root, by which neighbours.

The highest stamp wins. It spreads from its root as a wave; each robot takes as its parent the best neighbour
that the wave reaches it by, and keeps that parent and its own distance for as long as it keeps the stamp.
Within a stamp, therefore, every edge leads to a smaller distance and none is ever exchanged for another:
edges of one stamp never form a cycle, not even those of different moments taken together. Whoever loses
an edge starts a tree with a higher stamp at once; a robot that has no edge left goes alone. A neighbour that
was shunned comes back to the tree of the others, and does not become their root: they outdo the tree that it
has started.
"""

from __future__ import annotations

from collections.abc import Mapping

from vedette.overlay.hello import MOST_DISTANCE, PARENT
from vedette.overlay.peer import Peer
from vedette.overlay.stamp import Stamp

GRACE = 0.2  # for which a robot alone waits to be taken in, before it starts a tree itself [s]
IDLE = 2.0  # a robot alone that starts no tree within so long is not waited for [s]
ANOTHER_WAY = 0.3  # than by a neighbour that was shunned is waited for [s]
MUCH_BETTER = 3  # hops saved that are worth a new tree
UNEASE, MOST_UNEASE = 30.0, 480.0  # if they have been there to save for so long, doubling [s]


def patience(cost: int) -> float:
    """Return how long a robot waits for a better way to the root than one over a link of this cost [s]."""
    return 0.02 * cost * cost


class TreePosition:
    """A robot's stamp, distance, parent and children, brought in line with what is known of its peers."""

    def __init__(self, robot: int, boot: int, peers: Mapping[int, Peer], now: float) -> None:
        """Start alone."""
        self._robot, self._boot, self._peers = robot, boot, peers
        self._unease, self._uneasy_since = UNEASE, float("inf")
        self._take(Stamp(1, robot, boot), now)

    def settle(self, size: int, now: float) -> None:
        """Leave a tree that has lost an edge, go over to a higher one, or start one where that is due.

        ``size``: robots on this robot's tree.
        """
        self.children.update(k for k, peer in self._peers.items() if self._is_child(peer))
        if (rival := self._rival(size, now)) is not None:
            self._outdo(rival, now)
        offer = self._best_offer(now)
        edges = self.edges
        whole = [k for k in edges if self._holds(self._peers[k])]
        if len(whole) < len(edges):
            self._repair(offer, alone=not whole, now=now)
        elif offer is not None and now >= self._ripe(offer, now):
            self._adopt(offer, now)
        elif self._must_start(now) or self._is_uneasy(now):
            self._start(now)

    def go_alone(self, now: float) -> None:
        """Leave the tree."""
        self._take(self.stamp.next_alone(self._robot, self._boot), now)

    def wake(self, now: float) -> float:
        """Return when time alone will next change something here [s]."""
        times = [self._uneasy_since + self._unease]
        if (offer := self._best_offer(now)) is not None:
            times.append(self._ripe(offer, now))
        if self.stamp.is_alone and now < self.since + GRACE:
            times.append(self.since + GRACE)
        return min(times)

    @property
    def edges(self) -> list[int]:
        """The neighbours on the tree, ascending."""
        return sorted(self.children if self.parent is None else {*self.children, self.parent})

    # -- edges -------------------------------------------------------------------------------------

    def _is_child(self, peer: Peer) -> bool:
        hello = peer.hello
        if hello is None or not hello.flags & PARENT or hello.distance <= self.distance:
            return False
        return peer.usable and peer.stamp == self.stamp

    def _holds(self, peer: Peer) -> bool:
        """Tell whether an edge is whole; one to a neighbour on a higher tree is, until we follow it there."""
        return peer.usable and (peer.stamp == self.stamp or self._is_offer(peer))

    def _repair(self, offer: Peer | None, alone: bool, now: float) -> None:
        if offer is not None:
            self._adopt(offer, now)
        elif alone:
            self.go_alone(now)
        else:
            self._start(now)

    # -- going over to a higher tree -----------------------------------------------------------------

    def _is_offer(self, peer: Peer) -> bool:
        """Tell whether a neighbour is on a tree to go over to; one of our own past is no such tree."""
        if peer.stamp <= self.stamp or not peer.usable or peer.stamp.is_alone:
            return False
        return peer.stamp.root != self._robot and _distance_by(peer) <= MOST_DISTANCE

    def _best_offer(self, now: float) -> Peer | None:
        offers = [peer for peer in self._peers.values() if self._is_offer(peer)]
        if not offers:
            return None
        highest = max(peer.stamp for peer in offers)
        on_it = (peer for peer in offers if peer.stamp == highest)
        return min(
            on_it,
            key=lambda peer: (
                peer.is_doubted(now),
                _distance_by(peer),
                peer.robot != self.parent,
                peer.robot,
            ),
        )

    def _ripe(self, offer: Peer, now: float) -> float:
        """Return until when to wait for a better way to its root than by who offers it [s]."""
        return offer.since + patience(offer.cost) + (ANOTHER_WAY if offer.is_doubted(now) else 0.0)

    def _adopt(self, offer: Peer, now: float) -> None:
        self._take(offer.stamp, now, offer.robot, _distance_by(offer))

    # -- starting a tree -----------------------------------------------------------------------------

    def _rival(self, size: int, now: float) -> Peer | None:
        """Return who offers a higher tree, no larger than ours, that a shunned neighbour has started.

        Once for each time that its link comes up: two robots that have shunned each other will agree.
        """
        for peer in filter(self._is_offer, self._peers.values()):
            root = self._peers.get(peer.stamp.root)
            if root is None or root.outdone or not root.is_doubted(now):
                continue
            if peer.hello is not None and 1 < size >= peer.hello.size:
                return peer
        return None

    def _outdo(self, rival: Peer, now: float) -> None:
        """Start a tree that ranks above another."""
        self._peers[rival.stamp.root].outdone = True
        self._take(rival.stamp.next_tree(self._robot, self._boot), now)

    def _must_start(self, now: float) -> bool:
        """Tell whether this robot, alone, has to start a tree: nobody within its reach ranks above it.

        Or who does has left it at that for long, though it would have had to start one.
        """
        if not self.stamp.is_alone or now < self.since + GRACE:
            return False
        usable = [peer for peer in self._peers.values() if peer.usable]
        above = [each for each in usable if each.stamp > self.stamp]
        return bool(usable) and all(each.stamp.is_alone and now >= each.since + IDLE for each in above)

    def _is_uneasy(self, now: float) -> bool:
        """Tell whether a much better way to the root has been there for long."""
        if self.parent is None:
            return False
        mates = (peer for peer in self._peers.values() if peer.usable and peer.stamp == self.stamp)
        best = min(map(_distance_by, mates), default=MOST_DISTANCE)
        if best + MUCH_BETTER > _distance_by(self._peers[self.parent]):
            self._uneasy_since = float("inf")
        else:
            self._uneasy_since = min(self._uneasy_since, now)
        if now < self._uneasy_since + self._unease:
            return False
        self._unease = min(2 * self._unease, MOST_UNEASE)
        return True

    def _start(self, now: float) -> None:
        self._take(self.stamp.next_tree(self._robot, self._boot), now)

    def _take(self, stamp: Stamp, now: float, parent: int | None = None, distance: int = 0) -> None:
        self.stamp, self.since = stamp, now
        self.parent, self.distance = parent, distance
        self.children: set[int] = set()
        self._uneasy_since = float("inf")


def _distance_by(peer: Peer) -> int:
    """Return the distance to the root over a neighbour."""
    return peer.cost + (peer.hello.distance if peer.hello else MOST_DISTANCE)
