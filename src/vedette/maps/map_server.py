"""Read and write maps as ROS map_server does: a ``.yaml`` beside an image, or an image alone."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from vedette.errors import InputError, InputWarning, nearest_name
from vedette.maps.atomic import atomic_path
from vedette.maps.classes import classes_of_pair, classes_of_plain
from vedette.maps.frame import GridFrame
from vedette.maps.image import read_levels
from vedette.maps.meta import checked_resolution, read_meta
from vedette.maps.turned import upright

_OF_A_RUN, _A_MAP = "map.yaml", "a map's .yaml or an image"
_PIXELS = {  # grey level of UNKNOWN, FREE and OCCUPIED, as map_saver writes them
    "trinary": np.array([205, 254, 0], np.uint8),
    "raw": np.array([255, 0, 100], np.uint8),
}


def read_map(
    path: Path | str, resolution: float | None = None, *, takes_resolution: bool = True
) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Read a map_server pair (give its ``.yaml``) or a plain image, whose pixels >= 128 are free.

    Args:
        path: ``.yaml``, or an image (PGM, PNG, BMP, JPEG). Transparent pixels of a plain image are unknown.
        resolution: side of a pixel [m]; needed for a plain image, overrides that of a pair.
        takes_resolution: whoever named the path could have given one by ``--resolution``.

    Returns:
        The frame and the cell classes ``uint8[rows, cols]``, row 0 the lowest y: the image's last row, unless
        the origin has a yaw, by which the map is then turned (:func:`vedette.maps.turned.upright`).

    Raises:
        InputError: the path is missing, a folder, unreadable or not a map, or a value in it is out of range.

    Warns:
        InputWarning: grey that map savers write for unknown is free, the yaw is more than a whole turn, or
            ``resolution`` overrides another.
    """
    path = Path(path)
    if resolution is not None:
        resolution = checked_resolution(resolution, "--resolution")
    if path.is_dir():
        inside = path / _OF_A_RUN
        raise InputError(f"{path} is a folder; give {inside if inside.is_file() else _A_MAP}")
    if not _is_pair(path):
        return _read_plain(path, resolution, takes_resolution)
    meta = read_meta(path)
    if resolution is not None and meta.resolution not in (None, resolution):
        said = f"resolution {resolution:g} replaces that of {path}, {meta.resolution:g} m"
        warnings.warn(said, InputWarning, stacklevel=2)
    resolution = resolution if resolution is not None else meta.resolution
    if resolution is None:
        option = " or give --resolution" if takes_resolution else ""
        raise InputError(f"{path}: no resolution; add 'resolution: 0.05' [m per pixel]{option}")
    try:
        levels = read_levels(meta.image)
    except InputError as error:
        raise InputError(f"{path}: image: {error}") from error
    return upright(classes_of_pair(meta, levels), resolution, meta.origin)


def map_files(path: Path) -> tuple[Path, ...]:
    """Return the files that :func:`read_map` reads for a path: a ``.yaml`` has an image.

    Raises:
        InputError: as :func:`read_map`.
    """
    return (path, read_meta(path).image) if _is_pair(path) else (path,)


def write_map(stem: Path | str, frame: GridFrame, classes: NDArray[np.uint8], mode: str = "trinary") -> None:
    """Write ``stem.pgm`` and ``stem.yaml``, which map_server and :func:`read_map` load to the same classes.

    Args:
        stem: path without suffix.
        frame: of the classes.
        classes: ``uint8[rows, cols]``.
        mode: ``trinary`` (free 254, unknown 205, occupied 0) or ``raw`` (0, 255, 100).

    Raises:
        InputError: unknown mode, or the folder cannot be written to.
    """
    if mode not in _PIXELS:
        raise InputError(f"cannot write a map in mode {mode!r}; {nearest_name(mode, _PIXELS)}")
    if classes.shape != frame.shape:
        raise ValueError(f"classes are {classes.shape}, the frame is {frame.shape}")
    image = Path(f"{stem}.pgm")
    pixels = _PIXELS[mode][classes[::-1]]
    with atomic_path(image) as temporary:
        temporary.write_bytes(b"P5\n%d %d\n255\n" % (frame.cols, frame.rows) + pixels.tobytes())
    with atomic_path(f"{stem}.yaml") as temporary:  # last: a .yaml never stands without its image
        temporary.write_text(
            f"image: {_quoted(image.name)}\n"
            f"mode: {mode}\n"
            f"resolution: {frame.resolution!r}\n"
            f"origin: [{frame.origin_x!r}, {frame.origin_y!r}, 0.0]\n"
            "negate: 0\n"
            "occupied_thresh: 0.65\n"
            "free_thresh: 0.196\n",  # grey 205 is 0.19608 occupied: just not free
            encoding="utf-8",
        )


def _is_pair(path: Path) -> bool:
    return path.suffix.lower() in (".yaml", ".yml")


def _read_plain(
    path: Path, resolution: float | None, takes_resolution: bool
) -> tuple[GridFrame, NDArray[np.uint8]]:
    levels = read_levels(path)
    if resolution is None:
        pair = path.with_suffix(".yaml")
        remedies = [f"give {pair.name} instead"] if pair.is_file() else []
        if takes_resolution:
            remedies.append("add --resolution [m per pixel]")
        remedy = ", or ".join(remedies) or f"write {pair.name}, which says it, and give that"
        raise InputError(f"{path}: an image alone has no resolution; {remedy}")
    rows, cols = levels.grey.shape
    return GridFrame(resolution, rows, cols), classes_of_plain(path, levels)


def _quoted(name: str) -> str:
    text: str = yaml.safe_dump(name, default_style='"', allow_unicode=True, width=10**6)
    return text.strip()
