"""The building that the robots are in: walls as a grid for planners, as outlines for bodies and lidars."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

SOLID_BELOW = 128  # grey of a map's image


@dataclass(frozen=True, eq=False)
class Building:
    """Cells of a map_server map; row 0 is the lowest."""

    solid: NDArray[np.bool_]  # (R, C)
    resolution: float  # [m]
    left: float  # of cell (0, 0)'s corner [m]
    lower: float

    @classmethod
    def read(cls, path: Path) -> Building:
        """Read a map_server ``.yaml``."""
        told = yaml.safe_load(path.read_text(encoding="utf-8"))
        grey = np.asarray(Image.open(path.parent / told["image"]).convert("L"))
        return cls(grey[::-1] < SOLID_BELOW, told["resolution"], told["origin"][0], told["origin"][1])

    def outlines(self) -> list[list[list[float]]]:
        """Return the border of what is solid as closed polylines of corners [m]."""
        edges = self._edges()
        loops = []
        while edges:
            start, heads = next(iter(edges.items()))
            corner, back = heads.pop(), None
            loop, at = [start], start
            while True:
                if not heads:
                    del edges[at]
                step = corner[0] - at[0], corner[1] - at[1]
                if back is not None and step == back:
                    loop.pop()
                loop.append(corner)
                at, back = corner, step
                if at == start:
                    break
                heads = edges[at]
                left = at[0] - step[1], at[1] + step[0]  # where four cells meet, stay with the same one
                corner = heads.pop(heads.index(left) if left in heads else 0)
            side = self.resolution
            loops.append([[self.left + x * side, self.lower + y * side] for x, y in loop])
        return loops

    def _edges(self) -> dict[tuple[int, int], list[tuple[int, int]]]:
        """Return where each edge of a solid cell that faces a free one leads, the solid at its left."""
        solid = np.pad(self.solid, 1)
        edges: dict[tuple[int, int], list[tuple[int, int]]] = {}
        sides = (
            ((-1, 0), (0, 0), (1, 0)),  # below: free at row - 1
            ((0, 1), (1, 0), (1, 1)),
            ((1, 0), (1, 1), (0, 1)),
            ((0, -1), (0, 1), (0, 0)),
        )
        for (dr, dc), tail, head in sides:
            free_beside = ~np.roll(solid, (-dr, -dc), (0, 1))
            for row, col in np.argwhere(solid & free_beside) - 1:
                x, y = int(col), int(row)
                edges.setdefault((x + tail[0], y + tail[1]), []).append((x + head[0], y + head[1]))
        return edges
