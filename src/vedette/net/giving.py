"""How an operator's session gives a team orders, and what it says came of each."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from vedette.agent.orders import Order, encode
from vedette.errors import InputError
from vedette.net.access import Access
from vedette.net.orders import TAKEN, pen_of, written
from vedette.net.report import Condition
from vedette.net.transport import Operator


@dataclass(frozen=True)
class Giving:
    """Signs orders and tells them to all whom the session reaches."""

    operator: Operator
    access: Access
    name: Callable[[int], str]  # of a robot, by its index

    def give(self, order: Order, told: Collection[Condition]) -> str:
        """Give an order, and say in a line what has come of it; ``told``: what robots said of themselves.

        Raises:
            InputError: nobody takes it, for it makes no sense.
        """
        mission = next((each.mission for each in told if each.mission), "")
        if not mission:
            return "refused: nobody who takes orders has been heard"
        heard = [each.counter for condition in told for each in condition.orders]
        given = written(order, mission, heard, pen_of(self.access.credentials, mission))
        answers = self.operator.order(encode(given))
        taken = sorted(robot for robot, line in answers.items() if line == TAKEN)
        if taken:
            return f"taken by {', '.join(map(self.name, taken))}"
        if answers:
            robot, line = sorted(answers.items())[0]
            raise InputError(f"{self.name(robot)}: {line}")
        return "refused: nobody answered"
