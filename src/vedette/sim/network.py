"""What carries simulated robots' messages, and what happens to robots meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol, TypeAlias

from vedette.agent import Agent
from vedette.agent.effects import TrafficKind
from vedette.agent.events import Event
from vedette.record.links import Link

Act: TypeAlias = Callable[[], Sequence[Any]]
"""Something that a robot's agent does, when called; returns the effects, some of them for the network."""

Spawn: TypeAlias = Callable[[int, int], Agent]
"""``spawn(robot, boot)``: a fresh agent, its memory empty."""

FIRST_BOOT = 1


class Network(Protocol):
    """Robots by index; whoever runs it lets each ``Act`` happen at once, at the time that it came with."""

    @property
    def agents(self) -> Sequence[Agent]:
        """Everybody's agent, the latest one where a robot has been started again."""

    @property
    def messages_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot."""

    @property
    def bytes_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot, payloads only."""

    def tick(self, now: float) -> Iterable[tuple[int, Act]]:
        """Let what is due happen to robots and links; once a tick, before anybody senses anything."""

    def tell(self, i: int, events: Sequence[Event], now: float) -> Act:
        """Let a robot's agent take in what its robot senses, or that a job is done."""

    def send(self, i: int, effect: Any, now: float) -> None:
        """Take what a robot sends: an effect of an act of its, neither motion nor job."""

    def due(self) -> float:
        """Return when the next message arrives or robot wakes [s]; inf: never."""

    def happen(self) -> tuple[float, int, Act]:
        """Take the next of these: when, and what which robot does."""

    def killed(self, i: int, now: float) -> None:
        """Take a robot off the network for ever."""

    def links(self) -> tuple[Link, ...] | None:
        """Return the links that are up, to look at; None where links are not simulated."""
