"""Scenarios of tracking: the area, the vehicles with their sensors, the targets and what is known of them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
import yaml
from msgspec import Meta, Struct
from numpy.typing import NDArray

from vedette.agent.body import TICK
from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.models import STATE, TargetModel, constant_velocity, static
from vedette.domains.tracking.objective import OBJECTIVE
from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.sensors import sensor_of
from vedette.domains.tracking.tail import edges
from vedette.errors import InputError, InputWarning
from vedette.missions.flights import TurningVehicle
from vedette.number import many
from vedette.parts import look_in
from vedette.scenario import Metre, Name, as_scenario, load_scenario, names_of

Numbers: TypeAlias = tuple[Annotated[float, Meta(ge=-1e12, le=1e12)], ...]

MOST_VEHICLES, MOST_TARGETS = 64, 1000
FAR, LONG, TAIL = 5.0, 60.0, 10.0  # horizons, seconds, crossings
LEAST_SD = 1e-3  # [m], [m/s]
DEFAULT = "track.yaml"


class TrackVehicle(TurningVehicle, forbid_unknown_fields=True, frozen=True):
    """A vehicle at constant speed with a bounded turn rate."""

    sensor: dict[str, Any]  # see ``vedette.domains.tracking.sensors.sensor_of``
    name: Name = ""
    speed: Annotated[float, Meta(ge=0.0, le=300.0)] = 20.0  # [m/s]
    turn_rate: Annotated[float, Meta(ge=0.0, le=10.0)] = 0.3  # most [rad/s]


class _Target(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="model"):
    """A target, and what is known of it at time 0: a mean, and deviations or a covariance."""

    mean: Numbers
    sd: Numbers | None = None  # standard deviations
    covariance: tuple[Numbers, ...] | None = None
    start: Numbers | None = None  # true state; without it, drawn from the prior
    name: Name = ""


class StaticTarget(_Target, tag="static", frozen=True, kw_only=True):
    """State x, y [m]."""

    q: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.0  # diffusion [m^2/s]

    @property
    def components(self) -> int:
        """Two."""
        return 2

    def moved(self, dt: float) -> TargetModel:
        """Stays, or diffuses."""
        return static(dt, self.q)


class MovingTarget(_Target, tag="constant-velocity", frozen=True, kw_only=True):
    """State x, y, vx, vy [m, m, m/s, m/s]."""

    q: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.05  # intensity of the acceleration [m^2/s^3]

    @property
    def components(self) -> int:
        """Four."""
        return STATE

    def moved(self, dt: float) -> TargetModel:
        """Goes on, with a random acceleration."""
        return constant_velocity(dt, self.q)


class TrackScenario(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """What a scenario file says."""

    area: tuple[Metre, Metre, Metre, Metre]  # lowest x, lowest y, highest x, highest y [m]
    vehicles: Annotated[tuple[TrackVehicle, ...], Meta(min_length=1, max_length=MOST_VEHICLES)]
    targets: Annotated[tuple[StaticTarget | MovingTarget, ...], Meta(min_length=1, max_length=MOST_TARGETS)]
    duration: Annotated[float, Meta(gt=0.0, le=86400.0)] = 120.0  # [s]
    step: Annotated[float, Meta(ge=0.2, le=60.0)] = 1.0  # of looking and planning [s]
    horizon: Annotated[int, Meta(ge=1, le=50)] = 6  # [steps]
    decisions: Annotated[int, Meta(ge=1, le=5)] = 5  # turn rates chosen independently in a horizon
    tail: Annotated[float, Meta(ge=0.0, le=86400.0)] | None = None  # [s] after the horizon; see ``layers``
    objective: str = "trajectory"  # a name of ``vedette.domains.tracking.objective.OBJECTIVE``

    @property
    def vehicle_names(self) -> list[str]:
        """As given, ``vehicle-N`` where not."""
        return names_of("vehicle", (each.name for each in self.vehicles))

    @property
    def target_names(self) -> list[str]:
        """As given, ``target-N`` where not."""
        return names_of("target", (each.name for each in self.targets))

    @property
    def sensors(self) -> list[Sensor]:
        """One a vehicle; InputError as ``sensor_of``."""
        return [sensor_of(each.sensor, f"vehicles[{i}].sensor") for i, each in enumerate(self.vehicles)]

    @property
    def layers(self) -> tuple[float, ...]:
        """Ends of the layers of time after the horizon [s].

        Where no tail is given there is one if the fastest takes longer to cross the area than `FAR` horizons
        and `LONG`: `TAIL` times as long as that takes. An endless objective has one in any case.
        """
        if self.tail is not None:
            return edges(self.tail)
        x0, y0, x1, y1 = self.area
        fastest = max(vehicle.speed for vehicle in self.vehicles)
        crossing = math.hypot(x1 - x0, y1 - y0) / max(fastest, 1e-9)
        far = fastest > 0.0 and crossing > max(LONG, FAR * self.horizon * self.step)
        if self.objective == "endless" and not far:
            return edges(TAIL * LONG)
        return edges(TAIL * crossing) if far else ()

    def prior(self) -> Tracks:
        """Return what is known at step 0."""
        return tracks(
            [each.moved(self.step) for each in self.targets],
            [each.mean for each in self.targets],
            [_covariance(each) for each in self.targets],
            dt=self.step,
            horizon=self.horizon,
            origin=self.area[:2],
        )

    def draw(self, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return true states (T, 4) at step 0, drawn from the prior where no start is given."""
        states = np.zeros((len(self.targets), STATE))
        for state, each in zip(states, self.targets, strict=True):
            luck = rng.normal(size=each.components)  # drawn always: other targets stay what they are
            drawn = np.asarray(each.mean) + np.linalg.cholesky(_covariance(each)) @ luck
            state[: each.components] = drawn if each.start is None else each.start
        return states


def default_scenario() -> TrackScenario:
    """Return the scenario of ``vedette track`` without a file; also ``examples/scenarios/track.yaml``."""
    text = resources.files("vedette.missions").joinpath("scenarios", DEFAULT).read_text(encoding="utf-8")
    return checked(as_scenario(yaml.safe_load(text), TrackScenario, DEFAULT), DEFAULT)


def read_scenario(path: Path | str) -> TrackScenario:
    """Read and check a scenario file.

    Raises:
        InputError: as ``vedette.scenario.load_scenario`` and `checked`.
    """
    look_in(Path(path).parent)
    return checked(load_scenario(path, TrackScenario, "tracking scenario"), str(path))


def checked(scenario: TrackScenario, where: str) -> TrackScenario:
    """Return the scenario if it makes sense as a whole.

    Raises:
        InputError: an area without inside, a step that the simulator cannot make, a name used twice, a start
            or a mean outside the area, a vehicle that cannot turn, a sensor or a prior that is none.

    Warns:
        InputWarning: a target goes so far away that pictures of the area show nothing of it.
    """
    try:
        _check_area(scenario.area)
        _check_step(scenario)
        _check_names("vehicles", scenario.vehicle_names)
        _check_names("targets", scenario.target_names)
        for i, vehicle in enumerate(scenario.vehicles):
            _check_inside(f"vehicles[{i}].start", vehicle.start, scenario.area)
            if vehicle.speed > 0.0 and vehicle.turn_rate == 0.0:
                raise InputError(f"vehicles[{i}].turn_rate: must be above 0 rad/s for a vehicle that moves")
        for i, target in enumerate(scenario.targets):
            _check_target(f"targets[{i}]", target)
            _check_inside(f"targets[{i}].mean", target.mean, scenario.area)
            if target.start is not None:
                _check_inside(f"targets[{i}].start", target.start, scenario.area)
            _tell_if_it_goes_far(f"{where}: targets[{i}]", target, scenario)
        _ = scenario.sensors
        OBJECTIVE.find(scenario.objective)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
    return scenario


def _check_area(area: tuple[float, float, float, float]) -> None:
    x0, y0, x1, y1 = area
    if not (x1 - x0 >= 1.0 and y1 - y0 >= 1.0):
        raise InputError(
            f"area: must be lowest x, lowest y, highest x, highest y, at least 1 m a side; got {list(area)}"
        )


def _check_step(scenario: TrackScenario) -> None:
    ticks = scenario.step / TICK
    if abs(ticks - round(ticks)) > 1e-6:
        raise InputError(
            f"step: must be a multiple of the simulator's tick of {TICK:g} s; got {scenario.step}"
        )
    if scenario.duration < scenario.step:
        raise InputError(f"duration: must be at least a step of {scenario.step} s; got {scenario.duration}")


def _check_names(what: str, names: Sequence[str]) -> None:
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"{what}[{i}].name: {name!r} is used twice")


def _check_inside(what: str, place: Sequence[float], area: tuple[float, float, float, float]) -> None:
    x0, y0, x1, y1 = area
    if not (x0 <= place[0] <= x1 and y0 <= place[1] <= y1):
        raise InputError(
            f"{what}: {place[0]:.10g}, {place[1]:.10g} is outside the area; "
            f"x is {x0:.10g} to {x1:.10g} m, y is {y0:.10g} to {y1:.10g} m"
        )


def _tell_if_it_goes_far(what: str, target: StaticTarget | MovingTarget, scenario: TrackScenario) -> None:
    """Say so where a target's mean ends farther outside the area than the area is wide."""
    x0, y0, x1, y1 = scenario.area
    x, y, *velocity = target.mean if target.start is None else target.start
    for speed, place, low, high in zip(velocity, (x, y), (x0, y0), (x1, y1), strict=False):
        end = place + speed * scenario.duration
        away = max(low - end, end - high)
        if away > math.hypot(x1 - x0, y1 - y0):
            text = (
                f"{what}: at {math.hypot(*velocity):g} m/s it is {away:.0f} m outside the area when the "
                "mission ends; give a larger area or a lower velocity"
            )
            warnings.warn(text, InputWarning, stacklevel=4)
            return


def _check_target(what: str, target: StaticTarget | MovingTarget) -> None:
    d = target.components
    model = "static" if d == 2 else "constant-velocity"
    for name, numbers in (("mean", target.mean), ("sd", target.sd), ("start", target.start)):
        if numbers is not None and len(numbers) != d:
            raise InputError(f"{what}.{name}: has {many(len(numbers), 'number')}; a {model} target needs {d}")
    if (target.sd is None) == (target.covariance is None):
        raise InputError(f"{what}: give either sd or covariance")
    if target.sd is not None and not all(LEAST_SD <= each <= 1e6 for each in target.sd):
        raise InputError(f"{what}.sd: must be {LEAST_SD:g} to 1e6; got {list(target.sd)}")
    if target.covariance is not None:
        rows = [len(row) for row in target.covariance]
        if rows != [d] * d:
            shape = (
                f"{many(len(rows), 'row')} of {', '.join(map(str, sorted(set(rows))))}" if rows else "no rows"
            )
            raise InputError(f"{what}.covariance: has {shape}; a {model} target needs {d} x {d}")
        covariance = np.array(target.covariance)
        if not np.allclose(covariance, covariance.T, rtol=1e-9, atol=0.0):
            raise InputError(f"{what}.covariance: must be symmetric")
        least = float(np.linalg.eigvalsh(covariance)[0])
        if least < LEAST_SD**2:
            raise InputError(
                f"{what}.covariance: must be positive definite, with eigenvalues from {LEAST_SD**2:g}; "
                f"the least is {least:.3g}"
            )


def _covariance(target: StaticTarget | MovingTarget) -> NDArray[np.float64]:
    return np.diag(np.square(target.sd)) if target.sd is not None else np.array(target.covariance)
