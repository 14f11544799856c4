"""How large a world may be, and its metres in cells."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.maps.image import MAX_SIDE

SIDES = (10.0, 400.0)  # accepted [m]
RESOLUTIONS = (0.02, 0.2)  # accepted [m]: doors and passages need some cells


@dataclass(frozen=True)
class WorldScale:
    """Metres to whole cells."""

    resolution: float  # [m]

    def __call__(self, metres: float) -> int:
        """Return the nearest number of cells, halves upwards, at least one."""
        return max(1, int(metres / self.resolution + 0.5 + 1e-9))


def world_frame(width: float, height: float, resolution: float) -> GridFrame:
    """Return the frame of a world ``width`` (x) by ``height`` (y) [m], its lower-left corner the origin.

    Raises:
        InputError: a size out of range, or more cells a side than a map file may have.
    """
    for name, value in (("width", width), ("height", height)):
        check_length(f"{name} of a generated world", value, SIDES)
    check_length("resolution of a world", resolution, RESOLUTIONS)
    rows, cols = round(height / resolution), round(width / resolution)
    check_cells(rows, cols)
    return GridFrame(resolution, rows, cols)


def check_length(what: str, value: float, limits: tuple[float, float]) -> None:
    """Raise InputError for a length out of its limits [m]."""
    low, high = limits
    if not low <= value <= high:
        raise InputError(f"{what} must be {low:g} to {high:g} m; got {value:g}")


def check_cells(rows: int, cols: int) -> None:
    """Raise InputError for more cells a side than a map file may have."""
    if max(rows, cols) > MAX_SIDE:
        raise InputError(
            f"{cols}x{rows} cells are too many, at most {MAX_SIDE} a side; use a coarser resolution"
        )
