"""What robots are called outside the code, in Zenoh keys and certificates: numbered from 1, as people do."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum

from vedette.errors import InputError

MOST_ROBOTS = 1 << 16
OPERATOR = "operator"
_TEAM = re.compile(r"[A-Za-z0-9_-]{1,32}")
_NUMBER = re.compile(r"[1-9][0-9]{0,4}")


class Topic(StrEnum):
    """What a robot tells whoever wants to know."""

    REPORT = "report"  # how its mission goes, for the operator
    BODY = "body"  # where its simulated body is, for the others' simulated sensors


@dataclass(frozen=True)
class Names:
    """The Zenoh keys and certificate names of one team; ``None`` stands for any robot."""

    team: str

    def link(self, sender: int | None, to: int | None) -> str:
        """Key of the datagrams from one robot to another."""
        return f"vedette/{self.team}/link/{_part(sender)}/{_part(to)}"

    def alive(self, robot: int | None, session: str = "*") -> str:
        """Key of the token that stands while a robot's session does."""
        return f"vedette/{self.team}/alive/{_part(robot)}/{session}"

    def topic(self, topic: Topic, robot: int | None) -> str:
        """Key under which a robot publishes."""
        return f"vedette/{self.team}/{topic}/{_part(robot)}"

    def status(self, robot: int | None) -> str:
        """Key under which a robot answers for its status."""
        return f"vedette/{self.team}/status/{_part(robot)}"

    def order(self, robot: int | None) -> str:
        """Key under which a robot takes the operator's orders."""
        return f"vedette/{self.team}/order/{_part(robot)}"

    def everything(self) -> str:
        """Key expression of all of these."""
        return f"vedette/{self.team}/**"

    def certificate(self, robot: int | None) -> str:
        """Common name of a robot's certificate, or of the operator's if None."""
        return f"{self.team}/{OPERATOR if robot is None else robot_name(robot)}"


def robot_name(robot: int) -> str:
    """Return ``robot-3`` for robot 2."""
    return f"robot-{robot + 1}"


def robot_of(part: str) -> int | None:
    """Return the robot that a part of a key names, or None if it names none."""
    robot = int(part) - 1 if _NUMBER.fullmatch(part) else MOST_ROBOTS
    return robot if robot < MOST_ROBOTS else None


def check_robot(robot: int) -> int:
    """Return ``robot``, which must lie in 0..65535.

    Raises:
        InputError: it does not.
    """
    if not 0 <= robot < MOST_ROBOTS:
        raise InputError(f"robot must lie in 1..{MOST_ROBOTS}; got {robot + 1}")
    return robot


def check_team(team: str) -> str:
    """Return ``team``, which becomes part of keys and certificates.

    Raises:
        InputError: it is not 1 to 32 letters, digits, '-' or '_'.
    """
    if not _TEAM.fullmatch(team):
        raise InputError(f"team must be 1 to 32 letters, digits, '-' or '_'; got {team!r}")
    return team


def _part(robot: int | None) -> str:
    return "*" if robot is None else str(robot + 1)
