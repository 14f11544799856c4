"""Maps that robots have saved, each in a frame of its own, become one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.align import FramePose, charted
from vedette.align.joining import JoinedMaps, joined
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, read_map
from vedette.missions.explore.own_map import OwnMap

MOST_MAPS = 20
MAP = "map.yaml"  # of a run's folder
MAX_SIDE = 16000  # of the merged map [cells]
SEVERAL = 255  # maps know a cell
_BAND = 512  # rows that are laid at once
_PARTS = 2  # samples of a cell along each side, so that turned walls stay closed


@dataclass(frozen=True, eq=False)
class SavedMap:
    """A map as it was read."""

    name: str
    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C)


@dataclass(frozen=True, eq=False)
class Merged:
    """All maps that could be joined, as one in the first one's frame; nothing where some could not."""

    maps: tuple[SavedMap, ...]
    joined: JoinedMaps
    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C)
    whose: NDArray[np.uint8]  # (R, C) the number, from 1 on, of the map that alone knows a cell, or `SEVERAL`


def map_path(path: Path) -> Path:
    """Return the map that a path stands for: that of a run, if it is a run's folder."""
    return path / MAP if path.is_dir() and (path / MAP).is_file() else path


def read(paths: Sequence[Path], resolution: float | None = None) -> tuple[SavedMap, ...]:
    """Read maps; a run's folder stands for the map in it.

    Raises:
        InputError: fewer than two or too many, one cannot be read, or has nothing to be found by.
    """
    if not 2 <= len(paths) <= MOST_MAPS:
        raise InputError(f"vedette merge takes 2 to {MOST_MAPS} maps; got {len(paths)}")
    maps = []
    for path, name in zip(paths, _names(paths), strict=True):
        frame, classes = read_map(map_path(path), resolution)
        if charted(frame, classes) is None:
            lacks = "walls beside free ground" if (classes == FREE).any() else "free ground"
            raise InputError(f"{path} has no {lacks}, so there is nothing to find its place by; leave it out")
        maps.append(SavedMap(name, frame, classes))
    return tuple(maps)


def merge(maps: Sequence[SavedMap], seed: int = 0) -> Merged:
    """Return the maps as one, in the frame and the cells of the first.

    Where some cannot be joined safely the map is the first one's alone; ``joined`` tells which, and why.

    Raises:
        InputError: the merged map would have too many cells.
    """
    made = [charted(each.frame, each.classes) for each in maps]
    found = joined([each for each in made if each is not None], seed)
    poses = found.poses if found.whole else (found.poses[0],)
    placed = [_placed(each, pose) for each, pose in zip(maps, poses, strict=False) if pose is not None]
    frame = _around(maps[0].frame, placed)
    classes, whose = np.zeros(frame.shape, np.uint8), np.zeros(frame.shape, np.uint8)
    for top in range(0, frame.rows, _BAND):
        rows = slice(top, min(top + _BAND, frame.rows))
        classes[rows], whose[rows] = _fused(placed, frame.window(rows, slice(0, frame.cols)))
    return Merged(tuple(maps), found, frame, classes, whose)


def _names(paths: Sequence[Path]) -> list[str]:
    """Return what maps are called: each by its name, or as it was given where others have the same."""
    names = [_name(path) for path in paths]
    return [str(path) if names.count(name) > 1 else name for path, name in zip(paths, names, strict=True)]


def _name(path: Path) -> str:
    """Return what a map is called: as its file, but as its folder where the file is a run's."""
    path = path.resolve()
    return path.parent.name if path.name == MAP else path.stem


def _placed(each: SavedMap, pose: FramePose) -> OwnMap:
    """Return the known part of a map where it lies in the first one's frame."""
    rows, cols = np.nonzero(each.classes != UNKNOWN)
    top, left = int(rows.min()), int(cols.min())
    known = each.classes[top : rows.max() + 1, left : cols.max() + 1]
    side = each.frame.resolution
    corner = np.array([[each.frame.origin_x + left * side, each.frame.origin_y + top * side]])
    x, y = pose.places(corner)[0].tolist()
    return OwnMap(known, side, x, y, pose.angle)


def _around(first: GridFrame, placed: Sequence[OwnMap]) -> GridFrame:
    """Return a frame of the first one's cells around all maps."""
    corners = []
    for each in placed:
        rows, cols = np.array(each.classes.shape) * each.resolution
        edges = np.array([[0.0, 0.0], [cols, 0.0], [0.0, rows], [cols, rows]])
        corners.append(FramePose(each.x, each.y, each.heading).places(edges))
    side, origin = first.resolution, (first.origin_x, first.origin_y)
    low = np.floor((np.vstack(corners).min(axis=0) - origin) / side - 1e-6).astype(int)
    high = np.ceil((np.vstack(corners).max(axis=0) - origin) / side + 1e-6).astype(int)
    cols, rows = (high - low).tolist()
    if max(rows, cols) > MAX_SIDE:
        raise InputError(
            f"the merged map would have {cols}x{rows} cells of {side:g} m; at most {MAX_SIDE} a side: "
            "give the map with the largest cells first"
        )
    x, y = (origin + low * side).tolist()
    return GridFrame(side, rows, cols, x, y)


def _fused(placed: Sequence[OwnMap], band: GridFrame) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return the classes of a band, by what most maps say, of as many a wall; and whose they are."""
    walls, free, whose = (np.zeros(band.shape, np.uint8) for _ in range(3))
    for number, each in enumerate(placed, start=1):
        there = each.bounds(band).extent
        part = band.window(*there)
        if not part.size:
            continue
        classes = _laid(each, part)
        walls[there] += classes == OCCUPIED
        free[there] += classes == FREE
        whose[there] = np.where(classes == UNKNOWN, whose[there], np.where(whose[there], SEVERAL, number))
    classes = np.where(walls >= free, np.uint8(OCCUPIED), np.uint8(FREE))
    return np.where(whose, classes, np.uint8(UNKNOWN)), whose


def _laid(each: OwnMap, part: GridFrame) -> NDArray[np.uint8]:
    """Return the classes of cells under a map; turned ones are sampled finer, so that walls stay closed."""
    if math.remainder(each.heading, math.pi / 2.0) == 0.0:
        return each.laid(part)
    fine = each.laid(part.finer(_PARTS)).reshape(part.rows, _PARTS, part.cols, _PARTS)
    return np.asarray(fine.max(axis=(1, 3)))
