"""One robot of any domain, put together: its agent, its body, and what it tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vedette.agent import Agent
from vedette.agent.body import Body, Shown
from vedette.agent.terms import Terms
from vedette.net.orders import Judge
from vedette.net.witness import Teller


@dataclass(frozen=True, eq=False)
class Robot:
    """What a process runs."""

    agent: Agent
    body: Body
    shown: Shown | None  # the body, where it is simulated and others are to see it
    teller: Teller
    terms: Terms  # what its team has to agree on
    show: Callable[[float], None] | None = None  # to those beside the robot, at a mission's time [s]
    time: Callable[[], float | None] | None = None  # its own clock [s], to go by; None: this host's
    judge: Judge | None = None  # of the operator's orders; None: it takes none
