"""``vedette replay``: let recorded data go through a team's agents."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

from vedette.cli.ends import telling_what_is_missing
from vedette.cli.options import FILE, OneOf, Share, Whole
from vedette.cli.recordings import check_in_vain, recording, recording_options
from vedette.domains.mapping.sightings import empty_counts
from vedette.errors import InputError
from vedette.interrupt import ending_on_ctrl_c
from vedette.logs import RecordedLog
from vedette.maps import write_map
from vedette.missions.explore.assemble import FUSIONS
from vedette.missions.explore.options import FRAMES
from vedette.number import many
from vedette.outcome import Outcome
from vedette.record.explore.frames import FramesFound
from vedette.record.folder import OutputFolder
from vedette.record.replay.summary import Replayed, ReplayedBuilding, ReplaySummary
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.replay.run import Replay, ReplaySetup
from vedette.sim.worlds import office
from vedette.team import PlatformSpec

MOST_ROBOTS = 64
OBSERVATION = "observation"
SIMULATED = "generated office, the same lidar"
_MISSION = 120.0  # of the simulated robots whose scans are set beside the recorded ones [s]


@click.command()
@click.argument("files", metavar="LOG...", nargs=-1, required=True, type=FILE)
@click.option(
    "--robots",
    type=Whole(1, MOST_ROBOTS),
    default=1,
    show_default=True,
    help="Cut each log into so many shares, one robot each.",
)
@click.option(
    "--frames",
    type=OneOf(FRAMES),
    default="known",
    show_default=True,
    help="unknown: each share lies in a frame of its own, and the team finds how they lie.",
)
@click.option("--resolution", type=float, default=0.1, show_default=True, help="Side of a cell [m].")
@recording_options
@click.option(
    "--fusion",
    type=OneOf(list(FUSIONS)),
    default="replicated",
    show_default=True,
    help="How the robots share what they see.",
)
@click.option("--link-loss", type=Share(0.9), default=0.0, show_default=True, help="Share of messages lost.")
@click.option("--seed", type=Whole(0), default=0, show_default=True, help="Of lost messages and of frames.")
@click.option(
    "--out", type=FILE, metavar="DIR", help="Folder for the results.  [default: a new one under runs/]"
)
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary alone, as JSON.")
def replay(
    files: tuple[Path, ...],
    robots: int,
    frames: str,
    resolution: float,
    reach: float,
    no_return: str,
    evidence: str | None,
    fusion: str,
    link_loss: float,
    seed: int,
    out: Path | None,
    force: bool,
    as_json: bool,
    **names: str,
) -> None:
    """Let each LOG go through one agent, or in shares through several: a lidar log in the format of CARMEN,
    a rosbag2 folder, or an MCAP file with scans and TF or with a map.

    The agents map, fuse and plan as on a robot; where it goes is the log's. Left are each building's map, and
    what its scans saw of the unknown, against distance, beside simulated ones (the paper's Fig. 3).
    Exit status: 0 all went through, 2 bad input, 130 interrupted.
    """
    setup = ReplaySetup(
        robots, resolution, reach, no_return, fusion=fusion, link_loss=link_loss, seed=seed, frames=frames
    )
    check_in_vain(files, evidence, **names)
    logs = [recording(path, no_return, evidence, **names) for path in files]
    _check_names(logs)
    replays = [Replay(log, setup) for log in logs]
    maps = [f"{log.name}.{ending}" for log in logs for ending in ("yaml", "pgm", "png")]
    leaves = ["summary.json", *([f"{OBSERVATION}.png"] if any(log.scans for log in logs) else []), *maps]
    with OutputFolder.make(out, force, "replay", files) as folder, telling_what_is_missing(folder, leaves):
        done = _run(replays, Console(stderr=True))
        summary = ReplaySummary(buildings=tuple(map(ReplayedBuilding.of, done)))
        summary.write(folder / "summary.json")
        _draw(done, folder)
        if measured := any(not each.maps for each in done):
            _measure(replays, done, folder)
        click.echo(summary.to_json() if as_json else _closing(summary, folder.path, measured), nl=not as_json)
    if not all(building.complete for building in summary.buildings) or len(done) < len(replays):
        raise SystemExit(Outcome.INTERRUPTED.status)


def _check_names(logs: list[RecordedLog]) -> None:
    names = [log.name for log in logs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two logs are called {name}; their maps would be one file: replay them apart")
        if name == OBSERVATION:
            raise InputError(
                f"a log called {name} would have the picture of what all logs' scans see: rename it"
            )


def _run(replays: list[Replay], console: Console) -> list[Replayed]:
    """Replay one after the other; the first Ctrl-C keeps what has come of it."""
    stopped = False

    def stop() -> None:
        nonlocal stopped
        stopped = True
        for each in replays:
            each.stop()

    done: list[Replayed] = []
    columns = TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %")
    with ExitStack() as entered:
        entered.enter_context(ending_on_ctrl_c(stop))
        bar = entered.enter_context(Progress(*columns, console=console, disable=not console.is_terminal))
        for each in replays:
            if stopped:
                break
            task = bar.add_task(each.log.name, total=1.0)
            done.append(each.run(partial(_show, bar, task)))
    return done


def _show(bar: Progress, task: TaskID, share: float) -> None:
    bar.update(task, completed=share)


def _simulated(spec: PlatformSpec) -> NDArray[np.int64]:
    """Return the counts of three simulated robots with such a lidar in a generated office."""
    world = office(np.random.default_rng(0))
    specs = [replace(spec, name=f"robot-{number}") for number in (1, 2, 3)]
    simulation = prepare(world, specs, ExploreSetup(max_time=_MISSION))
    explore(simulation)
    return sum((mission.own.counts for mission in simulation.missions), empty_counts())


def _draw(done: list[Replayed], folder: OutputFolder) -> None:
    # who only asks for help does not wait for matplotlib
    from vedette.record.replay.pictures import map_png

    for each in done:
        write_map(folder / each.name, each.frame, each.classes)
        map_png(each, folder / f"{each.name}.png")


def _measure(replays: list[Replay], done: list[Replayed], folder: OutputFolder) -> None:
    """Draw what scans saw of the unknown, beside what simulated ones with the same lidar see."""
    from vedette.record.replay.pictures import observation_png

    scanned = [each for each in done if not each.maps]
    first = next(each for each in replays if each.log.scans)
    simulated = {SIMULATED: _simulated(first.specs[0])}
    observation_png(scanned, simulated, folder / f"{OBSERVATION}.png")


def _closing(summary: ReplaySummary, folder: Path, measured: bool) -> str:
    lines = []
    for each in summary.buildings:
        team = many(len(each.robots), "robot")
        seen = many(each.maps, "map") if each.maps else many(each.scans, "scan")
        whole = each.frames is None or len(each.frames.components) == 1
        agree = ", all of one map" if each.agreed and whole else "" if each.agreed else ", their maps differ"
        agree = "" if len(each.robots) == 1 else agree
        lines.append(
            f"{each.log}: {seen} over {each.way_m:.0f} m, {each.known_m2:.0f} m2 known, "
            f"{each.free_m2:.0f} m2 free, {team}{agree}{_joined(each.frames)}"
        )
    shown = f"; what scans see: {folder / OBSERVATION}.png" if measured else ""
    return "\n".join([*lines, f"maps and pictures: {folder}{shown}"])


def _joined(found: FramesFound | None) -> str:
    """Return who is joined, and how well."""
    return "" if found is None or not found.said else f", {found.said}"
