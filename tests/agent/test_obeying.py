"""Orders on their way from robot to robot."""

from __future__ import annotations

from tests.support.signing_agents import agent, hears
from vedette.agent import messages, orders
from vedette.agent.effects import Effect, Send
from vedette.agent.messages import Orders

PAUSE = orders.encode(orders.Given(1, "mary", orders.Pause()))


def told(effects: list[Effect]) -> list[int]:
    """Return who is told of orders."""
    return [
        each.to
        for each in effects
        if isinstance(each, Send) and messages.decode(each.payload) == Orders((PAUSE,))
    ]


def test_an_order_that_comes_beside_one_that_makes_no_sense_is_heeded_and_passed_on_when_it_comes_again() -> (
    None
):
    """Who put the two together kept the robot, and all behind it, from an order that it held as known."""
    made = agent(1, (0, 2))
    assert told(hears(made, 0, Orders((PAUSE, b"nonsense")))) == []
    assert made.dropped == 1
    assert told(hears(made, 2, Orders((PAUSE,)))) == [0]
    assert made.orders.in_force(1) is not None
