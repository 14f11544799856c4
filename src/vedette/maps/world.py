"""The world that simulated robots move in: a grid of solid and free cells."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vedette.errors import InputError
from vedette.kernels.distance import distance_field
from vedette.kernels.frontier import traversable
from vedette.maps import FREE, OCCUPIED, GridFrame, read_map, write_map
from vedette.maps.area import Area
from vedette.maps.atomic import atomic_path


@dataclass(frozen=True, eq=False)
class World:
    """What is solid, to robots and beams alike; everything outside the grid is solid too."""

    frame: GridFrame
    solid: NDArray[np.bool_]  # (rows, cols)
    name: str

    @classmethod
    def from_map(cls, path: Path | str, resolution: float | None = None) -> World:
        """Read a world from a map_server pair or an image; occupied and unknown cells are solid.

        Raises:
            InputError: as :func:`vedette.maps.read_map`, or no cell is free.
        """
        frame, classes = read_map(path, resolution)
        solid = classes != FREE
        if solid.all():
            raise InputError(f"{path} has no free space; check negate and the thresholds, or draw some white")
        path = Path(path).resolve()
        return cls(frame, solid, path.parent.name if path.stem == "map" else path.stem)

    def classes(self) -> NDArray[np.uint8]:
        """Return the true map: FREE or OCCUPIED for each cell."""
        return np.where(self.solid, np.uint8(OCCUPIED), np.uint8(FREE))

    def within(self, area: Area | None) -> World:
        """Return the world that is left of it to a team: solid wherever the ground is not the team's."""
        if area is None:
            return self
        return World(self.frame, self.solid | ~area.holds(self.frame), self.name)

    def save(self, folder: Path | str) -> Path:
        """Write ``map.yaml``, ``map.pgm`` and ``preview.png`` into an existing folder; return the ``.yaml``.

        Raises:
            InputError: the folder cannot be written to.
        """
        folder = Path(folder)
        write_map(folder / "map", self.frame, self.classes())
        grey = np.where(self.solid[::-1], np.uint8(40), np.uint8(250))
        scale = max(1, 1000 // max(self.frame.shape))
        with atomic_path(folder / "preview.png") as temporary:
            Image.fromarray(grey.repeat(scale, axis=0).repeat(scale, axis=1)).save(temporary)
        return folder / "map.yaml"


def standable(world: World, radius: float) -> NDArray[np.bool_]:
    """Return ``bool[rows, cols]``: cells at whose centre a disc of ``radius`` [m] touches nothing solid."""
    return traversable(world.classes(), radius, world.frame.resolution)


def reachable_poses(world: World, radius: float, x: float, y: float) -> NDArray[np.bool_]:
    """Return ``bool[rows, cols]``: cells to whose centre a disc of ``radius`` can drive from ``(x, y)``.

    Moves are between neighbouring cell centres, eight ways, without cutting corners. ``(x, y)`` [m, team
    frame] lies in the grid; from between the centres the disc first moves to one within three cells.
    """
    cells = standable(world, radius)
    field = distance_field(cells, world.frame.flat(x, y), world.frame.resolution)
    return np.isfinite(field) & cells
