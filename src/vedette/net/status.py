"""How a team's agents are, asked of each and shown in a table."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from msgspec.structs import replace
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from vedette.net.names import robot_name
from vedette.net.report import Condition, LinkReport, read_condition
from vedette.net.transport import Operator
from vedette.number import many
from vedette.record.explore.told import outlook
from vedette.record.summary import Figures

ANSWER = 0.5  # for which an agent may think about its answer [s]


def ask(operator: Operator, robots: Sequence[int], wait: float) -> dict[int, Condition | None]:
    """Return what each robot says of itself; None for one that does not within ``wait`` [s], or nonsense."""
    told: dict[int, Condition | None] = dict.fromkeys(robots)
    end = time.monotonic() + wait
    while None in told.values() and time.monotonic() < end:
        if not operator.peers >= {robot for robot, said in told.items() if said is None}:
            time.sleep(0.05)
            if time.monotonic() < end - ANSWER:
                continue
        for robot, payload in operator.statuses(min(ANSWER, max(end - time.monotonic(), 0.1))).items():
            told[robot] = _read(robot, payload)
    return dict(sorted(told.items()))


@dataclass(frozen=True, kw_only=True)
class TeamStatus(Figures):
    """Everything that was told, by robot's name; None for one that did not answer."""

    robots: Mapping[str, Condition | None]
    left: tuple[str, ...]  # robots that did not answer, and had said goodbye to others


def _left(told: Mapping[int, Condition | None]) -> list[int]:
    """Return who does not answer, but has said goodbye to somebody who does."""
    goodbyes = {link.robot for said in told.values() if said for link in said.links if link.role == "left"}
    return [robot for robot, said in told.items() if said is None and robot in goodbyes]


def team_status(told: Mapping[int, Condition | None]) -> TeamStatus:
    """Return what ``vedette status --json`` prints: robots by their numbers, which count from 1."""
    return TeamStatus(
        robots={robot_name(robot): None if said is None else numbered(said) for robot, said in told.items()},
        left=tuple(map(robot_name, _left(told))),
    )


def numbered(said: Condition) -> Condition:
    """Return what a robot said with robots' numbers in the place of their indices."""
    return replace(
        said,
        robot=said.robot + 1,
        root=said.root + 1,
        parent=None if said.parent is None else said.parent + 1,
        neighbours=tuple(robot + 1 for robot in said.neighbours),
        links=tuple(replace(link, robot=link.robot + 1) for link in said.links),
        complaints=tuple(replace(each, robot=each.robot + 1) for each in said.complaints),
        out=tuple(robot + 1 for robot in said.out),
    )


def status_table(told: Mapping[int, Condition | None]) -> RenderableType:
    """Return the agents, their tree and its links, for a terminal."""
    answered = [said for said in told.values() if said is not None]
    majority = Counter(said.digest for said in answered).most_common(1)
    digest = majority[0][0] if majority else 0
    agents = Table(title="agents", title_justify="left")
    for column in ("robot", "state", "known", "map", "tree", "parent", "rounds", "dropped"):
        agents.add_column(column)
    gone = _left(told)
    for robot, said in told.items():
        silent = "left" if robot in gone else "no answer"
        agents.add_row(robot_name(robot), *([silent] if said is None else _row(said, digest)))
    links = Table(title="links", title_justify="left")
    for column in ("from", "to", "role", "loss", "round trip", "clock", "last heard"):
        links.add_column(column)
    for said in answered:
        for link in said.links:
            links.add_row(robot_name(said.robot), robot_name(link.robot), *_link(link))
    complaints = (
        Text(f"{robot_name(said.robot)} of {robot_name(each.robot)}: {each.what}")
        for said in answered
        for each in said.complaints
    )
    ahead = (Text(line) for line in _ahead(answered))
    alerts = (Text(f"{robot_name(said.robot)}: {line}") for said in answered for line in said.alerts)
    return Group(agents, Text(""), links, *complaints, *alerts, *ahead, Text(_verdict(told)))


def _ahead(answered: Sequence[Condition]) -> list[str]:
    """Say what is expected of an exploration, by who knows most."""
    told = max(answered, key=lambda said: said.known_m2 or 0.0, default=None)
    if told is None or told.expected is None:
        return []
    lasted = told.time - (told.began or 0.0)
    spans = (f"{name} {value}" for name, value in outlook(told.expected, lasted))
    return [f"expected after {lasted:.0f} s: {'; '.join(spans)}"]


def _row(said: Condition, digest: int) -> list[str]:
    dropped = ", ".join(f"{where} {count}" for where, count in said.dropped.items() if count)
    parent = "root" if said.parent is None else robot_name(said.parent)
    return [
        said.state,
        _known(said),
        "same" if said.digest == digest else "differs",
        f"{robot_name(said.root)}, {many(said.size, 'robot')}, {said.age:.0f} s old",
        parent,
        str(said.rounds) if said.decided is None else f"{said.rounds}, {said.decided:.0f} s ago",
        dropped or "none",
    ]


def _known(said: Condition) -> str:
    """Return how much of the ground is known; if nobody knows how large it is, how fast it grew as well."""
    if said.known is not None:
        return f"{100 * said.known:.1f} %"
    if said.known_m2 is None:
        return "-"
    lasted = 0.0 if said.began is None else said.time - said.began
    rate = f", {said.known_m2 / lasted:.1f} m²/s" if lasted > 0.0 else ""
    left = "" if said.frontiers is None else f", {many(said.frontiers, 'frontier')} left"
    beyond = f", {said.beyond} beams beyond all room" if said.beyond else ""
    return f"{said.known_m2:.0f} m²{rate}{left}{beyond}"


def _link(link: LinkReport) -> list[str]:
    return [
        link.role,
        f"{100 * link.loss:.0f} %",
        "-" if link.round_trip is None else f"{1e3 * link.round_trip:.1f} ms",
        "-" if link.offset is None else f"{link.offset:+.3f} s",
        "never" if link.silent is None else f"{link.silent:.1f} s ago",
    ]


def _verdict(told: Mapping[int, Condition | None]) -> str:
    answered = [said for said in told.values() if said is not None]
    if not answered:
        return "none answered"
    gone = _left(told)
    count = f"{len(answered)} of {len(told)} answered" + (f", {len(gone)} left" if gone else "")
    if len(answered) == 1:  # there is nobody to agree with
        return count
    trees = len({said.number for said in answered})
    maps = len({said.digest for said in answered})
    together = "on one tree" if trees == 1 else f"on {trees} trees"
    agree = "hold the same map" if maps == 1 else f"hold {maps} different maps"
    return f"{count}; {'they' if len(answered) == len(told) else 'these'} are {together} and {agree}"


def _read(robot: int, payload: bytes) -> Condition | None:
    try:
        condition = read_condition(payload)
    except ValueError:
        return None
    return condition if condition.robot == robot else None
