"""Toy agents that sign what they see, and are told things one by one."""

from __future__ import annotations

from typing import Any

from tests.support.agent_team import FRAME, toy_agent
from tests.support.notaries import certified
from vedette.agent import Agent, messages, step
from vedette.agent.effects import Effect
from vedette.agent.events import Message, TreeChanged
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed import SignedEvidence


def notary(robot: int) -> Any:
    """A robot's, with a certificate."""
    return certified(robot, lambda: 100.0)


def agent(robot: int, neighbours: tuple[int, ...]) -> Agent:
    """A robot that signs, on a chain."""
    made = toy_agent(robot, [], None)  # type: ignore[arg-type]
    limits = Capabilities(0.1, 8.0, 0.5)
    made.mission.fusion = SignedEvidence(robot, 1, FRAME.shape, 4, notary=notary(robot), limits=limits)
    made.__post_init__()
    step(made, [TreeChanged(1, None, neighbours, 4)], 0.0)
    return made


def hears(hearer: Agent, sender: int, message: Any, now: float = 1.0) -> list[Effect]:
    """Let an agent hear a message; return what it wants done."""
    return step(hearer, [Message(sender, messages.encode(message))], now)
