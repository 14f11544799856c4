"""A member that changes one field of what it says, in every message of one kind, or in one of them only.

Fields, messages and values are numbered: ``CASES`` lists them all, and a seed takes one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from vedette.agent import Agent, Datagram, NetworkedAgent, messages
from vedette.agent.acquaintance import Introduction
from vedette.agent.effects import Send
from vedette.agent.networked import BEACON, HELLO, PACKET, TERMS, Output
from vedette.fusion.link import Payload
from vedette.fusion.snapshots import Delta
from vedette.negotiation.messages import Down, Fork, Gather, Joined, Offer, Settled, Stop, Tidings, Token, Up
from vedette.overlay.hello import Hello
from vedette.overlay.packet import Packet

ANOTHER = "another's name"
VALUES: tuple[Any, ...] = (0, -1, 1, 255, 2**16, 2**32, 2**53, 2**62, 2**63 - 1, -(2**53), ANOTHER, 1e300)
DATAGRAMS = {HELLO: Hello, PACKET: Packet, TERMS: Introduction}
AGENTS = (
    messages.Beacon,
    messages.Beacons,
    messages.Call,
    messages.Begin,
    messages.Flushed,
    messages.Freeze,
    messages.Negotiate,
)
BEACONS = ("Beacon", "Beacons")
NEGOTIATION = {
    kind.__struct_config__.tag: kind
    for kind in (Gather, Token, Up, Down, Stop, Fork, Joined, Settled, Offer, Tidings)
}
EVIDENCE = ("nonce", "echo", "have robot", "have boot", "have version", "robot", "boot", "base", "version")


@dataclass(frozen=True)
class Case:
    """Which field of which message, and what is said there."""

    message: str
    field: int  # its place in the message; of evidence, in ``EVIDENCE``
    value: Any
    once: bool  # in one message a neighbour, not in all

    def __str__(self) -> str:
        return f"{self.message}[{self.field}] = {self.value}{', once' if self.once else ''}"


def _cases() -> Iterator[Case]:
    kinds = (*DATAGRAMS.values(), *AGENTS, *NEGOTIATION.values())
    fields = {kind.__name__: len(kind.__struct_fields__) for kind in kinds} | {"Evidence": len(EVIDENCE)}
    for message, count in fields.items():
        for field in range(count):
            for value in VALUES:
                for once in (False, True):
                    yield Case(message, field, value, once)


CASES = tuple(_cases())


class Mutant(NetworkedAgent):
    """The honest program, but for one field."""

    def __init__(self, agent: Agent, now: float, *, lease: float, case: Case, another: int) -> None:
        super().__init__(agent, now, lease=lease)
        self._case, self._another = case, another
        self._done: set[int] = set()  # neighbours that have been told

    def _datagram(self, to: int, payload: bytes, carried: int = 0) -> Datagram:
        kind, data = payload[:1], payload[1:]
        if kind in DATAGRAMS and DATAGRAMS[kind].__name__ == self._case.message and self._may(to):
            payload = kind + self._changed(data, 1)
        if kind == BEACON and self._case.message in BEACONS and self._may(to):
            payload = kind + self._beacon(data)
        return super()._datagram(to, payload, carried)

    def _say(self, send: Send, now: float) -> list[Output]:
        message = messages.decode(send.payload)
        name = type(message).__name__
        if name == "Evidence" and name == self._case.message and self._may(send.to):
            assert isinstance(message, messages.Evidence)
            send = replace(send, payload=messages.encode(messages.Evidence(self._evidence(message.data))))
        elif name == self._case.message and name not in BEACONS and self._may(send.to):
            send = replace(send, payload=self._changed(send.payload, 1))
        elif isinstance(message, messages.Negotiate):
            tag = msgspec.msgpack.decode(message.data)[0]
            if tag in NEGOTIATION and NEGOTIATION[tag].__name__ == self._case.message and self._may(send.to):
                changed = msgspec.structs.replace(message, data=self._changed(message.data, 1))
                send = replace(send, payload=messages.encode(changed))
        return super()._say(send, now)

    def _may(self, to: int) -> bool:
        """Tell whether to change a message to a neighbour now."""
        if self._case.once and to in self._done:
            return False
        self._done.add(to)
        return True

    def _changed(self, data: bytes, first: int) -> bytes:
        """Return a message with the field, or the first number in it, changed."""
        fields = msgspec.msgpack.decode(data)
        place = first + self._case.field
        if place < len(fields):
            fields[place] = self._put(fields[place])
        return msgspec.msgpack.encode(fields)

    def _beacon(self, data: bytes) -> bytes:
        """Return a beacon, or many, changed; one is changed where it is the first of many, too."""
        many = messages.decode(data)
        if isinstance(many, messages.Beacons) and self._case.message == "Beacon":
            return messages.encode(messages.Beacons((self._changed(many.told[0], 1), *many.told[1:])))
        return self._changed(data, 1) if type(many).__name__ == self._case.message else data

    def _put(self, old: Any) -> Any:
        if isinstance(old, list) and old:
            return [self._put(old[0]), *old[1:]]
        return self._value

    @property
    def _value(self) -> Any:
        return self._another if self._case.value == ANOTHER else self._case.value

    def _evidence(self, data: bytes) -> bytes:
        codec = self.agent.mission.fusion._codec  # type: ignore[attr-defined]
        try:
            return bytes(codec.encode(self._payload(codec.decode(data))))
        except (ValueError, TypeError, OverflowError):
            return data  # it cannot be said in the codec's words

    def _payload(self, payload: Payload[Delta[Any]]) -> Payload[Delta[Any]]:
        what, value = EVIDENCE[self._case.field], self._value
        if value != int(value) or value < 0:
            raise ValueError("numbers only")
        have = list(payload.have.items())
        sections = list(payload.sections)
        if what == "nonce":
            return replace(payload, nonce=value)
        if what == "echo" and payload.greeting is not None:
            return replace(payload, greeting=payload.greeting._replace(echo=value))
        if what.startswith("have") and have:
            (robot, boot), version = have[0]
            entry = {"have robot": robot, "have boot": boot, "have version": version} | {what: value}
            have[0] = (entry["have robot"], entry["have boot"]), entry["have version"]
        elif sections:
            (robot, boot), delta = sections[0]
            if what == "base":
                delta = replace(delta, base=value)
            elif what == "version":
                delta = replace(delta, version=value)
            name = {"robot": robot, "boot": boot} | {what: value}
            sections[0] = (name["robot"], name["boot"]), delta
        return replace(payload, have=dict(have), sections=sections)


def mutants_of(seeds: Iterable[int]) -> list[Case]:
    """Return the cases of some seeds, spread over all."""
    return [CASES[seed * 7919 % len(CASES)] for seed in seeds]
