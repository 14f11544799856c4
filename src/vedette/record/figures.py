"""Figures that every mission has, by robot and of the team: rounds, ways, traffic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from vedette.agent.effects import TrafficKind as Kind
from vedette.agent.rounds import Rounds
from vedette.record.log import VehicleSample
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
class RobotFigures:
    """What one robot has counted up to now."""

    travelled_m: float = 0.0
    rounds: RoundFigures = field(default_factory=RoundFigures)
    messages: Traffic = field(default_factory=Traffic)  # sent
    bytes: Traffic = field(default_factory=Traffic)


@dataclass(frozen=True)
class TeamFigures:
    """The same of a team, as summaries hold them."""

    lost: tuple[str, ...]  # robots that were lost on the way
    left: tuple[str, ...]  # robots that said goodbye before the end
    path_m: Mapping[str, float]
    rounds: int  # that the robot with the most of them has ended with a decision
    sweeps: int  # in these
    bound_ratio: float | None  # mean value over bound, all robots' decisions; None: no decision had a bound
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]

    @classmethod
    def of(
        cls, names: Sequence[str], figures: Sequence[RobotFigures], samples: Sequence[VehicleSample]
    ) -> TeamFigures:
        """Return the figures of a team from those of its robots, and how these are in the end."""
        team = dict(zip(names, figures, strict=True))
        rounds = [each.rounds for each in figures]
        leader = max(rounds, key=lambda each: each.rounds)
        bounded = sum(each.bounded for each in rounds)
        return cls(
            lost=tuple(name for name, each in zip(team, samples, strict=True) if each.fate == "lost"),
            left=tuple(name for name, each in zip(team, samples, strict=True) if each.fate == "left"),
            path_m={name: each.travelled_m for name, each in team.items()},
            rounds=leader.rounds,
            sweeps=leader.sweeps,
            bound_ratio=sum(each.bound_ratios for each in rounds) / bounded if bounded else None,
            messages={name: each.messages for name, each in team.items()},
            bytes={name: each.bytes for name, each in team.items()},
        )


def traffic_of(sent: Mapping[Kind, Sequence[int]], robot: int) -> Traffic:
    """Return what one robot sent of each kind (``Network.messages_sent``, ``.bytes_sent``)."""
    return Traffic(**{kind.value: counts[robot] for kind, counts in sent.items()})
