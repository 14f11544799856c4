"""How orders come to an agent and go on to others."""

from __future__ import annotations

from collections.abc import Iterable

from vedette.agent import orders
from vedette.agent.effects import Effect, Send, TrafficKind
from vedette.agent.messages import Orders, encode
from vedette.agent.mission import Heeding
from vedette.agent.orders import Given
from vedette.agent.state import Agent


def take(agent: Agent, told: Iterable[bytes], sender: int | None) -> list[Effect]:
    """Take orders, of a neighbour or of the operator (None); what is news goes on to all other neighbours.

    Raises:
        ValueError: one is malformed, or not signed as it should be; then none is taken, since one that is
            held already would be no news when it comes again, and neither heeded nor passed on.
    """
    checked = [(_checked(agent, data), data) for data in told]
    news = [data for given, data in checked if agent.orders.take(given)]
    if not news:
        return []
    heed(agent)
    return _say(agent, news, [k for k in agent.rounds.tree.neighbours if k != sender])


def _checked(agent: Agent, data: bytes) -> Given:
    given = orders.decode(data)
    agent.check_order(given)
    return given


def heed(agent: Agent) -> None:
    """Plan by the orders in force, and anew."""
    if isinstance(agent.mission, Heeding):
        agent.mission.heed(agent.orders)
    agent.quiet = 0
    agent.rounds.want()


def tell_all(agent: Agent) -> list[Effect]:
    """Return all orders for all neighbours on a new tree: on the old one some may have been lost."""
    told = [orders.encode(given) for given in agent.orders.all]
    return _say(agent, told, agent.rounds.tree.neighbours) if told else []


def _say(agent: Agent, told: list[bytes], neighbours: Iterable[int]) -> list[Effect]:
    payload = encode(Orders(tuple(told)))
    return [Send(neighbour, TrafficKind.FUSION, payload) for neighbour in neighbours]
