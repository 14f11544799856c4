"""Orders on a network: whose they may be, what is refused, and how an operator gives them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from msgspec import structs

from vedette.agent.orders import Given, LookThere, NoGo, Order, Priority, Recall, Remove, decode, encode
from vedette.agent.state import Agent
from vedette.errors import InputError
from vedette.maps import OCCUPIED
from vedette.maps.area import Area
from vedette.missions.explore.exploring import Exploring
from vedette.missions.sense import Grounds, forbidden_by
from vedette.net.config import AgentConfig
from vedette.net.credentials import Credentials
from vedette.net.endpoints import is_loopback
from vedette.net.names import OPERATOR
from vedette.net.notary import CertifiedNotary

TAKEN = "taken"
WHAT = "order"  # stands before what is signed


@dataclass(frozen=True)
class Gate:
    """What one robot asks of every order that reaches it, from the operator or by way of a mate."""

    mission: str  # that its team agrees on
    notary: CertifiedNotary | None  # None: links are open to everybody
    local: bool  # these links never leave this computer

    def check(self, given: Given) -> None:
        """Raise ValueError for an order of another mission, or that no operator of the team has signed."""
        if given.mission != self.mission:
            raise ValueError("the order is of another mission; ask for the team's state, and give it anew")
        if self.notary is not None:
            self.notary.check_operator(given.certificate, given.signature, *_signed(given))
        elif not self.local:
            raise ValueError("links are open to everybody: without keys orders are taken on loopback alone")


def gate_of(config: AgentConfig, mission: str, notary: CertifiedNotary | None) -> Gate:
    """Return the gate of a robot's file."""
    links = config.links
    local = not links.scouting and all(is_loopback(each) for each in (*links.listen, *links.connect))
    return Gate(mission, notary, local)


@dataclass(frozen=True, eq=False)
class Judge:
    """Says of an order whether one robot takes it."""

    gate: Gate
    objection: Callable[[Order], str | None]  # why an order makes no sense; None: it does

    def verdict(self, data: bytes) -> str:
        """Return ``TAKEN``, or why an order is refused, in a line; nothing is changed by it."""
        try:
            given = decode(data)
            self.gate.check(given)
        except ValueError as error:
            return str(error)
        return self.objection(given.order) or TAKEN


def explorer_judge(agent: Agent, gate: Gate) -> Judge:
    """Return the judge of a robot that explores."""
    return Judge(gate, lambda order: _objection(agent, cast(Exploring, agent.mission), order))


def flight_judge(agent: Agent, gate: Gate, grounds: Grounds) -> Judge:
    """Return the judge of a vehicle, which also checks orders that mates pass on."""
    agent.check_order = gate.check
    return Judge(
        gate,
        lambda order: agent.orders.unknown_area(order) or grounds.objection(order, agent.orders.all_of(NoGo)),
    )


def _objection(agent: Agent, mission: Exploring, order: Order) -> str | None:
    """Say in a line why an order makes no sense, as far as this robot knows the ground; None: it does."""
    if order.robot_number > agent.rounds.admitted:
        return f"there is no robot {order.robot_number} in a team of {agent.rounds.admitted} at most"
    of, book = order.in_frame_of, agent.orders
    if agent.framing is None and getattr(order, "frame", None) is not None:
        return "the robots share one frame; leave out whose a place is in"
    if agent.framing is not None and of is not None:
        if of >= agent.rounds.admitted:
            return f"there is no robot {of + 1} in a team of {agent.rounds.admitted} at most"
        if agent.framing.in_own(of) is None:
            return None  # what is there, others know
        order, book = agent.in_own(order), book.seen_from(agent.framing.in_own)
    match order:
        case Remove():
            return agent.orders.unknown_area(order)
        case NoGo() | Priority():
            try:
                area = Area.of(order.corners)
            except InputError as error:
                return str(error)
            (x0, y0, x1, y1), (left, right, low, high) = area.box, mission.frame.extent
            if x1 <= left or x0 >= right or y1 <= low or y0 >= high:
                return f"the area lies outside: {mission.lattice.room}"
        case Recall(to=(x, y)) | LookThere(at=(x, y)):
            row, col = mission.frame.cell(x, y)
            if not (0 <= row < mission.frame.rows and 0 <= col < mission.frame.cols):
                return f"{x:g}, {y:g} lies outside: {mission.lattice.room}"
            cell = np.array([row * mission.frame.cols + col])
            if mission.fusion.classes.take(cell)[0] == OCCUPIED:
                return f"there is a wall at {x:g}, {y:g}"
            return forbidden_by(x, y, book.all_of(NoGo))
    return None


def written(
    order: Order,
    mission: str,
    heard: Sequence[int],
    pen: CertifiedNotary | None,
    clock: Callable[[], float] = time.time,
) -> Given:
    """Return an order as it is given now.

    Args:
        order: what is ordered.
        mission: that the team agrees on.
        heard: counters of the orders that robots hold.
        pen: signs in the operator's name; None: nobody does.
        clock: time of day [s].
    """
    counter = max(int(1000.0 * clock()), *(count + 1 for count in heard), 0)
    given = Given(counter, OPERATOR, order, mission)
    if pen is None:
        return given
    return structs.replace(given, signature=pen.sign(*_signed(given)), certificate=pen.certificate)


def pen_of(operator: Credentials | None, mission: str) -> CertifiedNotary | None:
    """Return what an operator's orders are signed with; None: the team has no keys."""
    return None if operator is None else CertifiedNotary(operator, mission, time.time)


def _signed(given: Given) -> tuple[int | bytes | str, ...]:
    return WHAT, given.counter, given.operator, encode(given.order)
