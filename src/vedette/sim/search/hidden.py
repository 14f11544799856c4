"""The true target of a search, and the vehicles that look for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.agent.body import TICK
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import Detector
from vedette.missions.search.case import SearchCase
from vedette.missions.search.searching import Looks
from vedette.outcome import Outcome
from vedette.sim.simulation import random_streams
from vedette.sim.vehicles import Vehicles

_GONE = np.full(2, np.nan)  # where no sensor detects anything


def draw_places(pdf: TargetPdf, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw places ``(count, 2)`` [m] from a pdf, anywhere in their cells alike."""
    cells = rng.choice(pdf.frame.size, count, p=pdf.mass.ravel())
    within: NDArray[np.float64] = pdf.frame.resolution * (rng.random((count, 2)) - 0.5)
    places: NDArray[np.float64] = pdf.frame.centres(cells) + within
    return places


class Hidden:
    """The true target, step by step: where it is and what sensors tell of it.

    Chance comes from one stream for the target and one for each sensor: teams that behave differently look
    for the same target.
    """

    def __init__(
        self,
        pdf: TargetPdf,
        start: ArrayLike | None,
        detectors: Sequence[Detector],
        rng: np.random.Generator,
        sensor_rngs: Sequence[np.random.Generator],
    ) -> None:
        """Put the target at ``start`` (2,) [m], or where the pdf says that it may be."""
        self._pdf, self._detectors = pdf, tuple(detectors)
        self._rng, self._sensor_rngs = rng, tuple(sensor_rngs)
        drawn = draw_places(pdf, 1, rng)  # drawn always: the way is the same wherever it starts
        self._places: list[NDArray[np.float64]] = [drawn if start is None else np.array([start], np.float64)]

    @classmethod
    def of(cls, case: SearchCase, seed: int) -> Hidden:
        """Return the target of a search, the same for everybody who simulates a part of it."""
        rng, streams = np.random.default_rng([seed, 3]), random_streams(seed, len(case.names))
        return cls(case.pdf, case.scenario.target.start, case.detectors, rng, streams[:-1])

    def at(self, step: int) -> NDArray[np.float64]:
        """Return the true place (2,) [m] at a step."""
        while len(self._places) <= step:
            pdf = self._pdf
            self._places.append(pdf.motion.move(self._rng, self._places[-1], pdf.frame, pdf.dt))
        place: NDArray[np.float64] = self._places[step][0]
        return place

    def look(self, i: int, poses: NDArray[np.float64], step: int) -> Looks:
        """Return what vehicle i's sensor tells of its looks (L, 3) in the step that ends now."""
        place, rng, detector = self.at(step), self._sensor_rngs[i], self._detectors[i]
        if self._pdf.motion.leaves and not self._pdf.frame.holds(place[None])[0]:
            place = _GONE
        return Looks(poses, tuple(detector.glimpse(rng, pose, place) for pose in poses))


class Searchers(Vehicles):
    """Vehicles that look several times a step, evenly spaced, the last time at its end."""

    def __init__(
        self,
        poses: ArrayLike,
        speeds: ArrayLike,
        turn_rates: ArrayLike,
        step: float,
        looks: Sequence[int],
        hidden: Hidden | None,
        over: Callable[[float], Outcome | None] = lambda now: None,
    ) -> None:
        """Let n vehicles fly from their starts.

        Args:
            poses, speeds, turn_rates, step, over: as for ``Vehicles``.
            looks: (n,) of each vehicle in a step; they divide the number of its ticks.
            hidden: the target; None: nobody ever reports anything.
        """
        super().__init__(poses, speeds, turn_rates, step, self._tell, over)
        ticks = round(step / TICK)
        self._every = [ticks // each for each in looks]  # a look each so many ticks
        self._dt, self._hidden = step, hidden
        self._taken: list[list[NDArray[np.float64]]] = [
            [] for _ in looks
        ]  # poses of the present step's looks
        self.looks: list[dict[int, NDArray[np.float64]]] = [{} for _ in looks]  # by vehicle: (L, 3) by step

    @classmethod
    def of(
        cls,
        case: SearchCase,
        hidden: Hidden | None,
        over: Callable[[float], Outcome | None] = lambda now: None,
    ) -> Searchers:
        """Return the vehicles of a search, at their starts."""
        vehicles = case.scenario.vehicles
        return cls(
            [vehicle.pose for vehicle in vehicles],
            [vehicle.speed for vehicle in vehicles],
            [vehicle.turn_rate for vehicle in vehicles],
            case.scenario.step,
            [case.looks(i) for i in range(len(vehicles))],
            hidden,
            over,
        )

    def advance(self, now: float, dt: float) -> None:
        """Fly on to now, and look if it is time."""
        super().advance(now, dt)
        tick = round(now / TICK)
        for i in np.flatnonzero(self.alive).tolist():
            if tick % self._every[i] == 0:
                self._taken[i].append(self.poses[i].copy())

    def _tell(self, i: int, pose: NDArray[np.float64], now: float) -> Looks | None:
        step, poses = round(now / self._dt), np.array(self._taken[i]).reshape(-1, 3)
        self._taken[i] = []
        if not len(poses):
            return None
        self.looks[i][step] = poses
        return (
            Looks(poses, (None,) * len(poses)) if self._hidden is None else self._hidden.look(i, poses, step)
        )
