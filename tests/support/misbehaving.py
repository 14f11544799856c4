"""Members that misbehave, each in one way: the honest program, but for what it does or says."""

from __future__ import annotations

import os
import signal
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import msgspec
import numpy as np

from vedette.agent import Agent, Datagram, NetworkedAgent, messages
from vedette.agent.effects import Job, Send, TrafficKind
from vedette.agent.events import Event, JobDone
from vedette.agent.messages import Beacon, Negotiate
from vedette.agent.networked import BEACON, HELLO, Output
from vedette.negotiation.messages import Joined, Settled, Stop, Token

NEVER = float("inf")
BOOT, EPOCH, ECHO = 1, 4, -1  # fields of a hello
LIFE = 20  # hellos
BEACONS_EVERY, BEACONS_AT_ONCE = 0.1, 40  # [s]
SECOND_AFTER = 5.0  # is a robot's second process started [s]
ROUNDS = 3  # that a member whose process ends has taken part in


class Slow(NetworkedAgent):
    """Takes so long [s] for every job; for ever: it hangs. Its overlay goes on."""

    def __init__(self, agent: Agent, now: float, *, takes: float, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._takes, self._back = takes, NEVER
        self._job: JobDone | None = None

    @property
    def wake(self) -> float:
        """When the job is back, if nothing is before."""
        return min(super().wake, self._back)

    def step(self, events: Iterable[Event], now: float) -> list[Output]:
        """Hold back what has been done until it would have been."""
        told: list[Event] = []
        for event in events:
            if isinstance(event, JobDone):
                self._job = event
            else:
                told.append(event)
        if self._job is not None and now >= self._back:
            told.append(self._job)
            self.hold, self._back, self._job = False, NEVER, None
        outputs = super().step(told, now)
        if any(isinstance(each, Job) for each in outputs):
            self.hold, self._back = True, now + self._takes
        return outputs


class Twice(NetworkedAgent):
    """A second process under the same number, started somewhat later; the body is the first one's."""

    def __init__(self, agent: Agent, now: float, *, double: Agent, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._double, self._begins = NetworkedAgent(double, now + SECOND_AFTER, **how), now + SECOND_AFTER
        self._reaches: frozenset[int] = frozenset()

    @property
    def wake(self) -> float:
        """When either has something to do."""
        return min(super().wake, max(self._double.wake, self._begins))

    def hear(self, sender: int, datagram: bytes, now: float) -> list[Output]:
        """Both hear it."""
        told = super().hear(sender, datagram, now)
        return [*told, *(self._done(self._double.hear(sender, datagram, now)) if now >= self._begins else [])]

    def peers(self, robots: Iterable[int], now: float) -> list[Output]:
        """The second one reaches the same."""
        self._reaches = frozenset(robots)
        return super().peers(robots, now)

    def step(self, events: Iterable[Event], now: float) -> list[Output]:
        """Let both take in what the robot senses."""
        told = list(events)
        outputs = super().step(told, now)
        if now < self._begins:
            return outputs
        sensed = [event for event in told if not isinstance(event, JobDone)]
        reached = self._double.peers(self._reaches, now)
        return [*outputs, *self._done([*reached, *self._double.step(sensed, now)])]

    def _done(self, outputs: list[Output]) -> list[Output]:
        """Return the second one's datagrams; it moves nothing, and has no part in any round."""
        return [each for each in outputs if isinstance(each, Datagram)]


class Dead(NetworkedAgent):
    """Says and does nothing: what the others are compared with."""

    @property
    def wake(self) -> float:
        """Never."""
        return NEVER

    def hear(self, sender: int, datagram: bytes, now: float) -> list[Output]:
        """Nothing."""
        return []

    def peers(self, robots: Iterable[int], now: float) -> list[Output]:
        """Nothing."""
        return []

    def step(self, events: Iterable[Event], now: float) -> list[Output]:
        """Nothing."""
        return []


class Mute(NetworkedAgent):
    """Says hello, shares evidence, and says nothing in rounds."""

    def _say(self, send: Send, now: float) -> list[Output]:
        return [] if send.traffic is TrafficKind.NEGOTIATION else super()._say(send, now)


class Fickle(NetworkedAgent):
    """Takes part in every other round."""

    def _say(self, send: Send, now: float) -> list[Output]:
        return [] if getattr(messages.decode(send.payload), "sequence", 0) % 2 else super()._say(send, now)


class Endless(NetworkedAgent):
    """Counts each round anew, and lets none come to its end by its word."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message = messages.decode(send.payload)
        if isinstance(message, Negotiate):
            said = msgspec.msgpack.decode(message.data)
            if said[0] in (Stop.__struct_config__.tag, Settled.__struct_config__.tag):
                return []
            if said[0] == Token.__struct_config__.tag:
                said[2][:2] = 0, 0  # turns, quiet
            if said[0] == Joined.__struct_config__.tag:
                said[6] = 1  # moved
            changed = msgspec.structs.replace(message, data=msgspec.msgpack.encode(said))
            send = replace(send, payload=messages.encode(changed))
        return super()._say(send, now)


class Ending(NetworkedAgent):
    """Ends its own process by a signal in the middle of a round, when it has decided a few times."""

    def __init__(self, agent: Agent, now: float, *, number: signal.Signals, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._number = number

    def _say(self, send: Send, now: float) -> list[Output]:
        if self.agent.rounds.decisions >= ROUNDS and isinstance(messages.decode(send.payload), Negotiate):
            os.kill(os.getpid(), self._number)
        return super()._say(send, now)


class Truncating(NetworkedAgent):
    """Ends all that it negotiates too soon."""

    def _say(self, send: Send, now: float) -> list[Output]:
        message = messages.decode(send.payload)
        if isinstance(message, Negotiate):
            cut = msgspec.structs.replace(message, data=message.data[:-3])
            send = replace(send, payload=messages.encode(cut))
        return super()._say(send, now)


class Hailing(NetworkedAgent, ABC):
    """Changes its hellos."""

    def _datagram(self, to: int, payload: bytes, carried: int = 0) -> Datagram:
        if payload.startswith(HELLO):
            hello = msgspec.msgpack.decode(payload[1:])
            self._change(hello)
            payload = HELLO + msgspec.msgpack.encode(hello)
        return super()._datagram(to, payload, carried)

    @abstractmethod
    def _change(self, hello: list[Any]) -> None:
        """Change a hello in place."""


class Reborn(Hailing):
    """Says every few seconds that it has just started."""

    def __init__(self, agent: Agent, now: float, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._said = 0

    def _change(self, hello: list[Any]) -> None:
        self._said += 1
        hello[BOOT] += self._said // LIFE


class Echoing(Hailing):
    """Has heard hellos that were never said."""

    def _change(self, hello: list[Any]) -> None:
        if hello[ECHO] is not None:
            hello[ECHO][1] += 1_000_000


class Raising(Hailing):
    """Says once to each that the epoch is the highest there can be, or somewhat lower."""

    def __init__(self, agent: Agent, now: float, *, epoch: int, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._epoch, self._said = epoch, 0

    def _change(self, hello: list[Any]) -> None:
        self._said += 1
        if self._said % 20 == 0:
            hello[EPOCH] = self._epoch


class Disagreeing(NetworkedAgent):
    """Has another map than all the others."""

    def __init__(self, agent: Agent, now: float, **how: Any) -> None:
        super().__init__(agent, now, **(how | {"terms": {"map.resolution": "0.05"}}))


class Beaconing(NetworkedAgent):
    """Sends so many beacons at once, again and again: of itself, or of robots that there are not."""

    def __init__(self, agent: Agent, now: float, *, robots: int, points: int, **how: Any) -> None:
        super().__init__(agent, now, **how)
        self._robots, self._path = robots, (1000,) * 2 * points
        self._said, self._next = 0, now

    def step(self, events: Iterable[Event], now: float) -> list[Output]:
        """Beacon, too."""
        outputs = super().step(events, now)
        if now >= self._next:
            self._next = now + BEACONS_EVERY
            for to in self._links:
                outputs += [self._datagram(to, BEACON + each) for each in self._beacons()]
        return outputs

    def _beacons(self) -> Iterable[bytes]:
        for _ in range(BEACONS_AT_ONCE):
            self._said += 1
            robot = self.agent.robot if self._robots == 1 else self._said % self._robots
            yield messages.encode(Beacon(robot, 1 << 40, self._said, 0, 0, 0, 0, 20, 50, self._path))


def delay_of(rng: np.random.Generator) -> float:
    """Return how long a slow member takes: a tenth of a second to for ever [s]."""
    return float(rng.choice([0.1, 0.7, 2.0, 3.0, 5.0, 12.0]))
