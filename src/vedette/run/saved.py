"""What a run has left in its folder, read again: its figures, and its map to go on from."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np

from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.maps import UNKNOWN, read_map
from vedette.missions.explore.own_map import OwnMap
from vedette.record.summary import SCHEMA_VERSION, MissionSummary

SummaryT = TypeVar("SummaryT", bound=MissionSummary)
SUMMARY = "summary.json"


def read_figures(run: Path) -> dict[str, Any]:
    """Return the fields of a run's ``summary.json``.

    Raises:
        InputError: there is none, or it is no summary of this version.
    """
    if run.is_file():
        raise InputError(f"{run} is a file; give the folder of a run")
    path = run / SUMMARY
    with open_input(path, "summary") as file:
        try:
            figures = msgspec.json.decode(file.read(), type=dict[str, Any])
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: not a summary: {error}") from error
    if figures.get("schema_version") != SCHEMA_VERSION:
        told = figures.get("schema_version")
        raise InputError(f"{path}: schema_version is {told}, not {SCHEMA_VERSION}: run the mission again")
    return figures


def read_summary(run: Path, kind: type[SummaryT]) -> SummaryT:
    """Return a run's summary, which is to be of a ``kind``.

    Raises:
        InputError: as ``read_figures``, or it is of another kind of mission.
    """
    figures = read_figures(run)
    wanted = {field.name for field in fields(kind)}
    if missing := sorted(wanted - figures.keys()):
        raise InputError(f"{run / SUMMARY}: {missing[0]} is missing: it is of another kind of mission")
    try:
        return msgspec.convert(figures, kind)
    except msgspec.ValidationError as error:
        raise InputError(f"{run / SUMMARY}: {error}") from error


def seed_of(run: Path) -> int | None:
    """Return the seed of the world that a run was in; None: it does not say.

    Raises:
        InputError: its summary cannot be read.
    """
    return read_figures(run).get("seed") if (run / SUMMARY).exists() else None


def read_saved_map(run: Path, resolution: float) -> OwnMap:
    """Return the map that a run has left, to go on from at a resolution [m].

    Raises:
        InputError: there is none, nothing is known in it, or its cells are larger.
    """
    path = run / "map.yaml"
    frame, classes = read_map(path, takes_resolution=False)
    if not np.any(classes != UNKNOWN):
        raise InputError(f"{path}: nothing is known in it; start without --continue")
    if frame.resolution > resolution * (1.0 + 1e-6):
        raise InputError(
            f"{path}: its cells are {frame.resolution:g} m wide, and the world's {resolution:g} m; a coarser "
            "map cannot be gone on with"
        )
    return OwnMap(classes, frame.resolution, frame.origin_x, frame.origin_y, 0.0)
