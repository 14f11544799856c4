"""``vedette merge``: maps that robots have saved, each in a frame of its own, become one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from vedette.cli.options import FILE, Positive
from vedette.maps import map_files, write_map
from vedette.record.folder import OutputFolder

if TYPE_CHECKING:
    from vedette.record.merge.summary import PlacedMap
    from vedette.run.merging import Merged

NOT_JOINED = 1


@click.command()
@click.argument("maps", metavar="MAP_A MAP_B ...", nargs=-1, required=True, type=FILE)
@click.option("--out", type=FILE, required=True, metavar="DIR", help="New folder for what comes of it.")
@click.option("--resolution", type=Positive("m"), help="Side of a pixel of images without a .yaml [m].")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.option("--json", "as_json", is_flag=True, help="Print merge.json alone.")
def merge(maps: tuple[Path, ...], out: Path, resolution: float | None, force: bool, as_json: bool) -> None:
    """Find how maps of unknown frames lie on each other, and make one of them, in the frame of the first.

    A MAP is a map_server .yaml, an image, or the folder of a run. DIR gets map.yaml, map.pgm, merge.png, and
    merge.json with each map's place and what it rests on. Maps that look alike in more than one way are not
    joined. Exit status: 0 all are joined, 1 some cannot be joined safely and nothing is written, 2 bad input.
    """
    # who only asks for help does not wait for SciPy
    from vedette.record.merge.summary import MergeSummary
    from vedette.run import merging

    saved = merging.read(maps, resolution)
    merged = merging.merge(saved)
    names = [each.name for each in saved]
    if not merged.joined.whole:
        click.echo(f"vedette: {_refusal(names, merged)}", err=True)
        raise SystemExit(NOT_JOINED)
    inputs = [file for path in maps for file in map_files(merging.map_path(path))]
    with OutputFolder.make(out, force, "merge", inputs) as folder:
        summary = MergeSummary.told(names, merged.joined)
        _draw(names, merged, folder / "merge.png")  # takes a second or two: who interrupts it finds nothing
        write_map(folder / "map", merged.frame, merged.classes)
        summary.write(folder / "merge.json")
        lines = [*map(_line, summary.maps[1:]), f"map and picture: {folder.path}"]
    click.echo(summary.to_json() if as_json else "\n".join(lines), nl=not as_json)


def _refusal(names: list[str], merged: Merged) -> str:
    """Return which maps could not be joined with most others, and why the first of them."""
    doubts = merged.joined.doubts
    odd = ", ".join(name for name, doubt in zip(names, doubts, strict=True) if doubt is not None)
    others = ", ".join(name for name, doubt in zip(names, doubts, strict=True) if doubt is None)
    why = next(doubt for doubt in doubts if doubt is not None)
    return f"no safe match of {odd} with {others}: {why}; nothing is written"


def _line(placed: PlacedMap) -> str:
    """Return where a map lies, in words."""
    found = placed.confidence
    assert found is not None
    off = math.hypot(found.x_deviation_m, found.y_deviation_m)
    return (
        f"{placed.name}: at {placed.x_m:.2f} m, {placed.y_m:.2f} m, turned by {placed.yaw_deg:.2f} degrees "
        f"(within {100.0 * off:.1f} cm), by {found.same_m:.0f} m of walls common with {found.with_map}, "
        f"{found.contradicted:.1%} contradicted"
    )


def _draw(names: list[str], merged: Merged, path: Path) -> None:
    # who only asks for help does not wait for matplotlib
    from vedette.record.merge.picture import merge_png

    merge_png(merged.frame, merged.classes, merged.whose, names, path)
