"""``vedette plot``: the pictures of a run, drawn anew from what it has recorded."""

from __future__ import annotations

from pathlib import Path

import click

from vedette.cli.options import FILE
from vedette.record.explore.log import ExploreLog
from vedette.record.explore.read import read_scene, read_snapshots
from vedette.record.explore.summary import ExploreSummary
from vedette.record.folder import OutputFolder
from vedette.run.mission import RECORD
from vedette.run.saved import read_summary


@click.command()
@click.argument("run", metavar="RUN_DIR", type=FILE)
@click.option("--out", type=FILE, metavar="DIR", help="Folder for the pictures.  [default: RUN_DIR itself]")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.option("--animate", is_flag=True, help="Make a GIF of the mission as well.")
def plot(run: Path, out: Path | None, force: bool, animate: bool) -> None:
    """Draw the pictures of an exploration anew, from run.mcap and summary.json in RUN_DIR.

    The record has the map every 5 s: pictures of stages show it so old at most. Exit status: 0 drawn, 2 bad
    input.
    """
    from vedette.record.explore.curves import curves_png  # drawing takes a second to import
    from vedette.record.explore.film import explore_gif
    from vedette.record.explore.progress import progress_png

    summary = read_summary(run, ExploreSummary)
    scene = read_scene(run / RECORD)
    log = ExploreLog(scene)
    for snapshot in read_snapshots(run / RECORD, scene):
        log.add(snapshot)
    with OutputFolder.make(out or run, force or out is None, "") as folder:
        progress_png(log, folder / "progress.png")
        curves_png(log, summary, folder / "curves.png")
        if animate:
            explore_gif(log, folder / "mission.gif")
        names = ["progress.png", "curves.png", *(["mission.gif"] if animate else [])]
        click.echo("pictures: " + ", ".join(str(folder / name) for name in names))
