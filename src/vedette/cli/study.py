"""``vedette study``: compare planners on many worlds."""

from __future__ import annotations

import math
import os
import shlex
import sys
import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click
from rich.console import Console

from vedette.cli.ends import aborted
from vedette.cli.options import FILE, OneOf, Positive, Whole
from vedette.errors import InputError
from vedette.maps import map_files
from vedette.number import many
from vedette.outcome import Outcome
from vedette.record.lock import locked
from vedette.study.backends import BACKENDS, Backend, require
from vedette.study.combinations import runs_of
from vedette.study.provenance import provenance
from vedette.study.spec import COPY, Spec, find_spec, load_spec

if TYPE_CHECKING:
    from vedette.study.conduct import Conducted

BROKE = 1


@click.command()
@click.argument("spec_name", metavar="SPEC")
@click.option("--out", type=FILE, metavar="DIR", help="Folder of the study.  [default: runs/study-SPEC]")
@click.option("--jobs", type=Whole(1, 1024), metavar="N", help="Processes.  [default: one for each core]")
@click.option(
    "--backend", type=OneOf(BACKENDS), default="loky", show_default=True,
    help="Where the runs are carried out: on this machine, or on a Dask cluster.",
)  # fmt: skip
@click.option("--pictures", is_flag=True, help="Draw curves and means, into the report too.")
@click.option("--minutes", type=Positive("min"), help="Begin no run after so long.  [default: do all]")
def study(
    spec_name: str, out: Path | None, jobs: int | None, backend: str, pictures: bool, minutes: float | None
) -> None:
    """Compare planners on many worlds: SPEC is a YAML file, or the name of a study that comes with Vedette:
    ten-minutes, hundred-minutes, poses-and-views.

    A study that was stopped goes on when it is called again. Exit status: 0 all runs came to an end, 1 some
    broke or are still to do, 2 bad input, 130 interrupted.
    """
    chosen = cast(Backend, backend)
    if chosen == "dask" and jobs is not None and os.environ.get("DASK_SCHEDULER_ADDRESS"):
        raise InputError("--jobs: the cluster at DASK_SCHEDULER_ADDRESS has workers of its own; leave it out")
    require(chosen)
    path = find_spec(spec_name)
    folder = Path("runs") / f"study-{path.stem}" if out is None else out
    end = math.inf if minutes is None else time.monotonic() + 60.0 * minutes
    conducted = _conducted(path, folder, jobs or os.cpu_count() or 1, chosen, end, pictures)
    if conducted.interrupted:
        raise SystemExit(Outcome.INTERRUPTED.status)
    raise SystemExit(BROKE if conducted.broken or conducted.missing else 0)


def _conducted(
    path: Path, folder: Path, jobs: int, backend: Backend, end: float, pictures: bool
) -> Conducted:
    """Conduct a study, beginning no run once the monotonic clock is at ``end``, and tell what came out."""
    # These need packages that need not be installed: `require` has seen to it that they are.
    from vedette.study.conduct import conduct
    from vedette.study.outputs import write_outputs
    from vedette.study.ratios import ratios
    from vedette.study.rows import figure_rows
    from vedette.study.store import Store
    from vedette.study.workers import Workers

    spec = load_spec(path)
    runs = runs_of(spec, path)
    made = provenance(
        shlex.join(["vedette", *sys.argv[1:]]), datetime.now().astimezone().isoformat(" ", "seconds")
    )
    store = Store.open(folder, made.code, _inputs(spec, path, folder))
    with locked(folder):
        workers = Workers(jobs, backend, over=lambda: time.monotonic() >= end)
        conducted = conduct(runs, store, workers, Console())
        if conducted.results:
            reference = spec.reference or spec.planners[0]
            with aborted("not all of the report and its tables is written; what is done is kept"):
                write_outputs(conducted, path, reference, folder, made, pictures=pictures)
            beside = "tables and pictures" if pictures else "tables"
            lines = [_counts(conducted), *ratios(figure_rows(conducted.results), reference)]
            click.echo("\n".join([*lines, f"report: {folder / 'report.html'}; {beside} beside it"]))
    return conducted


def _inputs(spec: Spec, path: Path, folder: Path) -> list[Path]:
    """Return the files that a study reads; its spec may be the one that it left when it was stopped."""
    own = [] if path.resolve() == (folder / COPY).resolve() else [path]
    return [*own, *(file for entry in spec.maps for file in map_files(path.parent / entry.file))]


def _counts(conducted: Conducted) -> str:
    """Say how many runs there are, and how they went."""
    complete = sum(result.figures["completed"] is True for result in conducted.results.values())
    count = len(conducted.results)
    missing = f", {many(len(conducted.missing), 'run')} to go" if conducted.missing else ""
    broke = f", {conducted.broken} broke" if conducted.broken else ""
    return f"{many(count, 'run')}, {complete} of them complete{broke}{missing}"
