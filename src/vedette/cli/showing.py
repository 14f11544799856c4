"""``vedette status --watch``: a team on the network as it goes on, in a terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.text import Text

from vedette.interrupt import ending_on_ctrl_c
from vedette.net.access import Access
from vedette.net.explore.picture import picture_of
from vedette.net.gather import path_of
from vedette.net.hearing import Hearing
from vedette.net.names import robot_name
from vedette.net.report import Report
from vedette.net.results import lasted
from vedette.net.transport import Operator
from vedette.record.explore.screen import screen
from vedette.record.log import LEFT, MissionScene, VehicleSample
from vedette.record.view import Column, TeamTable

PERIOD = 1.0  # between two pictures; where there is no terminal, LINES times that [s]
LINES = 10
SILENT = 5.0  # who has been silent for so long may be lost [s]
NOBODY = "nobody has been heard yet"


def watch_team(access: Access, mission: str) -> None:
    """Show a team until Ctrl-C; who falls silent stays where it was heard last, with how long ago."""
    console, going_on = Console(), [True]
    with Operator(access) as operator, ending_on_ctrl_c(going_on.clear):
        hearing = Hearing(operator)
        if console.is_terminal and not console.is_dumb_terminal:
            with Live(console=console, auto_refresh=False) as live:
                while going_on:
                    hearing.listen(PERIOD)
                    live.update(team_picture(console, access.team, mission, hearing), refresh=True)
            return
        while going_on:
            hearing.listen(PERIOD * LINES, lambda: not going_on)
            console.print(team_picture(console, access.team, mission, hearing))


def team_picture(console: Console, team: str, mission: str, hearing: Hearing) -> RenderableType:
    """Return what has been heard, fitted to the console."""
    reports = dict(sorted(hearing.reports.items()))
    if not reports:
        return Text(NOBODY)
    silent = {robot: hearing.silent(robot) for robot in reports}
    lost = {
        robot: f"silent {age:.0f} s"
        for robot, age in silent.items()
        if age > SILENT and reports[robot].condition.state != LEFT
    }
    complaints = (
        Text(f"{robot_name(robot)} of {robot_name(each.robot)}: {each.what}")
        for robot, report in reports.items()
        for each in report.condition.complaints
    )
    return Group(_shown(console, team, mission, reports, lost), *complaints)


def _shown(
    console: Console, team: str, mission: str, reports: Mapping[int, Report], lost: Mapping[int, str]
) -> RenderableType:
    told = [report.condition for report in reports.values()]
    at: Column = ("at (m)", [f"{each.x:.1f}, {each.y:.1f}" for each in told])
    if mission == "explore":
        scene, snapshot = picture_of(team, reports, lost)
        return screen(scene, console, snapshot, [at])
    names = tuple(robot_name(robot) for robot in reports)
    vehicles = [
        VehicleSample(
            each.x, each.y, each.heading, lost.get(robot, each.state), robot not in lost, path_of(each)
        )
        for robot, each in zip(reports, told, strict=True)
    ]
    columns = [at, ("flown (m)", [f"{each.travelled:.0f}" for each in told])]
    time = Text(f"{team}, {max(map(lasted, told)):.0f} s")
    table = TeamTable("vehicle", MissionScene(name=team, vehicles=names), vehicles, columns)
    return Group(time, table.fitted(console.height - 2, console.width).shown)
