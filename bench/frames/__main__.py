"""``python -m bench.frames``: pairs of maps, joined or not, against how much they have in common."""

from __future__ import annotations

from pathlib import Path

import click

from bench import command, journal
from bench.frames.pairs import Pair, Sources
from bench.frames.picture import curve_png
from bench.frames.tables import tables
from bench.frames.trial import Trial, tried
from bench.machine import commit
from vedette.record.files import write_text

SORTS = ("one", "two", "alike")


@click.command()
@click.option(
    "--pairs", type=command.WholeNumbers(0), default="0-99", show_default=True, help="Of each sort."
)
@click.option(
    "--sorts", default=",".join(SORTS), show_default=True, help="one place, two places, look-alikes."
)
@click.option("--maps", type=Path, metavar="DIR", help="Folder of floors, map_server pairs.")
@click.option("--logs", type=Path, metavar="DIR", help="Folder of CARMEN logs, *.log.gz.")
@command.out_option("results and tables")
def frames(pairs: tuple[int, ...], sorts: str, maps: Path | None, logs: Path | None, out: Path) -> None:
    """Judge pairs of maps; those that are in the results file already are not judged again."""
    folder = command.results_folder(out)
    results = folder / "frames.jsonl"
    sources = Sources(_files(maps, "*.yaml"), _files(logs, "*.log.gz"))
    done = dict(journal.read(results, Trial))
    at = commit()
    for number in pairs:
        for sort in sorts.split(","):
            if (sort, number) in done:
                continue
            trial = tried(sort, number, _pair(sources, sort, number), at)
            if trial is not None:
                journal.append(results, trial)
                done[trial.key] = trial
    trials = list(done.values())
    write_text(folder / "frames.md", tables(trials))
    curve_png(trials, folder / "frames.png")
    click.echo(tables(trials))


def _files(folder: Path | None, pattern: str) -> tuple[Path, ...]:
    return () if folder is None else tuple(sorted(folder.glob(pattern)))


def _pair(sources: Sources, sort: str, number: int) -> Pair:
    match sort:
        case "one":
            return sources.two_of_one(number, sources.places[number % len(sources.places)])
        case "two":
            return sources.two_places(number)
        case "alike":
            return sources.two_alike(number)
        case _:
            raise click.BadParameter(f"--sorts are {', '.join(SORTS)}; got {sort!r}")


if __name__ == "__main__":
    command.run(frames, "bench.frames")
