"""``vedette plot``: the pictures of a run, drawn anew from what it has recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import click

from vedette.cli.options import FILE
from vedette.errors import InputError
from vedette.record.explore.log import ExploreLog
from vedette.record.explore.read import read_scene, read_snapshots
from vedette.record.explore.summary import ExploreSummary
from vedette.record.folder import OutputFolder
from vedette.run.mission import RECORD
from vedette.run.saved import read_figures, read_summary

FILM = "mission.gif"
Draw: TypeAlias = Callable[[Path], None]  # writes a picture there


@click.command()
@click.argument("run", metavar="RUN_DIR", type=FILE)
@click.option("--out", type=FILE, metavar="DIR", help="Folder for the pictures.  [default: RUN_DIR itself]")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.option("--animate", is_flag=True, help="Make a GIF of the mission as well.")
def plot(run: Path, out: Path | None, force: bool, animate: bool) -> None:
    """Draw pictures of a mission, or of what an agent kept, anew: from run.mcap and summary.json in RUN_DIR.

    Pictures that lack what is not recorded, as the truth of a field, the other ways of coordination or when
    maps were joined, are called NAME-recorded.png. Exit status: 0 drawn, 2 bad input.
    """
    from vedette.record.flown import scene_of  # takes a second to import, as drawing does
    from vedette.record.redrawn import flight_pictures

    figures, record = read_figures(run), run / RECORD
    flown = scene_of(record)
    draws = _exploration(run, record, figures) if flown is None else flight_pictures(record, flown, figures)
    if not animate:
        draws.pop(FILM, None)
    elif FILM not in draws:
        raise InputError(f"--animate: {record} has too little in it for a film; leave it out")
    with OutputFolder.make(out or run, force or out is None, "") as folder:
        for name, draw in draws.items():
            draw(folder / name)
        click.echo("pictures: " + ", ".join(str(folder / name) for name in draws))


def _exploration(run: Path, record: Path, figures: Mapping[str, Any]) -> dict[str, Draw]:
    """Return who draws the pictures of an exploration, or of one robot's part in it."""
    from vedette.record.explore.curves import curves_png  # drawing takes a second to import
    from vedette.record.explore.film import explore_gif
    from vedette.record.explore.progress import progress_png

    summary = None if "robot" in figures else read_summary(run, ExploreSummary)
    scene = read_scene(record)
    log = ExploreLog(scene)
    for snapshot in read_snapshots(record, scene):
        log.add(snapshot)
    strangers = (
        summary is not None and summary.frames is not None
    )  # when whose maps were joined is not recorded
    progress = "progress-recorded.png" if strangers else "progress.png"
    draws: dict[str, Draw] = {progress: lambda path: progress_png(log, path)}
    if summary is not None:
        draws["curves.png"] = lambda path: curves_png(log, summary, path)
    return draws | {FILM: lambda path: explore_gif(log, path)}
