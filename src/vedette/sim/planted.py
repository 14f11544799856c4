"""The ideal network: every robot reaches every other, and a tree is planted for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, step
from vedette.agent.effects import Send, TrafficKind
from vedette.agent.events import Event, TreeChanged
from vedette.negotiation import Tree
from vedette.sim.links import Wires
from vedette.sim.network import FIRST_BOOT, Act, Spawn

NOTICED_AFTER = 1.0  # a dead robot is missed, and the tree planted anew, after so long [s]


class PlantedTree:
    """All messages arrive, in order, after a delay; ``vedette.sim.network.Network``."""

    def __init__(
        self,
        spawn: Spawn,
        alive: Callable[[], NDArray[np.bool_]],
        wires: Wires,
        apart: bool = False,
    ) -> None:
        """Bring robots to life; ``apart``: each is on a tree of its own."""
        self.agents: Sequence[Agent] = [spawn(i, FIRST_BOOT) for i in range(wires.robots)]
        self._alive, self.wires, self._apart = alive, wires, apart
        self._due = [0.0]  # when the tree is planted next [s]
        self._epoch = 0

    @property
    def messages_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot."""
        return self.wires.messages_sent

    @property
    def bytes_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot, payloads only."""
        return self.wires.bytes_sent

    def tick(self, now: float) -> Iterable[tuple[int, Act]]:
        """Plant a tree for the living, when it is due."""
        if self._due and self._due[0] <= now:
            self._due.pop(0)
            for i, place in self._plant():
                yield i, self.tell(i, [place], now)

    def _plant(self) -> Iterable[tuple[int, TreeChanged]]:
        living = np.flatnonzero(self._alive()).tolist()
        self._epoch += 1
        if self._apart:
            return [(i, TreeChanged(self._epoch, None, (), 1)) for i in living]
        if not living:
            return []
        tree = Tree.balanced(len(living))
        parents = tree.parents(0)
        return [
            (
                i,
                TreeChanged(
                    self._epoch,
                    None if (parent := parents[place]) is None else living[parent],
                    tuple(living[k] for k in tree.neighbours(place)),
                    len(living),
                ),
            )
            for place, i in enumerate(living)
        ]

    def tell(self, i: int, events: Sequence[Event], now: float) -> Act:
        """Let an agent take in events."""
        return partial(step, self.agents[i], events, now)

    def send(self, i: int, effect: Any, now: float) -> None:
        """Put a message on its link; nobody can be shunned here, where the tree is given."""
        if isinstance(effect, Send):
            self.wires.send(i, effect, now)

    def due(self) -> float:
        """Return when the next message arrives [s]."""
        return self.wires.next_arrival()

    def happen(self) -> tuple[float, int, Act]:
        """Take the next message, or the beacons that come at one time: a robot takes them in at once."""
        now, receiver, messages = self.wires.arrive()
        return now, receiver, self.tell(receiver, messages, now)

    def killed(self, i: int, now: float) -> None:
        """Plant a new tree in a while."""
        self._due.append(now + NOTICED_AFTER)

    def links(self) -> None:
        """Return nothing to look at: all links are alike."""
