"""A member of a team that signs, and changes one field of what only such a team says.

What is within something signed is changed and signed anew by the member itself: its own beacons and accounts.
What others have signed it cannot. ``CASES`` lists all, as ``tests.support.mutants`` does for other messages.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import msgspec
from msgspec import structs

from tests.support.mutants import ANOTHER, NEGOTIATION, Case, Mutant, cases_of, places_of
from tests.support.notaries import PlainNotary
from vedette.agent import Agent, Datagram, NetworkedAgent, messages, orders
from vedette.agent.effects import Send, TrafficKind
from vedette.agent.events import Event
from vedette.agent.messages import Account, Beacon, Beacons, Freeze, Orders, Proof, Proven, Vouched
from vedette.agent.networked import BEACON, Output
from vedette.agent.orders import Given, Remove
from vedette.fusion import contradictions, seals
from vedette.fusion.contradictions import SignedWord, Twice

SIGNED_BEACON = "beacon that is signed"
KINDS: Mapping[str, Any] = {
    "Audit": messages.Audit,
    "Account": Account,
    "Vouched": Vouched,
    SIGNED_BEACON: Beacon,
    "Proof": Proof,
    "Twice": Twice,
    "Proven": Proven,
    "Orders": Orders,
    "Given": Given,
    "FramedFreeze": messages.FramedFreeze,
}
MULTISTART = ("Gather", "Token", "Stop")  # its messages are the token's, and mean more
SIGNATURE = len(structs.fields(Account))  # its place in an account
CASES = tuple(
    cases_of(
        {name: list(places_of(kind)) for name, kind in KINDS.items()}
        | {
            name: list(places_of(kind[bytes] if hasattr(kind, "__parameters__") else kind))
            for kind in NEGOTIATION.values()
            if (name := kind.__name__) in MULTISTART
        }
    )
)
OPERATOR = 1 << 20  # no robot's number: the toy notary's key for orders


def given_by_operator() -> Given:
    """Return an order that changes nothing."""
    order, mission = Remove(area="nowhere"), "test"
    said = PlainNotary(OPERATOR, float).sign(*_words(Given(1, "operator", order, mission)))
    return Given(1, "operator", order, mission, said, b"operator")


def check_order(given: Given) -> None:
    """Raise ValueError for an order that the operator has not signed."""
    PlainNotary(OPERATOR, float).check(OPERATOR, given.signature, *_words(given))


def _words(given: Given) -> tuple[int | bytes | str, ...]:
    return "order", given.counter, given.operator, orders.encode(given.order), given.mission


class SignedMutant(Mutant):
    """The honest program, but for one field, and that it wants audits, and tells of proofs and orders."""

    def __init__(self, agent: Agent, now: float, *, lease: float, case: Case, another: int) -> None:
        super().__init__(agent, now, lease=lease, case=case, another=another)
        self._next = now  # it tells of them then [s]

    def _agree(self, events: Iterable[Event], now: float) -> list[Output]:
        agent = self.agent
        assert agent.rounds.scrutiny.auditor is not None
        agent.rounds.scrutiny.auditor.want(now)
        effects = super()._agree(events, now)
        if now >= self._next and (message := self._tells()) is not None:
            self._next = now + 1.0
            payload = messages.encode(message)
            for k in agent.rounds.tree.neighbours:
                effects += self._say(Send(k, TrafficKind.NEGOTIATION, payload), now)
        return effects

    def _tells(self) -> Proof | Proven | Orders | None:
        """Return what it tells of now and then, if it is that which it changes."""
        match self._case.message:
            case "Proof":
                names = self._case.value == ANOTHER and self._case.place == (1,)
                return self._proof(self._another if names else self.agent.robot, self._twice())
            case "Twice":
                return self._proof(self.agent.robot, self._changed(self._twice()))
            case "Proven":
                return Proven((self.agent.robot,))
            case "Orders" | "Given":
                return Orders((orders.encode(given_by_operator()),))
            case _:
                return None

    def _proof(self, robot: int, data: bytes) -> Proof:
        return Proof(robot, PlainNotary(robot, float).certificate, data)

    def _twice(self) -> bytes:
        """Return a proof of its own lie."""
        words = [
            messages.encode(Beacon(self.agent.robot, self.agent.boot, 1 << 40, x, 0, 0, 0, 20, 50, ()))
            for x in (0, 1)
        ]
        first, second = (SignedWord((seals.BEACON, word), self._sign(seals.BEACON, word)) for word in words)
        return contradictions.encode(Twice(first, second))

    def _sign(self, kind: str, data: bytes) -> bytes:
        assert self.agent.signed is not None
        return self.agent.signed.standing.notary.sign(kind, data)

    # -- what it changes -----------------------------------------------------------------------------

    def _say(self, send: Send, now: float) -> list[Output]:
        message, about = messages.decode(send.payload), self._case.message
        if isinstance(message, Vouched):  # on its way as a datagram
            return NetworkedAgent._say(self, send, now)
        if isinstance(message, Account) and about == "Account" and self._may(send.to):
            changed = self._account(send.payload, own=message.robot == self.agent.robot)
            return NetworkedAgent._say(self, replace(send, payload=changed), now)
        if isinstance(message, Orders) and about == "Given" and self._may(send.to):
            told = messages.encode(Orders(tuple(self._changed(each) for each in message.told)))
            return NetworkedAgent._say(self, replace(send, payload=told), now)
        if type(message) is Freeze and about == "FramedFreeze":
            frame = messages.FrameTold(self.agent.robot, self.agent.boot, 0, 0, 0, 0)
            framed = messages.FramedFreeze(*structs.astuple(message), frames=(frame,))
            send = replace(send, payload=messages.encode(framed))
        return super()._say(send, now)

    def _account(self, data: bytes, *, own: bool) -> bytes:
        """Return an account that is changed, and if it is its own signed as it is then."""
        fields = msgspec.msgpack.decode(self._changed(data))
        if own and self._case.place[0] != SIGNATURE:
            fields[SIGNATURE] = b""
            fields[SIGNATURE] = self._sign(seals.ACCOUNT, msgspec.msgpack.encode(fields))
        return msgspec.msgpack.encode(fields)

    def _datagram(self, to: int, payload: bytes, carried: int = 0) -> Datagram:
        if payload[:1] == BEACON and self._case.message in ("Vouched", SIGNED_BEACON):
            data = payload[1:]
            changed = self._beacons(data)
            if changed != data and self._may(to):
                payload = BEACON + changed
        return super()._datagram(to, payload, carried)

    def _beacons(self, data: bytes) -> bytes:
        message = messages.decode(data)
        if isinstance(message, Beacons):
            return messages.encode(Beacons(tuple(self._vouched(each) for each in message.told)))
        return self._vouched(data)

    def _vouched(self, data: bytes) -> bytes:
        """Return a signed beacon changed, or what is in it; others as they are."""
        told = messages.decode_told(data)
        if not isinstance(told, Vouched):
            return data
        if self._case.message == "Vouched":
            return self._changed(data)
        if messages.decode_beacon(told.beacon).robot != self.agent.robot:
            return data
        changed = self._changed(told.beacon)
        signed = structs.replace(told, beacon=changed, signature=self._sign(seals.BEACON, changed))
        return messages.encode(signed)
