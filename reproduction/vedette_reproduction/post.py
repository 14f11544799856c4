"""A negotiation with every message kept: who told whom what, how long it was, and what each computed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.negotiation import (
    Chooser,
    Negotiator,
    Outgoing,
    RoundOutcome,
    TokenNode,
    Tree,
    messages,
    node_of,
)
from vedette.negotiation.messages import Message
from vedette.negotiation.multistart import MultistartNode
from vedette.problem import Invertible, Objective

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Letter:
    """A message as it was sent."""

    sender: int
    receiver: int
    message: Message[Any]
    bytes: int

    @property
    def kind(self) -> str:
        """``Up``, ``Down``, ``Gather``, ``Token`` or ``Stop``."""
        return type(self.message).__name__

    @property
    def impact(self) -> Any:
        """What it says about the impact of the sender's side; ``None``: nothing, or nothing new."""
        return getattr(self.message, "mu", None)


@dataclass(frozen=True, eq=False)
class Recording:
    """One round."""

    letters: tuple[Letter, ...]  # in the order in which they were sent
    choice: tuple[int | None, ...]
    outcome: RoundOutcome
    replies: tuple[tuple[int, ...], ...]  # each platform's candidate after each of its replies
    combinations: NDArray[np.int64]  # (n,) applications of ``*`` by each platform
    seconds: Float  # (n,) CPU time of each platform
    values: tuple[float, ...]  # of the team, as the root finds them; none with ``token``

    def sent(self, n: int) -> NDArray[np.int64]:
        """Count the messages that each of n platforms sent."""
        return np.bincount([letter.sender for letter in self.letters], minlength=n)


class Seat(Chooser[Any, Any]):
    """A chooser that counts what it computes."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        """As a chooser."""
        super().__init__(*args, **kwargs)
        self.replies: list[int] = []
        self.combinations = 0

    def reply(self, others: Any) -> bool:
        """Reply, and note what with."""
        changed = super().reply(others)
        assert self.index is not None
        self.replies.append(self.index)
        return changed

    def combine(self, a: Any, b: Any) -> Any:
        """``a * b``, counted."""
        self.combinations += 1
        return super().combine(a, b)


class SparseCodec:
    """Miss probabilities as bytes: twelve for each cell that is touched, none for the others."""

    def __init__(self, cells: int) -> None:
        """Take the number of cells."""
        self._cells = cells

    def encode(self, impact: Float) -> bytes:
        """Return the touched cells' numbers and their miss probabilities."""
        touched = np.flatnonzero(impact != 1.0)
        return bytes(touched.astype("<u4").tobytes() + impact[touched].astype("<f8").tobytes())

    def decode(self, data: bytes) -> Float:
        """Return the impact."""
        count = len(data) // 12
        impact = np.ones(self._cells)
        impact[np.frombuffer(data, "<u4", count)] = np.frombuffer(data, "<f8", count, 4 * count)
        return impact


def record(
    objective: Objective[Any, Any],
    beliefs: Sequence[Any],
    candidates: Sequence[Sequence[Any]],
    tree: Tree,
    scheme: str,
    *,
    start: Sequence[int] | None = None,
    inverse: bool = False,
    root: int = 0,
    max_sweeps: int = 50,
    codec: Any = None,
    shuffle: np.random.Generator | None = None,
) -> Recording:
    """Run a round and keep its messages.

    Args:
        objective: the team's ``*`` and ``psi``.
        beliefs: one for all, or each platform's own.
        candidates: each platform's impacts.
        tree: who talks to whom.
        scheme: one of the ``SCHEMES``.
        start: everybody's first candidate.
        inverse: with ``jacobi``, send the team's impact down the tree (paper, eq. (31)).
        root: where the way up ends.
        max_sweeps: end the round after so many.
        codec: for the sizes of messages; without it they are plain arrays.
        shuffle: deliver messages of different links in an order drawn from it; a link keeps its order.
    """
    own = [beliefs[i] if len(beliefs) > 1 else beliefs[0] for i in range(tree.n)]
    seats = [
        Seat(objective, own[i], impacts, start=None if start is None else start[i])
        for i, impacts in enumerate(candidates)
    ]
    parents = tree.parents(root)
    remove = objective.remove if inverse and isinstance(objective, Invertible) else None
    nodes = [
        node_of(scheme, tree.neighbours(i), parents[i], seat, max_sweeps=max_sweeps, remove=remove)
        for i, seat in enumerate(seats)
    ]
    letters, seconds = _carry(nodes, codec, shuffle)
    first = nodes[root]
    outcome = first.finished
    assert outcome is not None
    return Recording(
        tuple(letters),
        tuple(seat.index for seat in seats),
        outcome,
        tuple(tuple(seat.replies) for seat in seats),
        np.array([seat.combinations for seat in seats]),
        seconds,
        () if isinstance(first, TokenNode | MultistartNode) else tuple(first.values),
    )


def _carry(
    nodes: Sequence[Negotiator[Any]], codec: Any, shuffle: np.random.Generator | None
) -> tuple[list[Letter], Float]:
    """Start all nodes, and carry letters until there are none."""
    letters: list[Letter] = []
    seconds = np.zeros(len(nodes))
    waiting: list[Letter] = []

    def post(sender: int, sends: Sequence[Outgoing[Any]]) -> None:
        for send in sends:
            data = messages.size(send.message) if codec is None else len(messages.encode(send.message, codec))
            letters.append(Letter(sender, send.to, send.message, data))
            waiting.append(letters[-1])

    for i, node in enumerate(nodes):
        began = time.thread_time()
        sends = node.start()
        seconds[i] += time.thread_time() - began
        post(i, sends)
    while waiting:
        letter = waiting.pop(_next(waiting, shuffle))
        began = time.thread_time()
        sends = nodes[letter.receiver].receive(letter.sender, letter.message)
        seconds[letter.receiver] += time.thread_time() - began
        post(letter.receiver, sends)
    return letters, seconds


def _next(waiting: Sequence[Letter], shuffle: np.random.Generator | None) -> int:
    """Return the place of the letter to deliver: the oldest, or the oldest of a link drawn at random."""
    if shuffle is None:
        return 0
    first: dict[tuple[int, int], int] = {}
    for place, letter in enumerate(waiting):
        first.setdefault((letter.sender, letter.receiver), place)
    return list(first.values())[int(shuffle.integers(len(first)))]
