"""Which of an operator's orders make sense to a team of vehicles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import Exclude, LookThere, NoGo, Order, Priority, Recall, Reinstate
from vedette.errors import InputError
from vedette.forbidden import Forbidden
from vedette.maps import GridFrame
from vedette.maps.area import Area


@dataclass(frozen=True, eq=False)
class Grounds:
    """What orders to a team of vehicles can be about."""

    vehicles: int
    box: tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m], team frame
    looks: str = ""  # why no place can be worth more to all of the team; none: it can
    weighs: str = ""  # why no area can; none: it can
    walls: tuple[GridFrame, NDArray[np.bool_]] | None = None  # (R, C) where robots on the ground cannot be
    flies: tuple[bool, ...] = ()  # whether such walls do not matter to a vehicle; none: to nobody

    def objection(self, order: Order, no_go: Iterable[NoGo] = ()) -> str | None:
        """Say in a line why an order makes no sense, where there are ``no_go`` areas; None: it does."""
        if order.robot_number > self.vehicles:
            return f"there is no robot {order.robot_number} in a team of {self.vehicles}"
        match order:
            case NoGo() | Priority():
                if isinstance(order, Priority) and self.weighs:
                    return self.weighs
                return self._about_area(order)
            case LookThere(robot=None) if self.looks:
                return self.looks
            case Recall(to=(x, y)) | LookThere(at=(x, y)):
                return self._about_place(x, y, order.robot, no_go)
            case Exclude() | Reinstate():
                return "whom to believe can be ordered of robots that explore alone; leave it out"
        return None

    def _about_area(self, order: NoGo | Priority) -> str | None:
        try:
            area = Area.of(order.corners)
        except InputError as error:
            return str(error)
        (x0, y0, x1, y1), (left, low, right, high) = area.box, self.box
        outside = x1 <= left or x0 >= right or y1 <= low or y0 >= high
        return f"the area lies outside: {self._extent}" if outside else None

    def _about_place(self, x: float, y: float, robot: int | None, no_go: Iterable[NoGo]) -> str | None:
        left, low, right, high = self.box
        if not (left <= x <= right and low <= y <= high):
            return f"{x:g}, {y:g} lies outside: {self._extent}"
        if (objection := forbidden_by(x, y, no_go)) is not None:
            return objection
        if self.walls is not None:
            frame, blocked = self.walls
            lands = [not flies for flies in self.flies]
            if (any(lands) if robot is None else lands[robot - 1]) and blocked.flat[frame.flat(x, y)]:
                return f"no robot on the ground can be at {x:g}, {y:g}: there is no way"
        return None

    @property
    def _extent(self) -> str:
        left, low, right, high = self.box
        return f"x is {left:g} to {right:g} m, y is {low:g} to {high:g} m"


def forbidden_by(x: float, y: float, areas: Iterable[NoGo | Priority]) -> str | None:
    """Say in a line in which no-go area a place [m] lies; None: in none."""
    for each in areas:
        if isinstance(each, NoGo) and Forbidden((Area(each.corners),)).holds(x, y):
            return f"{x:g}, {y:g} lies in the no-go area {each.area}"
    return None
