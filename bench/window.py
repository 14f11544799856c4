"""``python -m bench.window``: what the operator's window costs its server, of 20 robots on a large map."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from itertools import count

import click
import numpy as np
from msgspec.structs import replace

from bench import command, machine
from bench.table import markdown
from vedette.maps import UNKNOWN, GridFrame
from vedette.net.explore.content import content
from vedette.net.explore.picture import ExploreOnlooker
from vedette.net.report import Condition, Report
from vedette.record.explore.log import Ahead, ExploreScene, ExploreSnapshot, RobotSample
from vedette.sim.worlds.by_name import generated
from vedette.window.hub import PER_SECOND, Hub
from vedette.window.picture import Beside, Picture, picture
from vedette.window.server import WindowServer

ASKED = 10.0  # per cent of a core
SIDE = 100.0  # of the office [m]
SEES = 3.0  # what robots see of it about them [m]
PACE = 2.5  # the way of each in a second of real time, five times that of the mission [m]
REPORTS = 2.0  # of each robot on a network in a second
WATCH = """
import sys
from websockets.sync.client import connect
told = frames = 0
with connect(sys.argv[1]) as page:
    try:
        for message in page:
            told += len(message)
            frames += isinstance(message, str) and '"now"' in message
    except Exception:
        pass
print(frames, told)
"""
NOTHING: dict[str, int] = {}
BLANK = Condition(  # what no picture shows
    *(0, 1, "robot", 0.0, 0.0, "driving", 0.0, 0.0, 0.0, (), 0, 0, 0, None, (), 1, 0.0, (), 0, None),
    *(9, 9, 0, 0, 0.0, 0.0, 0, None, NOTHING, NOTHING, NOTHING, (), None, None, None),
)


def snapshots(robots: int, seed: int = 0) -> Iterator[ExploreSnapshot]:
    """Yield moments of a team that wanders through an office and maps what is about it, ten a second."""
    rng = np.random.default_rng(seed)
    world = generated("office", seed, SIDE, SIDE)
    true, frame = world.classes(), world.frame
    classes = np.full(frame.shape, UNKNOWN, np.uint8)
    impact = np.zeros(frame.coarse(2).shape, np.float32)
    at = rng.uniform(SEES, SIDE - SEES, (robots, 2))
    heading = rng.uniform(-np.pi, np.pi, robots)
    reach, t, step = round(SEES / frame.resolution), 0.0, PACE / PER_SECOND
    while True:
        heading += rng.normal(0.0, 0.1, robots)
        at += step * np.column_stack((np.cos(heading), np.sin(heading)))
        heading[(at < SEES).any(axis=1) | (at > SIDE - SEES).any(axis=1)] += np.pi
        at = at.clip(SEES, SIDE - SEES)
        impact[:] = 0.0
        for x, y in at:
            row, col = frame.cell(x, y)
            part = slice(row - reach, row + reach), slice(col - reach, col + reach)
            classes[part] = true[part]
            ahead = tuple(slice(each.start // 2 - 5, each.stop // 2 + 5) for each in part)
            impact[ahead] = 0.5
        known = float(np.count_nonzero(classes)) / classes.size
        team = tuple(
            RobotSample(
                *(float(x), float(y), float(turn), "driving", True),
                rng.uniform(0.0, SIDE, (20, 2)),
                f"robot-{i + 1}",
                (50.0, 50.0),
                tour=(Ahead(50.0, 50.0, 10.0, 3.0),) * 6,
            )
            for i, ((x, y), turn) in enumerate(zip(at, heading, strict=True))
        )
        yield ExploreSnapshot(t, team, known, known, 1e4, classes.copy(), impact.copy(), frontiers=99)
        t += 1.0 / PER_SECOND


def reported(robots: int) -> Iterator[Mapping[int, Report]]:
    """Yield what robots of such a team report, ten times a second: each reports twice a second."""
    moments = [moment for _, moment in zip(range(40), snapshots(robots), strict=False)][::10]
    told = [[_report(robot, moment) for robot in range(robots)] for moment in moments]
    now, each = dict(enumerate(told[0])), robots * REPORTS / PER_SECOND
    for picture_number in count():
        for k in range(round(each * picture_number), round(each * (picture_number + 1))):
            now[k % robots] = told[k // robots % len(told)][k % robots]
        yield dict(now)


def _report(robot: int, moment: ExploreSnapshot) -> Report:
    """A report that is a robot's own: of all that is known but for a corner."""
    sample, frame = moment.robots[robot], GridFrame(SIDE / len(moment.classes), *moment.classes.shape)
    classes = moment.classes.copy()
    classes[: 10 * robot, : 10 * robot] = UNKNOWN
    extent = slice(0, frame.rows), slice(0, frame.cols)
    condition = replace(BLANK, robot=robot, x=sample.x, y=sample.y, heading=sample.heading)
    return Report(condition, content(frame, extent, classes, classes > 0, None))


def measure(shows: Iterator[Picture], name: str, watchers: int, seconds: float) -> tuple[float, float, float]:
    """Return what pictures take of a core [%], how many a second a page gets, and kB of each."""
    hub, spent = Hub(name), 0.0
    with WindowServer(hub) as window:
        hub.show(next(shows))
        address = window.address.replace("http", "ws").replace("/?", "/watch?")
        pages = [
            subprocess.Popen([sys.executable, "-c", WATCH, address], stdout=subprocess.PIPE, text=True)
            for _ in range(watchers)
        ]
        time.sleep(2.0)
        began, shown = time.monotonic(), 0
        while (elapsed := time.monotonic() - began) < seconds:
            before = time.process_time()
            hub.show(next(shows))
            shown += 1
            time.sleep(max(began + shown / PER_SECOND - time.monotonic(), 0.0))
            spent += time.process_time() - before
    said = [[int(each) for each in page.communicate()[0].split()] for page in pages]
    frames, told = np.mean(said, axis=0)
    return 100.0 * spent / elapsed, frames / elapsed, told / frames / 1e3


def simulated(robots: int, frames: int) -> Iterator[Picture]:
    """Return pictures of a mission, whose moments are there beforehand."""
    moments = [moment for _, moment in zip(range(frames), snapshots(robots), strict=False)]
    scene = ExploreScene.of(generated("office", 0, SIDE, SIDE), [robot.name for robot in moments[0].robots])
    return (picture(scene, moment) for moment in moments)


def heard(robots: int, frames: int) -> Iterator[Picture]:
    """Return pictures of a team's reports, which are there beforehand."""
    onlooker = ExploreOnlooker("bench")
    reports = [each for _, each in zip(range(frames), reported(robots), strict=False)]
    return (onlooker.draw(*onlooker.see(each, {}), Beside()) for each in reports)


@click.command()
@click.option("--robots", type=click.IntRange(1), default=20, show_default=True)
@click.option("--seconds", type=click.FloatRange(min=1.0), default=15.0, show_default=True)
def window(robots: int, seconds: float) -> None:
    """Measure the window's processor time with one page and with three; exit status 0 either way."""
    about, rows = machine.describe(), []
    frames = int((seconds + 1.0) * PER_SECOND) + 2
    for name, shows in (("simulated", simulated), ("on a network", heard)):
        for watchers in (1, 3):
            share, rate, size = measure(shows(robots, frames), name, watchers, seconds)
            verdict = "MET" if share < ASKED else "MISSED"
            asked = (f"< {ASKED:g}", verdict) if watchers == 1 else ("", "")
            rows.append([name, str(watchers), f"{share:.1f}", *asked, f"{rate:.1f}", f"{size:.1f}"])
    header = ["team", "pages", "of a core [%]", "asked", "", "pictures a second", "kB each"]
    click.echo(f"{robots} robots, 1000 x 1000 cells; {about['machine']}; commit {about['commit']}\n")
    click.echo(markdown(header, rows, "lrrllrr"), nl=False)


if __name__ == "__main__":
    command.run(window, "python -m bench.window")
