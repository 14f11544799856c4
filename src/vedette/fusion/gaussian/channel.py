"""The classic channel filter on a tree, for static and moving targets, in a loss-proof form."""

from __future__ import annotations

from collections.abc import Sequence

from vedette.fusion.gaussian.edge import TrackEdge
from vedette.fusion.gaussian.exchange import TrackExchange
from vedette.fusion.gaussian.information import Information, TrackMotion
from vedette.fusion.gaussian.intersection import intersect
from vedette.fusion.gaussian.wire import TrackMessage, decode, encode
from vedette.fusion.link import RESEND_AFTER

GENERATION_BITS = 24
_CYCLE = (1 << GENERATION_BITS) - 1  # generations 1.._CYCLE, then from 1 again


class GaussianChannel(TrackExchange[TrackEdge]):
    """``Y_i <- Y_i + (Y_j - Y_ij)``, ``Y_ij <- Y_j`` on hearing j: what j says beyond what both know is new.

    Node and channels are predicted with the same F and Q at the same steps. What crosses an edge are whole
    tracks with a number, and each side keeps ``Y_ij`` for every number that the other may have taken in; so
    loss, repetition and reordering neither lose information nor count any twice. Memory is O(neighbours).

    Exact for static targets (F = I, Q = 0) whatever the delay, and for moving ones if all information of a
    step has crossed the tree before the next prediction. What crosses later has passed through the same
    process noise as what it meets, which subtraction ignores: tracks are then a little overconfident.

    The neighbours must form a tree: on a cycle information comes back as if it were new. When the tree
    changes or a robot restarts, nobody knows any more what two neighbours have in common. So a new
    **generation** begins: word of it spreads over the tree, all robots' tracks are merged once by covariance
    intersection, from the leaves inwards, and the result goes outwards; from there on channels are exact
    again. What all robots knew is kept whole; of what only some knew, a part. Nothing is counted twice.
    Generations are numbered in a circle, 0 excepted, which comes before all: so no neighbour can use them up.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        prior: Information,
        motion: TrackMotion,
        start: int,
        *,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """``prior`` are the tracks at step ``start``, ahead of its evidence; the same for every robot.

        ``boot < 2**38`` must differ from those of the robot's earlier starts.
        """
        super().__init__(robot, boot, prior, motion, start, resend_after=resend_after)
        self.generation = 0
        self._origin: Information | None = prior  # the prior, predicted; None once there is a new generation
        self._settled = True  # the merging at the generation's start has come to this robot
        self._untouched = True  # has neither told nor taken in any tracks

    @property
    def _next(self) -> int:
        return self.generation % _CYCLE + 1

    @property
    def _nonce(self) -> int:
        return (self._boot << GENERATION_BITS) + self.generation

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Take these as the neighbours on the tree; begin a new generation if tracks have been exchanged."""
        if set(neighbours) == self._edges.keys():
            return
        self._edges = {neighbour: TrackEdge() for neighbour in neighbours}
        self._renew(self.generation if self._untouched else self._next)

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return tracks that are news to the neighbour or got lost, or a bare acknowledgement; else None."""
        edge = self._edges[neighbour]
        overdue = edge.is_overdue(now, self._resend_after)
        greets = edge.peer < 0 and now - edge.greeted_at >= self._resend_after
        tells = edge.news and edge.has_room and self._may_tell(edge)
        if not (tells or overdue or greets or edge.owed):
            return None
        if tells:
            edge.tell(self._node, now)
            self._untouched = False
        elif overdue:
            edge.sent_at = now
        edge.owed = False
        edge.greeted_at = now
        included, step, data = edge.latest
        data = data if tells or overdue else b""
        return encode(TrackMessage(self._nonce, edge.peer, edge.sent, edge.heard, included, step, data))

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Take in what a neighbour tells (ValueError if malformed, and nothing changes).

        A payload from a robot that is no neighbour, or from its past, is ignored.
        """
        message = decode(payload)
        boot, generation = divmod(message.nonce, 1 << GENERATION_BITS)
        theirs = self._node.decoded(message) if message.data else None
        if neighbour not in self._edges or self._boots.is_stale(neighbour, boot):
            return
        if _is_later(self.generation, generation):
            self._edges[neighbour].owed = True  # so that it learns of the new one
            return
        if _is_later(generation, self.generation):
            self._renew(generation)
        elif self._edges[neighbour].peer not in (-1, message.nonce):
            self._renew(self._next)  # it has restarted, and may have passed on what others know
        if generation == self.generation:
            self._hear(neighbour, self._edges[neighbour], message, theirs)

    def _hear(
        self, neighbour: int, edge: TrackEdge, message: TrackMessage, theirs: Information | None
    ) -> None:
        edge.peer = message.nonce
        is_answer = message.echo == self._nonce
        if is_answer:
            edge.acknowledge(message.heard)
        if theirs is not None and (is_answer or message.echo < 0):
            edge.owed = True
            self._take(neighbour, edge, message, theirs)
        if is_answer:
            edge.release(message)

    def _predict(self) -> None:
        """Predict node and channels."""
        super()._predict()
        if self._origin is not None:
            self._origin = self._node.forward(self._origin)
        for edge in self._edges.values():
            edge.common = {n: self._node.forward(track) for n, track in edge.common.items()}

    def _merge(self, neighbour: int, edge: TrackEdge, message: TrackMessage, theirs: Information) -> None:
        """Take in a neighbour's tracks: their news if we know what is common, all of an offer if we may."""
        included = message.included if message.echo >= 0 else 0
        if included in edge.common:
            merged = self._node.track + theirs - edge.common[included]
            common = edge.learnt(theirs, included)
            if not all(map(self._node.can_keep, (merged, *common.values()))):
                return  # no honest neighbour forgets what both know
            edge.common, self._node.track = common, merged
            edge.news |= not self._settled and included < edge.sent  # offers after the one that was merged
            self._settled = True
        elif included == 0 and self._may_take(neighbour, edge):
            merged = intersect(self._node.track, theirs)
            if not self._node.can_keep(merged):
                return
            self._node.track = merged
            edge.take()
            edge.news = True
            self._settled = all(other.taken for other in self._edges.values())
        else:
            return
        edge.heard = message.sent
        self._untouched = False
        self._spread(edge)

    # -- a generation's start: offers go inwards, the merged tracks outwards ------------------------------

    def _renew(self, generation: int) -> None:
        """Begin a generation with nothing known to be common (the first one: nothing but the prior)."""
        if generation > 0:
            self._origin, self._untouched = None, False
        self.generation = generation
        self._settled = generation == 0 or not self._edges
        common = {} if self._origin is None else {0: self._origin}
        self._edges = {neighbour: TrackEdge(common=dict(common)) for neighbour in self._edges}

    def _may_tell(self, edge: TrackEdge) -> bool:
        """Once settled; before that, an offer, when all other neighbours' offers are merged."""
        if self._settled:
            return True
        others = all(other.taken for other in self._edges.values() if other is not edge)
        return others and not edge.taken and edge.acknowledged == 0

    def _may_take(self, neighbour: int, edge: TrackEdge) -> bool:
        """Take one offer of each neighbour; where two offers cross, the robot of higher number takes."""
        return not self._settled and not edge.taken and (edge.sent == 0 or self._robot > neighbour)


def _is_later(generation: int, than: int) -> bool:
    """Tell whether one generation comes after another: by the shorter way round the circle."""
    if generation == 0 or than == 0:
        return generation > than
    return 0 < (generation - than) % _CYCLE <= _CYCLE // 2
