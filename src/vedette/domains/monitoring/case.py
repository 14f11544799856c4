"""Monitoring made ready from its scenario: read, checked, and its parts made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from vedette.domains.monitoring.evidence import FieldPacking
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.platform import FieldSensor
from vedette.domains.monitoring.purse import Purse
from vedette.domains.monitoring.scenario import FieldFile, MonitorScenario, MonitorVehicle, Plume
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.survey import model_of
from vedette.domains.monitoring.truth import Floats, TrueField, drawn, plume, read_field, still
from vedette.errors import InputError
from vedette.maps.area import Area
from vedette.scenario import as_scenario, load_scenario

DEFAULT = "monitor.yaml"


@dataclass(frozen=True, eq=False)
class MonitorCase:
    """Monitoring that is known to make sense; a ``DomainCase`` of ``vedette.missions.flights``."""

    name: str
    scenario: MonitorScenario
    model: FieldModel
    numbers: Floats | None  # (R, C) of the field that stays as it is; None: it is generated
    blocked: NDArray[np.bool_]  # (R, C) where robots on the ground must not go
    files: tuple[Path, ...] = ()

    @property
    def names(self) -> list[str]:
        """Of the vehicles."""
        return self.scenario.vehicle_names

    @cached_property
    def spots(self) -> Spots:
        """What the team's sensors measure."""
        sides = sorted({self.scenario.sensor_of(i).side for i in range(len(self.scenario.vehicles))})
        return Spots(self.scenario.frame, tuple(sides))

    def sensor(self, i: int) -> FieldSensor:
        """Return vehicle i's."""
        sensor = self.scenario.sensor_of(i)
        return FieldSensor(sensor.noise**2, sensor.side, self.scenario.step)

    @cached_property
    def packing(self) -> FieldPacking:
        """How evidence adds up."""
        least = min(self.sensor(i).variance for i in range(len(self.scenario.vehicles)))
        return FieldPacking(self.model, self.spots, least)

    def truth(self, seed: int) -> TrueField:
        """Return the field as it truly is."""
        rng = np.random.default_rng([seed, 3])
        if self.numbers is not None:
            return still(self.numbers)
        if isinstance(self.scenario.field, Plume):
            return plume(self.scenario.frame, self.scenario.field, self.scenario.step, rng)
        return drawn(self.model, self.scenario.step, rng)


def default_case() -> MonitorCase:
    """Return what ``vedette monitor`` does without a file; also ``examples/scenarios/monitor.yaml``."""
    text = resources.files("vedette.missions").joinpath("scenarios", DEFAULT).read_text(encoding="utf-8")
    return made(as_scenario(yaml.safe_load(text), MonitorScenario, DEFAULT), Path(DEFAULT))


def read_case(path: Path) -> MonitorCase:
    """Read and check a scenario file; the field's lies beside it.

    Raises:
        InputError: as ``vedette.scenario.load_scenario`` and `made`.
    """
    return made(load_scenario(path, MonitorScenario, "monitoring scenario"), path)


def made(scenario: MonitorScenario, path: Path) -> MonitorCase:
    """Return what a scenario describes.

    Raises:
        InputError: an area without inside, no time for a step, a name used twice, a start
            outside or where a robot must not be, a sensor, a budget, a model or a field that is none;
            the line names file and field.
    """
    try:
        _check_area(scenario)
        _check_times(scenario)
        blocked = _blocked(scenario)
        _check_vehicles(scenario, blocked)
        numbers = read_field(scenario, path.parent)
        files = (path.parent / scenario.field.file,) if isinstance(scenario.field, FieldFile) else ()
        seen = numbers
        if isinstance(scenario.field, Plume):
            seen = plume(scenario.frame, scenario.field, scenario.step, np.random.default_rng([0, 3])).first
        model = model_of(scenario, seen)
        _check_numbers(scenario, model, seen)
        return MonitorCase(path.stem, scenario, model, numbers, blocked, files)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _check_area(scenario: MonitorScenario) -> None:
    x0, y0, x1, y1 = scenario.area
    if not (x1 - x0 >= 2 * scenario.cell and y1 - y0 >= 2 * scenario.cell):
        raise InputError(
            "area: must be lowest x, lowest y, highest x, highest y, at least two cells of "
            f"{scenario.cell:g} m a side; got {list(scenario.area)}"
        )
    if scenario.frame.size > MOST_CELLS:
        raise InputError(
            f"cell: the area has {scenario.frame.size} cells of {scenario.cell:g} m, at most {MOST_CELLS}; "
            "take larger ones"
        )
    if (side := max(scenario.frame.shape)) > MOST_SIDE:
        raise InputError(
            f"cell: the area is {side} cells of {scenario.cell:g} m long, at most {MOST_SIDE}; "
            "take larger ones"
        )


MOST_CELLS, MOST_SIDE = 100_000, 2048


def _check_times(scenario: MonitorScenario) -> None:
    if scenario.duration < scenario.step:
        raise InputError(f"duration: must be at least a step of {scenario.step} s; got {scenario.duration}")
    if scenario.layers > scenario.horizon:
        raise InputError(
            f"layers: at most one a step of the horizon, {scenario.horizon}; got {scenario.layers}"
        )


def _blocked(scenario: MonitorScenario) -> NDArray[np.bool_]:
    blocked = np.zeros(scenario.frame.shape, np.bool_)
    for k, corners in enumerate(scenario.no_go):
        try:
            blocked |= Area.of(corners).holds(scenario.frame)
        except InputError as error:
            raise InputError(f"no_go[{k}]: {str(error).removeprefix('area: ')}") from error
    return blocked


def _check_numbers(scenario: MonitorScenario, model: FieldModel, seen: Floats | None) -> None:
    """Refuse a field that the model has nothing to do with, and sensors that say next to nothing, or all."""
    if seen is not None and (away := float(np.abs(seen - model.mean).max())) > _FARTHEST * model.deviation:
        raise InputError(
            f"model.deviation: the field is up to {away:.3g} off its mean, more than {_FARTHEST} times the "
            f"deviation of {model.deviation:.3g}; give a larger one, or nan for what stands for no data"
        )
    for i, name in enumerate(scenario.vehicle_names):
        noise = scenario.sensor_of(i).noise
        if noise > _NOISIEST * model.deviation:
            raise InputError(
                f"sensor.noise: {noise:.3g} of {name} is more than {_NOISIEST} times the field's deviation "
                f"of {model.deviation:.3g}, so that it says nothing; leave it out, or give model.deviation"
            )
        if noise < _QUIETEST * model.deviation:
            raise InputError(
                f"sensor.noise: {noise:.3g} of {name} is less than {_QUIETEST:g} of the field's deviation of "
                f"{model.deviation:.3g}, more precise than can be computed with; give more"
            )


_FARTHEST, _NOISIEST, _QUIETEST = 100, 100, 1e-8  # deviations


def _check_vehicles(scenario: MonitorScenario, blocked: NDArray[np.bool_]) -> None:
    names, frame = scenario.vehicle_names, scenario.frame
    for i, vehicle in enumerate(scenario.vehicles):
        where, (x, y) = f"vehicles[{i}]", vehicle.start
        if names[i] in names[:i]:
            raise InputError(f"{where}.name: {names[i]!r} is used twice")
        if not frame.contains(x, y):
            x0, x1, y0, y1 = frame.extent
            raise InputError(
                f"{where}.start: {x:.10g}, {y:.10g} is outside the area; "
                f"x is {x0:.10g} to below {x1:.10g} m, y is {y0:.10g} to below {y1:.10g} m"
            )
        if not vehicle.flies and blocked[frame.cell(x, y)]:
            raise InputError(f"{where}.start: {x:.10g}, {y:.10g} is in no_go; start elsewhere, or let it fly")
        side = scenario.sensor_of(i).side
        if side % 2 == 0 or side > min(frame.shape):
            own = f"{where}.sensor" if vehicle.sensor is not None else "sensor"
            raise InputError(f"{own}.side: must be odd and fit into the area; got {side} cells")
        _check_budget(f"{where}.budget", vehicle, scenario)


def _check_budget(where: str, vehicle: MonitorVehicle, scenario: MonitorScenario) -> None:
    budget, cell, step = vehicle.budget, scenario.cell, scenario.step
    if budget.path is not None and budget.energy is not None:
        raise InputError(f"{where}.energy: give a path or energy, not both")
    if budget.energy is not None and budget.per_metre == budget.per_second == 0.0:
        raise InputError(
            f"{where}.per_metre: energy is never spent where both per_metre and per_second are 0"
        )
    purse = Purse(budget)
    if (awake := purse.awake(0.0)) <= step:
        raise InputError(
            f"{where}: it lasts for {awake:.3g} s, no longer than the first step of {step:g} s; give more, "
            "or leave the vehicle out"
        )
    if (reach := purse.reach(vehicle.speed)) < cell:
        raise InputError(
            f"{where}: it lasts for {reach:.3g} m, less than to the next cell at {cell:g} m; "
            "give more, or leave the vehicle out"
        )
