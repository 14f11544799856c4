"""The true targets of a tracking mission: how they move, and what sensors see of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.tracking.models import TargetModel
from vedette.domains.tracking.sensing import Sensor
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.scenario import TrackScenario
from vedette.outcome import Outcome
from vedette.sim.simulation import random_streams
from vedette.sim.vehicles import Vehicles


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

    @classmethod
    def of(cls, team: TrackTeam, seed: int) -> Targets:
        """Return the targets of a mission, the same for everybody who simulates a part of it."""
        rng = np.random.default_rng([seed, 2])
        start = team.scenario.draw(rng)
        streams = random_streams(seed, len(team.sensors))
        return cls(team.prior.models, start, team.sensors, team.scenario.step, rng, streams[:-1])

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


def trackers(
    scenario: TrackScenario, targets: Targets, over: Callable[[float], Outcome | None] = lambda now: None
) -> Vehicles:
    """Return the vehicles of a tracking mission, at their starts; ``over`` as for ``Vehicles``."""
    vehicles = scenario.vehicles
    return Vehicles(
        [vehicle.pose for vehicle in vehicles],
        [vehicle.speed for vehicle in vehicles],
        [vehicle.turn_rate for vehicle in vehicles],
        scenario.step,
        targets.look,
        over,
    )
