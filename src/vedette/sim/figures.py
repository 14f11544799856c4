"""Figures that every simulated mission has: rounds, traffic, and what they cost in wall time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vedette.agent.effects import Traffic as Kind
from vedette.record.summary import Spread, Timing, Traffic
from vedette.sim.simulation import Simulation


@dataclass(frozen=True)
class Negotiated:
    """How the team's rounds went."""

    rounds: int  # that the robot with the most of them has ended with a decision
    sweeps: int  # in these
    bound_ratio: float | None  # mean value over bound, all robots' decisions; None: no decision had a bound


def negotiated(simulation: Simulation) -> Negotiated:
    """Return how the rounds of a mission went."""
    rounds = [agent.rounds for agent in simulation.agents]
    ratios = [ratio for each in rounds for ratio in each.bound_ratios]
    leader = max(rounds, key=lambda each: each.decisions)
    return Negotiated(leader.decisions, leader.sweeps, float(np.mean(ratios)) if ratios else None)


def traffic(names: Sequence[str], sent: Mapping[Kind, Sequence[int]]) -> dict[str, Traffic]:
    """Return messages or bytes sent (``Links.messages_sent``, ``.bytes_sent``) by name and kind."""
    return {
        name: Traffic(sent[Kind.NEGOTIATION][i], sent[Kind.FUSION][i], sent[Kind.BEACONS][i])
        for i, name in enumerate(names)
    }


def timing(simulation: Simulation) -> Timing:
    """Return the wall-clock figures of a mission."""
    clock = simulation.clock
    wall = clock.elapsed()
    return Timing(
        planning_ms=Spread.of([1e3 * took for took in clock.planning.values()]),
        answer_ms=Spread.of([1e3 * took for took in clock.answers]),
        real_time_factor=simulation.now / wall if wall > 0 else 0.0,
        wall_s=wall,
    )
