"""Who stands idle while there is work that nobody has: measured from outside, against the true world.

Idle is who stays where it is, whatever it says it does. Work is a frontier that is really worth a look:
beside it, much is unknown that a robot could see. It is nobody's if nobody is on its way to a place near it,
or to one from which what is beside it is expected to be seen.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.platform import SAME_PLACE
from vedette.domains.mapping.stops import CLEARANCES
from vedette.kernels import distance, frontier
from vedette.maps import FREE, UNKNOWN
from vedette.record.explore.score import Reference
from vedette.record.explore.views import RobotView, union_map
from vedette.sim.explore.simulation import ExploreSimulation

STAYS = 0.3  # a robot still within this of where it was has not gone anywhere [m]
BESIDE = 0.6  # from a frontier's cells [m]
WORTH = 0.5  # unknown area beside a frontier that could be seen, at least [m^2]
MISSES = 11  # [1/16 nat] what is missed less likely than by half
EVERYWHERE = np.ones((3, 3), np.bool_)


@dataclass
class Idleness:
    """Times for which robots have stayed where they were, with work about that nobody had; by looks."""

    simulation: ExploreSimulation
    longest: float = 0.0  # [s], of any robot
    covered: int = 0  # cells that can be seen and are known
    _reference: Reference = field(init=False)
    _where: NDArray[np.float64] = field(init=False)  # (n, 2) where each robot began to stay [m]
    _since: NDArray[np.float64] = field(init=False)  # (n,) [s]

    def __post_init__(self) -> None:
        simulation = self.simulation
        self._reference = Reference(simulation.world, simulation.specs, simulation.starts)
        self._where = simulation.starts[:, :2].copy()
        self._since = np.zeros(len(self._where))

    def look(self, now: float, views: list[RobotView]) -> None:
        """Take in how things stand at a time [s]."""
        classes = union_map(views, self.simulation.world.frame)
        work = self.work(views)
        self.covered = int(np.count_nonzero(self._reference.coverable & (classes != UNKNOWN)))
        radii = {spec.radius for spec in self.simulation.specs}
        open_to = {radius: self._passable(classes, radius) for radius in radii}
        for i, view in enumerate(views):
            here = np.array((view.sample.x, view.sample.y))
            agent = self.simulation.agents[i]
            away = np.hypot(*(here - self._where[i])) > STAYS
            if away or not view.sample.alive or agent.finished or not self._has(work, open_to, here, i):
                self._where[i], self._since[i] = here, now
        self.longest = max(self.longest, float(np.max(now - self._since)))

    def work(self, views: list[RobotView]) -> NDArray[np.bool_]:
        """Return the cells, ``(R, C)``, of frontiers that are worth a look and nobody's."""
        frame = self.simulation.world.frame
        classes = union_map(views, frame)
        seeable = self._reference.coverable & (classes == UNKNOWN)
        edge: NDArray[np.bool_] = (classes == FREE) & ndimage.binary_dilation(seeable, EVERYWHERE)
        labels, count = ndimage.label(edge, EVERYWHERE)
        nobodys = np.zeros(edge.shape, np.bool_)
        if not count:
            return nobodys
        unexpected = seeable & ~self._expected()
        reach = round(BESIDE / frame.resolution)
        for label, box in enumerate(ndimage.find_objects(labels), start=1):
            near = tuple(slice(max(part.start - reach, 0), part.stop + reach) for part in box)
            cells = labels[near] == label
            beside = ndimage.binary_dilation(cells, EVERYWHERE, iterations=reach)
            area = np.count_nonzero(beside & unexpected[near]) * frame.resolution**2
            if area >= WORTH and not self._headed_for(cells, near):
                nobodys[near] |= cells
        return nobodys

    def _expected(self) -> NDArray[np.bool_]:
        """Return the cells that somebody is on its way to see, surely enough."""
        frame = self.simulation.world.frame
        factor = planning_factor(frame.resolution)
        coarse = frame.coarse(factor)
        seen = np.zeros(coarse.shape, np.bool_)
        for i in self.simulation.living:
            mission = self.simulation.missions[i]
            if len(mission.strategy) and mission.platform.stops is not None:
                marks, stop = mission.platform.stops.footprints, mission.strategy.stops[0]
                row = slice(marks.starts[stop], marks.starts[stop + 1])
                cells = marks.cells[row][marks.misses[row] >= MISSES]
                places = mission.frame.coarse(factor).centres(cells.astype(np.int64))
                corner = np.array((coarse.origin_x, coarse.origin_y))
                cols, rows = np.floor((places - corner) / coarse.resolution).astype(int).T
                seen[rows.clip(0, coarse.rows - 1), cols.clip(0, coarse.cols - 1)] = True
        whole = seen.repeat(factor, axis=0).repeat(factor, axis=1)
        return whole[: frame.rows, : frame.cols]

    def _headed_for(self, cells: NDArray[np.bool_], near: tuple[slice, ...]) -> bool:
        """Tell whether a living robot is on its way to a frontier near any of the cells."""
        frame, living = self.simulation.world.frame, self.simulation.living
        tours = [self.simulation.missions[i].strategy for i in living]
        stops = np.concatenate([tour.targets[:1] for tour in tours])
        row, col = np.nonzero(cells)
        x = frame.origin_x + (col + near[1].start + 0.5) * frame.resolution
        y = frame.origin_y + (row + near[0].start + 0.5) * frame.resolution
        return any(np.hypot(x - u, y - v).min() <= SAME_PLACE for u, v in stops.tolist())

    def _passable(self, classes: NDArray[np.uint8], radius: float) -> NDArray[np.bool_]:
        """Return where the known map lets a disc be."""
        resolution = self.simulation.world.frame.resolution
        return frontier.traversable(classes, radius + CLEARANCES[-1], resolution)

    def _has(
        self,
        work: NDArray[np.bool_],
        open_to: dict[float, NDArray[np.bool_]],
        here: NDArray[np.float64],
        i: int,
    ) -> bool:
        """Tell whether a robot can get to any of the work on the known map, were it alone."""
        if not work.any():
            return False
        frame, passable = self.simulation.world.frame, open_to[self.simulation.specs[i].radius]
        to_all = distance.distance_field(passable, frame.flat(*here), frame.resolution)
        ways = ndimage.binary_dilation(
            np.isfinite(to_all), EVERYWHERE, iterations=round(BESIDE / frame.resolution)
        )
        return bool((ways & work).any())
