"""Covariance intersection: fusing tracks whose common information nobody knows, on any graph."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vedette.fusion.gaussian.edge import Contact
from vedette.fusion.gaussian.exchange import TrackExchange
from vedette.fusion.gaussian.information import Floats, Information, log_det
from vedette.fusion.gaussian.wire import TrackMessage, decode, encode

NEWS = 1e-6  # [nats] gained by a merge, from which it is passed on
_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
_CUTS = 40  # golden sections: the weight to 1e-8


def intersect(a: Information, b: Information) -> Information:
    """``Y = w Y_a + (1 - w) Y_b``, ``y`` alike, each target's w in [0, 1] maximising ``log det Y``.

    Consistent whatever a and b have in common, if both are. Where one is at least as large as the other in
    every direction, the result is exactly that one. Both must be positive definite.
    """
    weight = best_weight(a.matrix, b.matrix)
    matrix = weight[:, None, None] * a.matrix + (1.0 - weight)[:, None, None] * b.matrix
    vector = weight[:, None] * a.vector + (1.0 - weight)[:, None] * b.vector
    return Information(matrix, vector)


def best_weight(a: Floats, b: Floats) -> Floats:
    """Return ``(T,)`` weights w in [0, 1] of a that maximise ``log det(w a + (1 - w) b)``, concave in w.

    Golden section on ``sum_i log(w + (1 - w) e_i)``, e_i the eigenvalues of b relative to a. The ends are
    taken exactly where the slope there points outwards; of equals, a.
    """
    factor = np.linalg.inv(np.linalg.cholesky(a))
    relative = np.linalg.eigvalsh(factor @ b @ factor.swapaxes(1, 2)).astype(np.float64)  # (T, d)
    low, high = np.zeros(len(a)), np.ones(len(a))
    for _ in range(_CUTS):
        left = high - _GOLDEN * (high - low)
        right = low + _GOLDEN * (high - low)
        better_left = _gain(relative, left) > _gain(relative, right)
        high, low = np.where(better_left, right, high), np.where(better_left, low, left)
    weight = 0.5 * (low + high)
    weight = np.where((1.0 - 1.0 / relative).sum(axis=1) >= -1e-12, 0.0, weight)
    result: Floats = np.where((1.0 - relative).sum(axis=1) >= -1e-12, 1.0, weight)
    return result


def _gain(relative: Floats, weight: Floats) -> Floats:
    result: Floats = np.log(weight[:, None] + (1.0 - weight[:, None]) * relative).sum(axis=1)
    return result


class IntersectionFusion(TrackExchange[Contact]):
    """Every robot tells its tracks, and merges what it hears by covariance intersection.

    Consistent on any graph, cycles and changes included, without any book-keeping of who knows what: loss,
    repetition and reordering do no harm. The price: independent information is not added up, so the team
    knows far less than the exact ways; and robots agree only nearly, so that rounds are approximate.
    """

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        self._edges = {n: self._edges.get(n) or Contact() for n in neighbours}

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return the tracks if they are news to the neighbour or got lost; None if there is nothing."""
        edge = self._edges[neighbour]
        overdue = edge.is_overdue(now, self._resend_after)
        if not (edge.news or overdue or edge.owed):
            return None
        data = b""
        if edge.news or overdue:
            edge.sent += 1
            edge.sent_at = now
            data = self._node.encoded()
        edge.news = edge.owed = False
        return encode(TrackMessage(self._boot, edge.peer, edge.sent, edge.heard, 0, self._node.step, data))

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a neighbour's tracks (ValueError if malformed, and nothing changes).

        A payload from a robot that is no neighbour, or from its past, is ignored.
        """
        message = decode(payload)
        theirs = self._node.decoded(message) if message.data else None
        edge = self._edges.get(neighbour)
        if edge is None or self._boots.is_stale(neighbour, message.nonce):
            return
        if edge.peer != message.nonce:
            edge.peer, edge.heard, edge.news, edge.early = message.nonce, 0, True, None
        if message.echo == self._boot:
            edge.acknowledge(message.heard)
        if theirs is not None:
            edge.owed = True
            self._take(neighbour, edge, message, theirs)

    def _merge(self, neighbour: int, edge: Contact, message: TrackMessage, theirs: Information) -> None:
        edge.heard = message.sent
        before = self._node.track
        merged = intersect(before, theirs)
        gains = (log_det(merged.matrix) - log_det(before.matrix) > NEWS).any()
        if gains and self._node.can_keep(merged):
            self._node.track = merged
            self._spread(edge)
        if (log_det(self._node.track.matrix) - log_det(theirs.matrix) > NEWS).any():
            edge.news = True
