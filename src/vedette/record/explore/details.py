"""What is told of robots beside where they are and go, as JSON in the record: tours, traffic, orders."""

from __future__ import annotations

from typing import TypeVar

import msgspec

from vedette.agent.orders import Order
from vedette.record.explore.log import Ahead, RobotSample
from vedette.record.explore.summary import LeftOut

KindT = TypeVar("KindT")
encode = msgspec.json.Encoder(enc_hook=lambda number: number.item()).encode  # NumPy's numbers


class RobotDetails(msgspec.Struct, frozen=True):
    """What is told of one robot; the fields are those of ``vedette.record.explore.log.RobotSample``."""

    tour: tuple[Ahead, ...] = ()
    way_left: float | None = None
    rounds: int = 0
    sent: int = 0
    orders: tuple[Order, ...] = ()
    trust: str = ""

    @classmethod
    def of(cls, robot: RobotSample) -> RobotDetails:
        """Return what is told of a robot."""
        return cls(robot.tour, robot.way_left, robot.rounds, robot.sent, robot.orders, robot.trust)


def read(text: str, kind: type[KindT]) -> KindT:
    """Return what was written; ValueError if it was something else."""
    return msgspec.json.decode(text, type=kind)


Spots = tuple[LeftOut, ...]
