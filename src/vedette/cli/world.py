"""``vedette world``: generate a world and write it as a map."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np

from vedette.cli.options import FILE, OneOf
from vedette.record.folder import OutputFolder
from vedette.sim.worlds import GENERATORS


@click.command()
@click.argument("kind", type=OneOf(list(GENERATORS)))
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Which one to make.")
@click.option("--out", type=FILE, required=True, metavar="DIR", help="New folder for the map.")
@click.option("--width", type=float, default=30.0, show_default=True, help="Size in x [m].")
@click.option("--height", type=float, default=20.0, show_default=True, help="Size in y [m].")
@click.option("--resolution", type=float, default=0.1, show_default=True, help="Side of a cell [m].")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
def world(
    kind: str, seed: int, out: Path, width: float, height: float, resolution: float, force: bool
) -> None:
    """Generate an office, a cave or a maze: DIR gets map.yaml and map.pgm, as ROS map_server reads them,
    and preview.png. The same seed and size give the same world."""
    made = GENERATORS[kind](np.random.default_rng(seed), width, height, resolution)
    with OutputFolder.make(out, force, kind) as folder:
        path = made.save(folder.path)
    free = np.count_nonzero(~made.solid) * resolution**2
    click.echo(
        f"{kind}, seed {seed}: {width:g} x {height:g} m at {resolution:g} m, {free:.0f} m2 free -> {path}"
    )
