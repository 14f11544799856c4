"""One negotiation with everything counted: who spends how much time, who sends how much to whom."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from bench.scale.team import Team
from vedette.negotiation import Chooser, Outgoing, RoundOutcome, TokenNode, Tree, messages
from vedette.negotiation.negotiate import tell_reaches
from vedette.problem.reach import Reach, behind

ROOT = 0


@dataclass(frozen=True, eq=False)
class Tally:
    """What each of n platforms did in one round of the token."""

    outcome: RoundOutcome
    turns: int  # taken by all together
    choice: tuple[int | None, ...]  # candidate of each platform
    seconds: NDArray[np.float64]  # (n,) CPU time, coding of messages included
    messages: NDArray[np.int64]  # (n,) sent
    bytes: NDArray[np.int64]  # (n,) sent
    edges: NDArray[np.int64]  # (2 (n - 1),) last impact that went over each link each way, as sent [bytes]


class Post:
    """Carries messages as bytes, oldest first, and keeps the books."""

    def __init__(self, team: Team, tree: Tree) -> None:
        self.seconds = np.zeros(tree.n)
        self.messages = np.zeros(tree.n, np.int64)
        self.bytes = np.zeros(tree.n, np.int64)
        self.edges: dict[tuple[int, int], int] = {}
        self._team = team
        self._waiting: deque[tuple[int, int, bytes]] = deque()  # sender, receiver, message

    def tell_reaches(self, tree: Tree) -> list[dict[int, Reach]]:
        """Let everybody hear of the reach behind each link, two messages a link."""
        reaches = self._team.reaches
        heard, _, _ = tell_reaches(tree, tree.parents(ROOT), reaches)
        for i in range(tree.n):
            began = time.thread_time()
            told = behind(reaches[i], heard[i])
            self.seconds[i] += time.thread_time() - began
            for there in told.values():
                self._count(i, len(msgspec.msgpack.encode(there)))
        return heard

    def deliver(self, nodes: list[TokenNode[Any]]) -> None:
        """Start all nodes and carry messages until there are none."""
        for i, node in enumerate(nodes):
            began = time.thread_time()
            self._send(i, node.start())
            self.seconds[i] += time.thread_time() - began
        while self._waiting:
            sender, receiver, data = self._waiting.popleft()
            began = time.thread_time()
            message = messages.decode(data, self._team.codec)
            self._send(receiver, nodes[receiver].receive(sender, message))
            self.seconds[receiver] += time.thread_time() - began

    def _send(self, sender: int, sends: list[Outgoing[Any]]) -> None:
        for send in sends:
            data = messages.encode(send.message, self._team.codec)
            self._waiting.append((sender, send.to, data))
            self._count(sender, len(data))
            if getattr(send.message, "mu", None) is not None:
                self.edges[sender, send.to] = len(data)

    def _count(self, sender: int, size: int) -> None:
        self.messages[sender] += 1
        self.bytes[sender] += size


def run_round(team: Team, tree: Tree, *, clipped: bool, max_sweeps: int) -> Tally:
    """Negotiate by the token from nobody on, with messages clipped to their receivers' reach or whole."""
    post = Post(team, tree)
    heard: list[dict[int, Reach]] = post.tell_reaches(tree) if clipped else [{} for _ in range(tree.n)]
    parents = tree.parents(ROOT)
    seats = [Chooser(team.objective, team.belief, own) for own in team.candidates]
    nodes = [
        TokenNode(tree.neighbours(i), parents[i], seat, max_sweeps=max_sweeps, reaches=heard[i])
        for i, seat in enumerate(seats)
    ]
    post.deliver(nodes)
    outcome = nodes[ROOT].finished
    assert outcome is not None  # max_sweeps ends every round
    return Tally(
        outcome,
        max(turn for node in nodes for turn, _ in node.turns),
        tuple(seat.index for seat in seats),
        post.seconds,
        post.messages,
        post.bytes,
        np.array(list(post.edges.values()), np.int64),
    )
