"""Where one robot can drive on the team's newest map, and the shortest way to a place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Route
from vedette.domains.mapping.stops import CLEARANCES, Disc, block
from vedette.fusion import Fusion
from vedette.kernels import distance, frontier
from vedette.kernels.tiles import TiledGrid
from vedette.maps import FREE
from vedette.maps.bounds import Extent
from vedette.maps.lattice import Lattice
from vedette.maps.leave import Leave
from vedette.missions.explore.doubts import Doubts

JOIN = 4  # cells beyond what is known from which a robot or a goal still joins it
Place = tuple[float, float]  # x, y [m], team frame
Ground = tuple[Extent, NDArray[np.bool_]]  # where a robot's centre may be of some rows and columns


@dataclass(eq=False)
class Ways:
    """The ground that one robot can drive on, worked out anew when the team's map has changed."""

    lattice: Lattice
    radius: float  # of the robot [m]
    fusion: Fusion
    log_odds: TiledGrid[np.int8]  # own evidence
    doubts: Doubts
    leave: Leave  # where the team may work
    _ground: dict[float, tuple[int, Ground]] = field(default_factory=dict)  # by clearance, as of a digest

    def find(self, start: Place, goal: Place, discs: Sequence[Disc], daring: bool) -> Route | None:
        """Return the shortest way, straightened; a narrow one only where there is no wider one, else None.

        ``discs`` stand in the way. ``daring``: where no way is left, those that doubtful cells alone close.
        """
        for clearance, (extent, passable) in self._grounds(daring):
            frame = self.lattice.frame.window(*extent)
            if discs:
                passable = passable.copy()
            for disc in discs:
                block(passable, frame, disc, self.radius + clearance)
            source, target = self._cell(*start, extent), self._cell(*goal, extent)
            cells = distance.shortest_path(passable, source, target, frame.resolution)
            if len(cells):
                path = self.lattice.frame.centres(self._in_all(distance.shortcut(passable, cells), extent))
                path[0] = start
                return Route(path, passable, frame, clearance)
        return None

    def out(self, start: Place) -> Route | None:
        """Return the shortest way out of where nobody may be any more; None: the robot is not in there."""
        if not self.leave.no_go:
            return None
        extent = self._around_known
        frame, clearance = self.lattice.frame.window(*extent), CLEARANCES[-1]
        forbidden = frame.centres(np.flatnonzero(self.leave.forbidden(frame)))
        if not len(forbidden) or np.hypot(*(forbidden - start).T).min() > self.radius:
            return None
        classes = self.fusion.classes.window(*extent)
        around = frontier.traversable(
            Leave(self.leave.area).close(classes, frame), self.radius + clearance, frame.resolution
        )
        _, allowed = self._traversable(classes, extent, clearance)
        field = distance.distance_field(around, self._cell(*start, extent), frame.resolution)
        away = np.where(allowed, field, np.inf)
        if not np.isfinite(away.min()):
            return None
        cells = distance.path_to(field, around, int(away.argmin()))
        path = self.lattice.frame.centres(self._in_all(distance.shortcut(around, cells), extent))
        path[0] = start
        return Route(path, around, frame, clearance)

    def forget(self) -> None:
        """Work the ground out anew: the team may work elsewhere now."""
        self._ground.clear()

    def _grounds(self, daring: bool) -> Iterator[tuple[float, Ground]]:
        """Yield clearances and where they let the robot's centre be, the widest first, the doubtful last."""
        for clearance in CLEARANCES:
            yield clearance, self._passable_now(clearance)
        if daring:
            yield CLEARANCES[-1], self._passable_daring(CLEARANCES[-1])

    def _cell(self, x: float, y: float, extent: Extent) -> int:
        """Return the flat cell of a part of the grid that a point lies in or is nearest to."""
        (row, col), (rows, cols) = self.lattice.frame.cell(x, y), extent
        row, col = min(max(row, rows.start), rows.stop - 1), min(max(col, cols.start), cols.stop - 1)
        return int((row - rows.start) * (cols.stop - cols.start) + col - cols.start)

    def _in_all(self, cells: NDArray[np.int64], extent: Extent) -> NDArray[np.int64]:
        """Return flat cells of a part of the grid as those of all of it."""
        rows, cols = extent
        row, col = np.divmod(cells, cols.stop - cols.start)
        flat: NDArray[np.int64] = (row + rows.start) * self.lattice.frame.cols + col + cols.start
        return flat

    def _passable_now(self, clearance: float) -> Ground:
        """Return where the robot's centre may be; nowhere else."""
        digest = self.fusion.digest
        if clearance not in self._ground or self._ground[clearance][0] != digest:
            extent = self._around_known
            classes = self.fusion.classes.window(*extent)
            self._ground[clearance] = digest, self._traversable(classes, extent, clearance)
        return self._ground[clearance][1]

    def _passable_daring(self, clearance: float) -> Ground:
        extent = self._around_known
        classes, own = self.fusion.classes.window(*extent), self.log_odds.window(*extent)
        doubtful = self.doubts.about(classes, own, self.lattice.frame.window(*extent))
        return self._traversable(np.where(doubtful, np.uint8(FREE), classes), extent, clearance)

    @property
    def _around_known(self) -> Extent:
        """Rows and columns of what the team knows, and as far beyond as a robot or a goal still joins it."""
        rows, cols = (
            slice(max(0, known.start - JOIN), min(size, known.stop + JOIN))
            for known, size in zip(self.fusion.known, self.lattice.frame.shape, strict=True)
        )
        return rows, cols

    def _traversable(self, classes: NDArray[np.uint8], extent: Extent, clearance: float) -> Ground:
        """Return where the robot's centre may be on a map of some rows and columns; never beside the area."""
        frame = self.lattice.frame
        if self.leave:
            classes = self.leave.close(classes, frame.window(*extent))
        return extent, frontier.traversable(classes, self.radius + clearance, frame.resolution)
