"""What a fault schedule says: one struct a kind of fault, its robots numbered from 1 as in the file."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from msgspec import Meta, Struct, field

Robot = Annotated[int, Meta(ge=1)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Instant = Annotated[float, Meta(ge=0.0, le=86400.0)]  # since the start [s]
Duration = Annotated[float, Meta(gt=0.0, le=86400.0)]  # [s]
Wait = Annotated[float, Meta(ge=0.0, le=60.0)]  # [s]


class _At(
    Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="fault", omit_defaults=True
):
    at: Instant


class _OfLinks(_At, frozen=True, kw_only=True):
    lasts: Duration | None = field(default=None, name="for")  # without it, until links are healed


class Loss(_OfLinks, frozen=True, kw_only=True, tag="loss"):
    """Datagrams of all links are lost."""

    share: Share


class Delay(_OfLinks, frozen=True, kw_only=True, tag="delay"):
    """Datagrams of all links take a random time, so that they overtake each other."""

    between: tuple[Wait, Wait]  # shortest, longest [s]


class Duplicate(_OfLinks, frozen=True, kw_only=True, tag="duplicate"):
    """Datagrams of all links arrive twice."""

    share: Share


class OneWay(_OfLinks, frozen=True, kw_only=True, tag="one-way"):
    """Nothing that one robot sends reaches another; the way back is as it was."""

    sender: Robot = field(name="from")
    to: Robot


class Cut(_OfLinks, frozen=True, kw_only=True, tag="cut"):
    """Nothing passes between two robots."""

    robots: tuple[Robot, Robot]


class Partition(_OfLinks, frozen=True, kw_only=True, tag="partition"):
    """Nothing passes between parts of the team; robots that are in no part are one together."""

    parts: Annotated[tuple[tuple[Robot, ...], ...], Meta(min_length=1, max_length=1000)]


class Heal(_At, frozen=True, kw_only=True, tag="heal"):
    """All faults of links end."""


class Crash(_At, frozen=True, kw_only=True, tag="crash"):
    """A robot's program ends and its body stops."""

    robot: Robot


class Restart(_At, frozen=True, kw_only=True, tag="restart"):
    """The program of a robot that has crashed starts anew where its body is, its memory empty."""

    robot: Robot


class FreezeFault(_At, frozen=True, kw_only=True, tag="freeze"):
    """A robot's program halts, and goes on as if nothing had been."""

    robot: Robot
    lasts: Duration = field(name="for")


class Skew(_At, frozen=True, kw_only=True, tag="skew"):
    """A robot's clock shows another time, and runs at another speed."""

    robot: Robot
    s: Annotated[float, Meta(ge=-1e6, le=1e6)] = 0.0  # ahead, only from the start: no running clock jumps
    ppm: Annotated[float, Meta(ge=-1e5, le=1e5)] = 0.0  # faster


LinkFault: TypeAlias = Loss | Delay | Duplicate | OneWay | Cut | Partition
Fault: TypeAlias = LinkFault | Heal | Crash | Restart | FreezeFault | Skew


class Schedule(Struct, forbid_unknown_fields=True, frozen=True):
    """All faults of a simulation, in any order; those of one time happen in the order given."""

    faults: Annotated[tuple[Fault, ...], Meta(max_length=10_000)]

    def in_time(self) -> list[tuple[int, Fault]]:
        """Return the faults in order of time, each with its place in the schedule from 0."""
        return sorted(enumerate(self.faults), key=lambda placed: placed[1].at)
