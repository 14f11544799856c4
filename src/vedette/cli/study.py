"""``vedette study``: compare planners on many worlds."""

from __future__ import annotations

import os
import shlex
import sys
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click
from rich.console import Console

from vedette.cli.ends import aborted
from vedette.cli.options import FILE, OneOf
from vedette.errors import InputError
from vedette.maps import map_files
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
@click.option(
    "--jobs", type=click.IntRange(1, 1024), metavar="N", help="Processes.  [default: one for each core]"
)
@click.option(
    "--backend", type=OneOf(BACKENDS), default="loky", show_default=True,
    help="Where the runs are carried out: on this machine, or on a Dask cluster.",
)  # fmt: skip
def study(spec_name: str, out: Path | None, jobs: int | None, backend: str) -> None:
    """Compare planners on many worlds: SPEC is a YAML file, or the name of a study that comes with Vedette:
    ten-minutes, hundred-minutes, poses-and-views.

    A study that was stopped goes on when it is called again. Exit status: 0 all runs came to an end, 1 some
    broke, 2 bad input, 130 interrupted.
    """
    chosen = cast(Backend, backend)
    if chosen == "dask" and jobs is not None and os.environ.get("DASK_SCHEDULER_ADDRESS"):
        raise InputError("--jobs: the cluster at DASK_SCHEDULER_ADDRESS has workers of its own; leave it out")
    require(chosen)
    path = find_spec(spec_name)
    folder = Path("runs") / f"study-{path.stem}" if out is None else out
    conducted = _conducted(path, folder, jobs or os.cpu_count() or 1, chosen)
    if conducted.results:
        click.echo(_closing(conducted, folder))
    if conducted.missing:
        raise SystemExit(Outcome.INTERRUPTED.status)
    raise SystemExit(BROKE if conducted.broken else 0)


def _conducted(path: Path, folder: Path, jobs: int, backend: Backend) -> Conducted:
    """Conduct a study and write what came out."""
    # These need packages that need not be installed: `require` has seen to it that they are.
    from vedette.study.conduct import conduct
    from vedette.study.outputs import write_outputs
    from vedette.study.store import Store
    from vedette.study.workers import Workers

    spec = load_spec(path)
    runs = runs_of(spec, path)
    made = provenance(
        shlex.join(["vedette", *sys.argv[1:]]), datetime.now().astimezone().isoformat(" ", "seconds")
    )
    store = Store.open(folder, made.code, _inputs(spec, path, folder))
    with locked(folder):
        conducted = conduct(runs, store, Workers(jobs, backend), Console())
        if conducted.results:
            with aborted("not all of the report and its tables is written; what is done is kept"):
                write_outputs(conducted, path, spec.reference or spec.planners[0], folder, made)
    return conducted


def _inputs(spec: Spec, path: Path, folder: Path) -> list[Path]:
    """Return the files that a study reads; its spec may be the one that it left when it was stopped."""
    own = [] if path.resolve() == (folder / COPY).resolve() else [path]
    return [*own, *(file for entry in spec.maps for file in map_files(path.parent / entry.file))]


def _closing(conducted: Conducted, folder: Path) -> str:
    """Say in a few lines what there is, and where."""
    complete = sum(result.figures["completed"] is True for result in conducted.results.values())
    count = len(conducted.results)
    missing = f", {len(conducted.missing)} runs to go" if conducted.missing else ""
    broke = f", {conducted.broken} broke" if conducted.broken else ""
    return (
        f"{count} runs, {complete} of them complete{broke}{missing}\n"
        f"report: {folder / 'report.html'}; tables and pictures beside it"
    )
