"""``vedette world``: make a world and write it as a map, generated or of a recorded building."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np
from click.core import ParameterSource

from vedette.cli.options import FILE, Named, Whole
from vedette.cli.recordings import OF_RECORDINGS, check_in_vain, recording, recording_options
from vedette.errors import InputError
from vedette.maps.world import World
from vedette.record.folder import OutputFolder
from vedette.sim.worlds import WORLD, generated, logged

LOG = "log"
_OF_GENERATED = ("seed", "width", "height")


@click.command()
@click.argument("kind", type=Named(WORLD, beside=(LOG,)))
@click.argument("file", metavar="[FILE]", required=False, type=FILE)
@click.option("--seed", type=Whole(0), default=0, show_default=True, help="Which one to make.")
@click.option("--out", type=FILE, required=True, metavar="DIR", help="New folder for the map.")
@click.option("--width", type=float, default=30.0, show_default=True, help="Size in x [m].")
@click.option("--height", type=float, default=20.0, show_default=True, help="Size in y [m].")
@click.option("--resolution", type=float, default=0.1, show_default=True, help="Side of a cell [m].")
@recording_options
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.pass_context
def world(
    context: click.Context,
    /,
    kind: str,
    file: Path | None,
    seed: int,
    out: Path,
    width: float,
    height: float,
    resolution: float,
    reach: float,
    no_return: str,
    evidence: str | None,
    force: bool,
    **names: str,
) -> None:
    """Make a world: DIR gets map.yaml and map.pgm, as ROS map_server reads them, and preview.png.

    KIND is office, cave or maze, generated: the same seed and size give the same world. Or it is log: the
    building in which FILE was recorded, a CARMEN log, a rosbag2 folder or an MCAP file with scans and TF
    or with a map.
    """
    of_log = kind == LOG
    _refuse(
        context, _OF_GENERATED if of_log else OF_RECORDINGS, "generated worlds" if of_log else "recordings"
    )
    if of_log:
        if file is None:
            raise InputError("vedette world log needs a FILE: a CARMEN log, a rosbag2 folder or an MCAP file")
        check_in_vain([file], evidence, **names)
        made = logged(recording(file, no_return, evidence, **names), resolution, reach, no_return)
    else:
        made = _generated(kind, file, seed, width, height, resolution)
    with OutputFolder.make(out, force, kind, [] if file is None else [file]) as folder:
        path = made.save(folder.path)
    rows, cols = made.frame.shape
    free = np.count_nonzero(~made.solid) * resolution**2
    named = made.name if of_log else f"{kind}, seed {seed}"
    click.echo(
        f"{named}: {cols * resolution:g} x {rows * resolution:g} m at {resolution:g} m, "
        f"{free:.0f} m2 free -> {path}"
    )


def _refuse(context: click.Context, options: tuple[str, ...], others: str) -> None:
    """Refuse options that would be overridden in silence."""
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
        if given and parameter.name in options:
            raise InputError(f"{parameter.opts[0]} is of {others}; leave it out")


def _generated(
    kind: str, file: Path | None, seed: int, width: float, height: float, resolution: float
) -> World:
    if file is not None:
        raise InputError(f"{kind} is generated, without a file; of a recording: vedette world log {file}")
    return generated(kind, seed, width, height, resolution)
