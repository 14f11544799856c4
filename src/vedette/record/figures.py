"""Figures that every mission has: rounds and traffic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vedette.agent.effects import Traffic as Kind
from vedette.agent.rounds import Rounds
from vedette.record.summary import Traffic


@dataclass(frozen=True)
class RoundFigures:
    """How the rounds of one robot went."""

    rounds: int = 0  # that it has ended with a decision
    sweeps: int = 0  # in these
    bounded: int = 0  # those whose value had a bound
    bound_ratios: float = 0.0  # value over bound, summed over these

    @classmethod
    def of(cls, rounds: Rounds) -> RoundFigures:
        """Return the figures of an agent's rounds."""
        ratios = rounds.bound_ratios
        return cls(rounds.decisions, rounds.sweeps, len(ratios), float(sum(ratios)))


@dataclass(frozen=True)
class Negotiated:
    """How the team's rounds went."""

    rounds: int  # that the robot with the most of them has ended with a decision
    sweeps: int  # in these
    bound_ratio: float | None  # mean value over bound, all robots' decisions; None: no decision had a bound

    @classmethod
    def by(cls, team: Sequence[RoundFigures]) -> Negotiated:
        """Return how the rounds of a team went."""
        leader = max(team, key=lambda each: each.rounds)
        bounded = sum(each.bounded for each in team)
        mean = sum(each.bound_ratios for each in team) / bounded if bounded else None
        return cls(leader.rounds, leader.sweeps, mean)


def traffic_of(sent: Mapping[Kind, Sequence[int]], robot: int) -> Traffic:
    """Return what one robot sent of each kind (``Links.messages_sent``, ``.bytes_sent``)."""
    return Traffic(**{kind.value: counts[robot] for kind, counts in sent.items()})


def traffic(names: Sequence[str], sent: Mapping[Kind, Sequence[int]]) -> dict[str, Traffic]:
    """Return messages or bytes sent (``Links.messages_sent``, ``.bytes_sent``) by name and kind."""
    return {name: traffic_of(sent, i) for i, name in enumerate(names)}
