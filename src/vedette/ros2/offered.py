"""What a robot's ROS offers: topics, their types, who writes them how."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Writer:
    """How somebody publishes a topic."""

    reliable: bool
    kept: bool  # for who joins late: durability transient local


@dataclass(frozen=True)
class Offered:
    """What can be found without hearing anything."""

    types: Mapping[str, tuple[str, ...]]  # of every topic
    names: Mapping[str, str]  # what the keys of the robot's file stand for, and tf and tf_static
    writers: Mapping[str, tuple[Writer, ...]]  # of those topics, of the common tf, and of /clock
    navigator: bool  # it is there
    state: str | None  # of its life cycle; None: not told

    def of_type(self, kind: str) -> list[str]:
        """Return the topics of a type."""
        return sorted(name for name, types in self.types.items() if kind in types)
