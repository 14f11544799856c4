"""A member that changes one field of what it says, in every message of one kind, or in one of them only.

Fields, those within fields included, messages and values are numbered: ``CASES`` lists them all, and a seed
takes one, with a scheme that has such a message and a member that has cause to say it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import msgspec
from msgspec import inspect

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
DEEP: Any = []
for _ in range(500):
    DEEP = [DEEP]
VALUES: tuple[Any, ...] = (
    *(0, -1, 1, 255, 2**16, 2**32, 2**53, 2**62, 2**63 - 1, -(2**53), ANOTHER, 1e300),
    *(math.nan, math.inf, -math.inf, None, True, (), b"", "\u202e" * 100_000, DEEP),
)
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
SCHEMES: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("Gather",), ("token", "fork")),
    **dict.fromkeys(("Token",), ("token",)),
    **dict.fromkeys(("Up", "Down"), ("jacobi",)),
    **dict.fromkeys(("Stop",), ("token", "jacobi")),
    **dict.fromkeys(("Fork", "Joined"), ("fork",)),
    **dict.fromkeys(("Offer", "Tidings"), ("async",)),
    **dict.fromkeys(("Settled",), ("fork", "async")),
}
FROM_ABOVE = (
    "Begin",
    "Freeze",
    "FramedFreeze",
    "Down",
    "Fork",
    "Tidings",
    "Settled",
)  # what a root has cause to say
FROM_BELOW = ("Call", "Flushed", "Gather", "Up", "Joined", "Offer")  # and who has a parent
EVIDENCE = ("nonce", "echo", "have robot", "have boot", "have version", "robot", "boot", "base", "version")


@dataclass(frozen=True)
class Case:
    """Which field of which message, and what is said there."""

    message: str
    place: tuple[int, ...]  # in the message, and within fields; of evidence, in ``EVIDENCE``
    value: Any
    once: bool  # in one message a neighbour, not in all

    def __str__(self) -> str:
        where = "".join(f"[{k}]" for k in self.place)
        return f"{self.message}{where} = {repr(self.value)[:40]}{', once' if self.once else ''}"


def places_of(kind: Any) -> Iterator[tuple[int, ...]]:
    """Yield where the fields of a kind of message are, and those within them; of many alike the first."""
    return _places(inspect.type_info(kind))


def _places(kind: inspect.Type) -> Iterator[tuple[int, ...]]:
    inner: list[inspect.Type] = []
    match kind:
        case inspect.Metadata():
            yield from _places(kind.type)
            return
        case inspect.UnionType():
            yield from {place: None for each in kind.types for place in _places(each)}
            return
        case inspect.StructType():
            inner = [field.type for field in kind.fields]
        case inspect.NamedTupleType():
            inner = [field.type for field in kind.fields]
        case inspect.TupleType():
            inner = list(kind.item_types)
        case inspect.VarTupleType():
            inner = [kind.item_type]
    tagged = isinstance(kind, inspect.StructType) and kind.tag is not None
    for k, each in enumerate(inner, start=int(tagged)):
        yield (k,)
        yield from ((k, *within) for within in _places(each))


def _cases() -> Iterator[Case]:
    negotiated = [kind[bytes] if hasattr(kind, "__parameters__") else kind for kind in NEGOTIATION.values()]
    kinds: tuple[Any, ...] = (*DATAGRAMS.values(), *AGENTS, *negotiated)
    places = {_name(kind): list(places_of(kind)) for kind in kinds}
    places["Evidence"] = [(k,) for k in range(len(EVIDENCE))]
    return cases_of(places)


def cases_of(places: Mapping[str, Iterable[tuple[int, ...]]]) -> Iterator[Case]:
    """Yield all that can be said at these places of messages."""
    for message, all_places in places.items():
        for place in all_places:
            for value in VALUES:
                for once in (False, True):
                    yield Case(message, place, value, once)


def _name(kind: Any) -> str:
    return str(getattr(kind, "__origin__", kind).__name__)


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
            payload = kind + self._changed(data)
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
            send = replace(send, payload=self._changed(send.payload))
        elif isinstance(message, messages.Negotiate):
            tag = msgspec.msgpack.decode(message.data)[0]
            if tag in NEGOTIATION and NEGOTIATION[tag].__name__ == self._case.message and self._may(send.to):
                changed = msgspec.structs.replace(message, data=self._changed(message.data))
                send = replace(send, payload=messages.encode(changed))
        return super()._say(send, now)

    def _may(self, to: int) -> bool:
        """Tell whether to change a message to a neighbour now."""
        if self._case.once and to in self._done:
            return False
        self._done.add(to)
        return True

    def _changed(self, data: bytes) -> bytes:
        """Return a message with the field changed, if it is there."""
        fields = part = msgspec.msgpack.decode(data)
        *outer, last = self._case.place
        for k in outer:
            part = part[k] if isinstance(part, list) and k < len(part) else None
        if isinstance(part, list) and last < len(part):
            part[last] = self._value
        return msgspec.msgpack.encode(fields)

    def _beacon(self, data: bytes) -> bytes:
        """Return a beacon, or many, changed; one is changed where it is the first of many, too."""
        many = messages.decode(data)
        if isinstance(many, messages.Beacons) and self._case.message == "Beacon":
            return messages.encode(messages.Beacons((self._changed(many.told[0]), *many.told[1:])))
        return self._changed(data) if type(many).__name__ == self._case.message else data

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
        what, value = EVIDENCE[self._case.place[0]], self._value
        if not isinstance(value, int) or value < 0:
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
