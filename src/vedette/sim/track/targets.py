"""The true targets of a tracking mission: how they move, and what sensors see of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.tracking.models import TargetModel
from vedette.domains.tracking.sensing import Sensor


class Targets:
    """True states, step by step, and everybody's looks at them; ``look`` is ``vedette.sim.vehicles.Look``.

    Chance comes from one stream for the targets and one for each sensor, and the same amount is drawn
    whatever is seen: teams that behave differently meet the same targets, and the same noise.
    """

    def __init__(
        self,
        models: Sequence[TargetModel],
        start: NDArray[np.float64],
        sensors: Sequence[Sensor],
        dt: float,
        rng: np.random.Generator,
        sensor_rngs: Sequence[np.random.Generator],
    ) -> None:
        """Put T targets at their true states (T, 4) at step 0; ``dt`` is the step [s]."""
        self._models, self._sensors, self._dt = tuple(models), tuple(sensors), dt
        self._rng, self._sensor_rngs = rng, tuple(sensor_rngs)
        self.states = [np.asarray(start, np.float64)]  # (T, 4) by step
        self.poses: dict[tuple[int, int], NDArray[np.float64]] = {}  # (3,) by step and vehicle
        self.seen: dict[tuple[int, int], tuple[int, ...]] = {}  # targets by step and vehicle

    def look(self, i: int, pose: NDArray[np.float64], now: float) -> dict[int, NDArray[np.float64]]:
        """Return vehicle i's measurements by target at a step's end."""
        step = round(now / self._dt)
        rng, sensor = self._sensor_rngs[i], self._sensors[i]
        looks = [sensor.measure(rng, pose, state) for state in self.at(step)]
        measured = {target: z for target, z in enumerate(looks) if z is not None}
        self.poses[step, i], self.seen[step, i] = pose, tuple(measured)
        return measured

    def at(self, step: int) -> NDArray[np.float64]:
        """Return the true states (T, 4) at a step."""
        while len(self.states) <= step:
            moved = [m.move(self._rng, x) for m, x in zip(self._models, self.states[-1], strict=True)]
            self.states.append(np.stack(moved))
        return self.states[step]
