"""What a scenario file of monitoring says: the field, what is known of it beforehand, sensors, vehicles."""

from __future__ import annotations

from math import inf
from typing import Annotated, TypeAlias

from msgspec import Meta, Struct

from vedette.maps import GridFrame
from vedette.scenario import Metre, Name, names_of

Positive = Annotated[float, Meta(gt=0.0, le=1e9)]
Speed = Annotated[float, Meta(ge=-300.0, le=300.0)]  # along an axis [m/s]
Corners: TypeAlias = Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=3)]

MOST_VEHICLES = 64


class Jacksboro(Struct, forbid_unknown_fields=True, frozen=True, tag_field="type", tag="jacksboro"):
    """Elevations about the Jacksboro fault [m], 344 x 403 of them, stretched over the area."""


class Topobathy(Struct, forbid_unknown_fields=True, frozen=True, tag_field="type", tag="topobathy"):
    """Elevations and depths about Puget Sound [m], 91 x 120 of them, stretched over the area."""


class FieldFile(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="file"):
    """The numbers of a raster."""

    file: str  # relative to the scenario's folder
    extent: tuple[Metre, Metre, Metre, Metre] | None = None  # as ``area``; else as the file says


class Drawn(Struct, forbid_unknown_fields=True, frozen=True, tag_field="type", tag="drawn"):
    """Drawn from the model by the seed; it changes as the model says."""


class Plume(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="plume"):
    """A cloud of puffs that the wind carries on; turbulence drives them apart and spreads each."""

    source: tuple[Metre, Metre]  # about which it is at first
    wind: tuple[Speed, Speed] = (0.2, 0.1)  # [m/s]
    strength: Positive = 10.0  # of a puff at its middle, at first
    width: Positive = 4.0  # of a puff at first: its standard deviation [m]
    spreading: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.1  # of a puff [m^2/s]
    wander: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.2  # of a puff's middle, process noise [m^2/s]


class Age(Struct, forbid_unknown_fields=True, frozen=True, tag_field="type", tag="age"):
    """Nothing but how long ago a place was looked at: what was seen of it is worth ever less."""


Source: TypeAlias = Jacksboro | Topobathy | FieldFile | Drawn | Plume | Age


class KnownField(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """What is known of the field beforehand; without a number it is learned from a survey."""

    mean: Annotated[float, Meta(ge=-1e9, le=1e9)] | None = None  # [unit]
    deviation: Positive | None = None  # of each cell [unit]
    length: Positive | None = None  # distance at which cells have a correlation of 0.14 [m]
    lasting: Positive | None = None  # after so long a cell has 1/e in common with itself [s]; None: for ever
    drift: tuple[Speed, Speed] = (0.0, 0.0)  # of the whole field [m/s]
    survey: Annotated[int, Meta(ge=10, le=10_000)] = 80  # places measured beforehand to learn from


class SensorSettings(Struct, forbid_unknown_fields=True, frozen=True):
    """Measures the mean over a block of cells about the vehicle at each step's end."""

    noise: Annotated[float, Meta(ge=1e-12, le=1e9)] = 1.0  # standard deviation [unit]
    side: Annotated[int, Meta(ge=1, le=15)] = 1  # of the block [cells], odd; 1: a point sensor


class Budget(Struct, forbid_unknown_fields=True, frozen=True):
    """What a vehicle can spend: a way, or energy for its way and its time. Then it stays and sees no more."""

    path: Positive | None = None  # [m]
    energy: Positive | None = None  # [J]
    per_metre: Annotated[float, Meta(ge=0.0, le=1e9)] = 1.0  # [J/m]
    per_second: Annotated[float, Meta(ge=0.0, le=1e9)] = 0.0  # [W]


class MonitorVehicle(Struct, forbid_unknown_fields=True, frozen=True):
    """A robot on the ground, or a flyer; it turns at once, and may stand."""

    start: tuple[Metre, Metre]
    name: Name = ""
    speed: Annotated[float, Meta(gt=0.0, le=300.0)] = 1.0  # [m/s]
    flies: bool = False  # over what robots on the ground must not enter
    sensor: SensorSettings | None = None  # without it the scenario's
    budget: Budget = Budget()

    @property
    def radius(self) -> float:
        """Of the body [m]: so small that nobody makes room."""
        return 0.1

    @property
    def pose(self) -> tuple[float, float, float]:
        """Start, heading along x."""
        return *self.start, 0.0

    @property
    def turn_rate(self) -> None:
        """It turns at once."""
        return


class MonitorScenario(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """What a scenario file says."""

    area: tuple[Metre, Metre, Metre, Metre]  # lowest x, lowest y, highest x, highest y [m]
    cell: Positive = 1.0  # side of a cell [m]
    field: Source
    model: KnownField = KnownField()
    sensor: SensorSettings = SensorSettings()  # of vehicles without one of their own
    vehicles: Annotated[tuple[MonitorVehicle, ...], Meta(min_length=1, max_length=MOST_VEHICLES)]
    no_go: Annotated[
        tuple[Corners, ...], Meta(max_length=1000)
    ] = ()  # where robots on the ground must not go
    duration: Annotated[float, Meta(gt=0.0, le=86400.0)] = 300.0  # [s]
    step: Annotated[float, Meta(ge=0.2, le=60.0)] = 1.0  # of measuring and planning [s]
    horizon: Annotated[int, Meta(ge=2, le=200)] = 24  # [steps]
    replan: Annotated[int, Meta(ge=1, le=60)] = 4  # a round each so many [steps]
    layers: Annotated[int, Meta(ge=1, le=16)] = 2  # of the horizon
    gamma: Annotated[float, Meta(gt=0.0, le=1.0)] = 0.7  # worth of what a later layer brings
    bearings: Annotated[int, Meta(ge=2, le=16)] = 8  # of each leg

    @property
    def vehicle_names(self) -> list[str]:
        """As given, ``vehicle-N`` where not."""
        return names_of("vehicle", (each.name for each in self.vehicles))

    @property
    def frame(self) -> GridFrame:
        """The grid over the area, whole cells."""
        return GridFrame.over(self.area, self.cell)

    def sensor_of(self, i: int) -> SensorSettings:
        """Return vehicle i's."""
        return self.vehicles[i].sensor or self.sensor

    @property
    def lasting(self) -> float:
        """How long the field is taken to last [s]."""
        return inf if self.model.lasting is None else self.model.lasting
