"""Orders of an operator: what each says, and the book in which the later one about a subject wins.

An order is about a *subject*: a robot's mode, an area by its name, whether a robot is believed, or the whole
team's mode. It is named by its operator and a counter that grows; all robots that hold the same orders do the
same, whatever way and in whatever order these came.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias, TypeVar

import msgspec
import numpy as np
from msgspec import Meta, Struct, structs

from vedette import wire
from vedette.errors import nearest_name
from vedette.fusion.digest import fingerprint
from vedette.maps.transform import IDENTITY, Transform

MOST_ORDERS = 256  # subjects that there can be
MOST_CORNERS = 64
PLACES = ("at", "to", "corners")  # what in orders lies somewhere
Number = Annotated[int, Meta(ge=1, le=1 << 16)]  # of a robot, as people count
Metre = Annotated[float, Meta(ge=-2.1e7, le=2.1e7)]
Name = Annotated[
    str, Meta(pattern=r"^[A-Za-z0-9_-]{1,32}\Z", description="1 to 32 letters, digits, '-' or '_'")
]
Corners = Annotated[
    tuple[tuple[Metre, Metre], ...],
    Meta(min_length=3, max_length=MOST_CORNERS, description=f"a list of 3 to {MOST_CORNERS} places [x, y]"),
]


class _Order(
    Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True, tag_field="order"
):
    """What is ordered.

    Places lie in the frame that the team shares. Where it shares none they lie in that of a robot, ``frame``:
    if none is named, of the robot that the order is about, else of the first.
    """

    @property
    def robot_number(self) -> int:
        """The robot that it is about, as people count; 0: none in particular."""
        return getattr(self, "robot", None) or 0

    @property
    def in_frame_of(self) -> int | None:
        """The robot, by its index, in whose frame its places lie; None: it has none."""
        if not any(getattr(self, name, None) is not None for name in PLACES):
            return None
        return (getattr(self, "frame", None) or self.robot_number or 1) - 1


class _OfRobots(_Order, frozen=True, kw_only=True):
    robot: Number | None = None  # None: the whole team

    @property
    def subject(self) -> str:
        """Whose mode it sets."""
        return "team" if self.robot is None else f"robot-{self.robot}"


class Resume(_OfRobots, frozen=True, kw_only=True, tag="resume"):
    """Work, as without any order."""


class Pause(_OfRobots, frozen=True, kw_only=True, tag="pause"):
    """Stand, take part in rounds with nothing to do, and wait to be told to resume."""


class Stay(_OfRobots, frozen=True, kw_only=True, tag="stay"):
    """Stand, and be done: the others go on without it."""


class Recall(_OfRobots, frozen=True, kw_only=True, tag="recall"):
    """Go back to the start, or to a point, and be done."""

    to: tuple[Metre, Metre] | None = None  # [m]; None: where it started
    frame: Number | None = None  # the robot in whose frame that lies, where the team shares none


class LookThere(_OfRobots, frozen=True, kw_only=True, tag="look"):
    """Go and look at a place, then work on; of the team, whoever it suits best."""

    at: tuple[Metre, Metre]  # [m]
    frame: Number | None = None  # the robot in whose frame that lies, where the team shares none

    @property
    def subject(self) -> str:
        """A robot's mode, or a place that is worth more to all."""
        if self.robot is not None:
            return f"robot-{self.robot}"
        return f"look-{self.at[0]:g}-{self.at[1]:g}" + (f"-of-{self.frame}" if self.frame else "")


class End(_Order, frozen=True, kw_only=True, tag="end"):
    """Everybody stops where it is; the mission is over."""

    robot: None = None

    @property
    def subject(self) -> str:
        """The team's mode."""
        return "team"


class _OfArea(_Order, frozen=True, kw_only=True):
    area: Name

    @property
    def subject(self) -> str:
        """The area of this name."""
        return f"area-{self.area}"


class NoGo(_OfArea, frozen=True, kw_only=True, tag="no-go"):
    """Nobody goes there, and nothing in there is the team's."""

    corners: Corners  # x, y [m]
    frame: Number | None = None  # the robot in whose frame they lie, where the team shares none


class Priority(_OfArea, frozen=True, kw_only=True, tag="priority"):
    """What is in there is worth more."""

    corners: Corners  # x, y [m]
    frame: Number | None = None  # the robot in whose frame they lie, where the team shares none
    factor: Annotated[float, Meta(ge=1.0, le=100.0)] = 3.0


class Remove(_OfArea, frozen=True, kw_only=True, tag="remove"):
    """There is no such area any more."""


class _OfTrust(_Order, frozen=True, kw_only=True):
    robot: Number

    @property
    def subject(self) -> str:
        """Whether this robot is believed."""
        return f"trust-{self.robot}"


class Exclude(_OfTrust, frozen=True, kw_only=True, tag="exclude"):
    """A robot's evidence is not believed, whatever it agrees with."""


class Reinstate(_OfTrust, frozen=True, kw_only=True, tag="reinstate"):
    """A robot's evidence is believed, whatever it contradicts."""


Order: TypeAlias = (
    Resume | Pause | Stay | Recall | LookThere | End | NoGo | Priority | Remove | Exclude | Reinstate
)


OrderT = TypeVar("OrderT", bound=_Order)


def moved(order: OrderT, there: Transform) -> OrderT:
    """Return an order with its places as they lie in another frame, where the one they are in lies so."""
    places = {name: getattr(order, name, None) for name in PLACES}
    changed: dict[str, object] = {}
    for name, place in places.items():
        if place is not None:
            corners = there.places(np.array(place, np.float64).reshape(-1, 2)).tolist()
            changed[name] = tuple(map(tuple, corners)) if name == "corners" else tuple(corners[0])
    return structs.replace(order, **changed)


class Given(Struct, frozen=True, array_like=True):
    """An order, with who has given it and when: the later of two about one subject is in force."""

    counter: Annotated[int, Meta(ge=0, le=2**62)]
    operator: Name
    order: Order
    mission: Annotated[str, Meta(max_length=64)] = ""  # that it is for; no other takes it
    signature: bytes = b""  # by the operator's certificate, where the team has keys
    certificate: bytes = b""

    @property
    def rank(self) -> tuple[int, str, bytes]:
        """What decides which is the later, the same for all."""
        return self.counter, self.operator, encode(self.order)


_DECODER: msgspec.msgpack.Decoder[Given] = msgspec.msgpack.Decoder(Given)
encode = msgspec.msgpack.Encoder().encode


def decode(data: bytes) -> Given:
    """Return an order; ValueError if it is malformed."""
    return wire.decode(_DECODER, data, "order")


@dataclass
class OrderBook:
    """The orders in force, as far as one robot has heard."""

    _given: dict[str, Given] = field(default_factory=dict)  # by subject
    fulfilled: set[tuple[int, str, bytes]] = field(default_factory=set)  # looks that this robot has made

    def take(self, given: Given) -> bool:
        """Take an order; tell whether it is news and the latest about its subject."""
        subject = given.order.subject
        held = self._given.get(subject)
        if held is not None and held.rank >= given.rank:
            return False
        if held is None and len(self._given) >= MOST_ORDERS:
            raise ValueError(f"order about {subject}: there are {MOST_ORDERS} subjects already")
        self._given[subject] = given
        return True

    @property
    def all(self) -> list[Given]:
        """Everything that is in force, oldest first."""
        return sorted(self._given.values(), key=lambda given: given.rank)

    @property
    def digest(self) -> int:
        """64 bits, equal for two robots iff they hold the same orders; 0 for none."""
        return fingerprint(encode([given.rank for given in self.all]), 0) if self._given else 0

    def in_force(self, robot: int) -> Given | None:
        """Return what a robot, by its index, is to do instead of working; None: it works."""
        given = [self._given[name] for name in ("team", f"robot-{robot + 1}") if name in self._given]
        if not given:
            return None
        latest = max(given, key=lambda each: each.rank)
        over = isinstance(latest.order, Resume) or latest.rank in self.fulfilled
        return None if over else latest

    def seen_from(self, framed: Callable[[int], Transform | None]) -> OrderBook:
        """Return the book with all places in one frame, by where robots' frames lie in that.

        What is about a place in a frame that ``framed`` does not know is left out.
        """
        given = dict[str, Given]()
        for subject, each in self._given.items():
            of = each.order.in_frame_of
            there = IDENTITY if of is None else framed(of)
            if there is not None:
                given[subject] = structs.replace(each, order=moved(each.order, there))
        return OrderBook(given, self.fulfilled)

    @property
    def any_no_go(self) -> bool:
        """Tell whether there is ground where nobody may go."""
        return any(isinstance(given.order, NoGo) for given in self._given.values())

    def unknown_area(self, order: Order) -> str | None:
        """Say in a line that an order removes an area that there never was; None: it does not."""
        names = [held.order.area for held in self.all if isinstance(held.order, NoGo | Priority | Remove)]
        if isinstance(order, Remove) and order.area not in names:
            return f"there is no area {order.area}; {nearest_name(order.area, names)}"
        return None

    def fulfil(self, robot: int) -> None:
        """Note that a robot has looked where it was to look; it works on."""
        own = self._given.get(f"robot-{robot + 1}")
        if own is not None and isinstance(own.order, LookThere):
            self.fulfilled.add(own.rank)

    def all_of(self, kind: type[OrderT]) -> list[OrderT]:
        """Return the orders in force of a kind, oldest first."""
        return [given.order for given in self.all if isinstance(given.order, kind)]
