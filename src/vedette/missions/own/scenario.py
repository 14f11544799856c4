"""What the scenario of an own domain says beside what is its own: the area, the vehicles, times."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from vedette.agent.body import TICK
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.missions.flights import TurningVehicle
from vedette.parts import look_in
from vedette.scenario import Metre, Name, as_scenario, load_scenario, names_of

MOST_VEHICLES = 64


class OwnVehicleSpec(TurningVehicle, forbid_unknown_fields=True, frozen=True):
    """A vehicle at constant speed with a bounded turn rate."""

    name: Name = ""
    speed: Annotated[float, Meta(gt=0.0, le=300.0)] = 10.0  # [m/s]
    turn_rate: Annotated[float, Meta(gt=0.0, le=10.0)] = 0.4  # most [rad/s]


class OwnScenario(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """What every scenario of an own domain says; a subclass adds fields."""

    area: tuple[Metre, Metre, Metre, Metre]  # lowest x, lowest y, highest x, highest y [m]
    vehicles: Annotated[tuple[OwnVehicleSpec, ...], Meta(min_length=1, max_length=MOST_VEHICLES)]
    duration: Annotated[float, Meta(gt=0.0, le=86400.0)] = 60.0  # [s]
    step: Annotated[float, Meta(ge=0.2, le=60.0)] = 1.0  # of looking and planning [s]
    horizon: Annotated[int, Meta(ge=2, le=50)] = 8  # [steps]
    decisions: Annotated[int, Meta(ge=1, le=5)] = 4  # turn rates chosen in a horizon
    replan: Annotated[int, Meta(ge=1, le=60)] = 1  # a round each so many steps

    @property
    def vehicle_names(self) -> list[str]:
        """As given, ``vehicle-N`` where not."""
        return names_of("vehicle", (each.name for each in self.vehicles))


def read_scenario(scenario: Path | Mapping[str, Any], kind: type[OwnScenario]) -> tuple[str, OwnScenario]:
    """Return a scenario's name and what it says, checked.

    Raises:
        InputError: it cannot be read, or makes no sense; the line names file and field.
    """
    if isinstance(scenario, Path):
        look_in(scenario.parent)
        name, where, read = scenario.stem, str(scenario), load_scenario(scenario, kind)
    else:
        name = where = "scenario"
        read = as_scenario(scenario, kind, where)
    try:
        _check(read)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
    return name, read


def _check(scenario: OwnScenario) -> None:
    x0, y0, x1, y1 = scenario.area
    if not (x1 - x0 >= 1.0 and y1 - y0 >= 1.0):
        raise InputError(
            "area: must be lowest x, lowest y, highest x, highest y, at least 1 m a side; "
            f"got {list(scenario.area)}"
        )
    ticks = scenario.step / TICK
    if abs(ticks - round(ticks)) > 1e-6:
        raise InputError(
            f"step: must be a multiple of the simulator's tick of {TICK:g} s; got {scenario.step}"
        )
    if scenario.duration < scenario.step:
        raise InputError(f"duration: must be at least a step of {scenario.step} s; got {scenario.duration}")
    for i, (name, vehicle) in enumerate(zip(scenario.vehicle_names, scenario.vehicles, strict=True)):
        if name in scenario.vehicle_names[:i]:
            raise InputError(f"vehicles[{i}].name: {name!r} is used twice")
        x, y, _ = vehicle.start
        if not (x0 <= x <= x1 and y0 <= y <= y1):
            raise InputError(
                f"vehicles[{i}].start: {x:.10g}, {y:.10g} is outside the area; "
                f"x is {x0:.10g} to {x1:.10g} m, y is {y0:.10g} to {y1:.10g} m"
            )


def grid_over(area: tuple[float, float, float, float], cell: float) -> GridFrame:
    """Return the grid of square cells [m] over an area, at least one."""
    x0, y0, x1, y1 = area
    return GridFrame(cell, max(1, round((y1 - y0) / cell)), max(1, round((x1 - x0) / cell)), x0, y0)
