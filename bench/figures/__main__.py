"""``python -m bench.figures``: run what the documents quote, record it, and put it into their words."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

from bench import command
from bench.figures.claims import Claim, claims
from bench.figures.missions import MISSIONS, Mission
from bench.figures.record import DOCS, FILE, keep_pictures, load, provenance, save
from bench.figures.run import OUT, carry_out
from vedette.errors import InputError
from vedette.record.files import write_text


@click.command()
@click.argument("names", nargs=-1, type=click.Choice(list(MISSIONS)))
@click.option("--maps", type=Path, metavar="DIR", help="Folder of maps that are no part of the project.")
def figures(names: tuple[str, ...], maps: Path | None) -> None:
    """Run the missions NAMES, or all; write docs/figures.json and their pictures, and reword the documents.

    Of all missions, one whose map is not there keeps the figures that it has.
    Exit status 1 if a document does not say what the figures say.
    """
    about, records = provenance(), load()
    for name in names or MISSIONS:
        click.echo(f"{name}: {MISSIONS[name].command} ...", err=True)
        try:
            made = about | record(MISSIONS[name], maps)
        except InputError as error:
            if names:
                raise
            click.echo(f"{name}: {error}", err=True)
            continue
        click.echo(f"{name}: {made['closing']}")
        before, records = records, records | {name: made}
        save({key: records[key] for key in MISSIONS if key in records})
        reword(claims(before), claims(records))
    unsaid = [claim for claim in claims(records) if not claim.places(_text(claim.document))]
    for claim in unsaid:
        click.echo(f"{claim.document} does not say: {claim.text}", err=True)
    click.echo(f"written: {FILE}")
    raise SystemExit(1 if unsaid else 0)


def record(mission: Mission, maps: Path | None) -> dict[str, Any]:
    """Run a mission; put its pictures into the documents and return what is recorded of it."""
    with TemporaryDirectory(prefix="vedette-figures-") as folder:
        found = carry_out(mission, Path(folder), maps)
        return found | {"pictures": keep_pictures(mission, Path(folder) / OUT)}


def reword(before: Sequence[Claim], after: Sequence[Claim]) -> None:
    """Put claims into the documents, each in the place of the one before."""
    for old, new in zip(before, after, strict=False):  # there were none before a first record
        if old != new:
            write_text(DOCS.parent / new.document, old.replaced(new, _text(new.document)))


def _text(document: str) -> str:
    return (DOCS.parent / document).read_text(encoding="utf-8")


if __name__ == "__main__":
    command.run(figures, "bench.figures")
