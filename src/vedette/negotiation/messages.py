"""What platforms say to each other in a round, and how it travels as bytes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Set
from typing import Annotated, Any, Generic, TypeAlias, cast

import msgspec

from vedette import wire
from vedette.errors import InputError
from vedette.problem.bound import MOST_VALUE
from vedette.problem.objective import Codec, ImpactT

Count = Annotated[int, msgspec.Meta(ge=0, le=2**53)]
Size = Annotated[int, msgspec.Meta(ge=1, le=2**53)]  # of a part of the tree: somebody is in it
Value = Annotated[float, msgspec.Meta(ge=-MOST_VALUE, le=MOST_VALUE)]  # sums of them are finite; never NaN
Most = Annotated[float, msgspec.Meta(ge=-MOST_VALUE)]  # infinite where nothing is known; never NaN


class RoundOutcome(msgspec.Struct, frozen=True, array_like=True):
    """How a round ended; the same at every platform that it ended for."""

    value: Value  # of the team's choice, in the objective's unit
    bound: Value | None  # the optimum is no higher; None: nothing is known
    sweeps: Count  # in which platforms replied, since the last cut
    converged: bool  # nobody can gain more than epsilon by changing alone
    cycle: Count = 0  # period of the cycle that Jacobi ran into, 0 if none


class Tally(msgspec.Struct, frozen=True, array_like=True):
    """What the token counts on its way round; exact for the team's present choice."""

    turns: Count  # taken so far, one a platform in every sweep; anew after a cut
    quiet: Count  # platforms in a row that are content with the present choice
    value: Value  # of the present choice
    slack: Most  # sum over those quiet platforms, docs/theory.md (V12)
    size: Size  # of the team
    ceiling: Most  # optimum <= ceiling, known from the start, docs/theory.md (V12)


# In every message, mu is the sender's part of the tree combined, docs/theory.md (V5);
# None says: as the last mu on this link in this round.


class Gather(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=0, eq=False):
    """Towards the root, once, before the token starts."""

    mu: ImpactT | None
    size: Size  # platforms combined in mu
    ceiling: Most  # their sum
    value: Value  # of those platforms' choice


class Token(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=1, eq=False):
    """The right to choose, handed along the Euler tour."""

    mu: ImpactT | None
    tally: Tally


class Up(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=2, eq=False):
    """Towards the root, once an iterate (paper, Fig. 1)."""

    mu: ImpactT | None
    ceiling: Most  # sum over the platforms combined in mu
    slack: Most  # likewise, against the team's previous iterate; infinite at the first
    same: tuple[Count, ...]  # iterates at which all of them had their present strategies, this one included


class Down(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=3, eq=False):
    """Away from the root, once an iterate: the rest of the team, or with an inverse the whole of it."""

    mu: ImpactT | None


class Stop(msgspec.Struct, frozen=True, array_like=True, tag=4):
    """To everybody, once: the round is over."""

    outcome: RoundOutcome
    iterate: Count | None = None  # whose strategies everybody takes up again; None: the present ones


class Fork(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=5, eq=False):
    """The right to choose, to a child's whole part of the tree at once."""

    mu: ImpactT | None
    keep: bool  # what the part became in the last sweep; otherwise as it was before


class Joined(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=6, eq=False):
    """What a part of the tree has become in a sweep, for its parent to take or to refuse."""

    mu: ImpactT | None
    value: Value  # of the part by itself
    slack: Most  # sum over the part; counts if nobody in the team has moved
    size: Size
    ceiling: Most
    moved: Count  # platforms that changed, whether or not their parents let them, and children that were cut
    first: bool  # one of them had no strategy before


class Settled(msgspec.Struct, frozen=True, array_like=True, tag=7):
    """To everybody, once: the round of forks is over."""

    outcome: RoundOutcome
    keep: bool  # as in ``Fork``
    quiet: bool  # nobody moved in the last sweep, so that everybody knows the rest of the team


class Offer(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=8, eq=False):
    """Towards the root, if there is reason to: what a part of the tree would become, or that all is well."""

    mu: ImpactT | None  # None: nothing is offered
    serial: Count  # of the last offer
    heard: Count  # serial of the last news
    quiet: bool  # nobody in the part has anything more to offer, all having heard those news
    fact: bool  # what is offered is so already: not to be refused
    value: Value  # of the part by itself, as offered
    slack: Most  # sum over the part; counts if quiet
    size: Size
    ceiling: Most
    changes: Count  # of strategy, offered: most of any platform of the part
    capped: bool  # one of them was not allowed any more


class Tidings(msgspec.Struct, Generic[ImpactT], frozen=True, array_like=True, tag=9, eq=False):
    """Away from the root: the rest of the team, and what has become of the last offer."""

    mu: ImpactT
    serial: Count
    answered: Count  # serial of the last offer that was taken or refused
    taken: bool


Message: TypeAlias = (
    Gather[ImpactT]
    | Token[ImpactT]
    | Up[ImpactT]
    | Down[ImpactT]
    | Stop
    | Fork[ImpactT]
    | Joined[ImpactT]
    | Settled
    | Offer[ImpactT]
    | Tidings[ImpactT]
)

_DECODER: msgspec.msgpack.Decoder[Message[bytes]] = msgspec.msgpack.Decoder(
    Gather[bytes]
    | Token[bytes]
    | Up[bytes]
    | Down[bytes]
    | Stop
    | Fork[bytes]
    | Joined[bytes]
    | Settled
    | Offer[bytes]
    | Tidings[bytes]
)
_BARE = (Stop, Settled)  # without an impact


def encode(message: Message[ImpactT], codec: Codec[ImpactT]) -> bytes:
    """Return the message as MessagePack, its impact encoded by the codec."""
    if isinstance(message, _BARE) or message.mu is None:
        return msgspec.msgpack.encode(message)
    return msgspec.msgpack.encode(msgspec.structs.replace(message, mu=codec.encode(message.mu)))


def decode(data: bytes, codec: Codec[ImpactT]) -> Message[ImpactT]:
    """Return the message that ``encode`` was given; ``InputError`` if it is malformed."""
    try:
        message: Any = wire.decode(_DECODER, data, "negotiation message")
        if not isinstance(message, _BARE) and message.mu is not None:
            message = msgspec.structs.replace(message, mu=codec.decode(message.mu))
    except ValueError as error:
        raise InputError(str(error)) from error
    return cast("Message[ImpactT]", message)


def size(message: Message[ImpactT]) -> int:
    """Return the message's length in bytes where there is no codec: MessagePack around ``plain_size``."""
    if isinstance(message, _BARE) or message.mu is None:
        return len(msgspec.msgpack.encode(message))
    return len(msgspec.msgpack.encode(msgspec.structs.replace(message, mu=b""))) + plain_size(message.mu)


def plain_size(impact: object) -> int:
    """Return an impact's plain length: arrays their bytes, collections their items', anything else 8."""
    if isinstance(impact, str | bytes):
        return len(impact)
    if isinstance(nbytes := getattr(impact, "nbytes", None), int):
        return nbytes
    if isinstance(impact, Mapping):
        return sum(plain_size(key) + plain_size(item) for key, item in impact.items())
    if isinstance(impact, list | tuple | Set):
        return sum(plain_size(item) for item in impact)
    if dataclasses.is_dataclass(impact):
        return sum(plain_size(getattr(impact, field.name)) for field in dataclasses.fields(impact))
    return 8
