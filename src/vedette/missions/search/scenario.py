"""What a scenario file of a search says: the area, the vehicles, the target and where it is taken to be."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from msgspec import Meta, Struct, field

from vedette.domains.search.worth import Worth, worth_of
from vedette.maps import GridFrame
from vedette.missions.flights import TurningVehicle
from vedette.scenario import Metre, Name, names_of

Length = Annotated[float, Meta(gt=0.0, le=1e6)]  # [m]
Weight = Annotated[float, Meta(gt=0.0, le=1e9)]

Corners: TypeAlias = Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=3)]

MOST_VEHICLES = 64


class Uniform(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="uniform"):
    """Anywhere in the area alike."""

    weight: Weight = 1.0


class Gaussian(
    Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="gaussian"
):
    """Near a place."""

    mean: tuple[Metre, Metre]
    sigma: Annotated[float, Meta(gt=0.0, le=1e6)] | None = None  # [m]
    covariance: tuple[tuple[float, float], tuple[float, float]] | None = None  # [m^2]
    weight: Weight = 1.0


class Polygon(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="polygon"):
    """Anywhere in a polygon alike."""

    corners: Corners
    weight: Weight = 1.0


class Heat(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="image"):
    """As the numbers of a raster, a grey image for instance, 0 or black is nowhere."""

    file: str  # relative to the scenario's folder
    extent: tuple[Metre, Metre, Metre, Metre] | None = (
        None  # where it lies, as ``area``; else as the file says
    )
    weight: Weight = 1.0


class Rings(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True, tag_field="type", tag="rings"):
    """Round the last known place, by how far such people were found from theirs."""

    centre: tuple[Metre, Metre]
    distances: Annotated[tuple[Length, ...], Meta(min_length=1, max_length=100)]
    within: Annotated[tuple[Annotated[float, Meta(gt=0.0, le=1.0)], ...], Meta(min_length=1)]  # share by each
    weight: Weight = 1.0


Prior: TypeAlias = Uniform | Gaussian | Polygon | Heat | Rings


class Searched(Struct, forbid_unknown_fields=True, frozen=True):
    """A track that somebody has searched already, in vain."""

    path: Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=2, max_length=10_000)]
    width: Length  # of what it covered, half on each side
    detection: Annotated[float, Meta(gt=0.0, le=1.0)]  # probability of detection of a target there


class Target(Struct, forbid_unknown_fields=True, frozen=True):
    """How the target moves."""

    drift: tuple[float, float] = (0.0, 0.0)  # [m/s], team frame
    diffusion: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.0  # [m^2/s]
    start: tuple[Metre, Metre] | None = None  # where it really is [m]; without it, drawn from the prior
    border: Literal["hold", "leave"] = "hold"  # what becomes of it there: held in the area, or gone for good


class SearchVehicle(TurningVehicle, forbid_unknown_fields=True, frozen=True):
    """A vehicle at constant speed with a bounded turn rate."""

    name: Name = ""
    speed: Annotated[float, Meta(gt=0.0, le=300.0)] = 25.0  # [m/s]
    turn_rate: Annotated[float, Meta(gt=0.0, le=10.0)] = 0.2  # most [rad/s]
    detector: dict[str, Any] | None = None  # without it the scenario's
    looks: Annotated[int, Meta(ge=1)] | None = None  # a step; without it, one each half range


class Declare(Struct, forbid_unknown_fields=True, frozen=True):
    """When a team with false alarms says that it has found the target."""

    probability: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.95  # posterior within the radius of a place
    radius: Annotated[float, Meta(gt=0.0, le=1e6)] = 100.0  # [m]


class SearchScenario(Struct, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """What a scenario file says."""

    area: tuple[Metre, Metre, Metre, Metre]  # lowest x, lowest y, highest x, highest y [m]
    cell: Annotated[float, Meta(gt=0.0, le=1e6)] = 25.0  # side of a cell [m]
    prior: Annotated[tuple[Prior, ...], Meta(min_length=1, max_length=1000)]
    searched: Annotated[tuple[Searched, ...], Meta(max_length=1000)] = ()
    no_go: Annotated[tuple[Corners, ...], Meta(max_length=1000)] = ()  # polygons in which the target is not
    target: Target = Target()
    vehicles: Annotated[tuple[SearchVehicle, ...], Meta(min_length=1, max_length=MOST_VEHICLES)]
    detector: dict[str, Any] = field(
        default_factory=lambda: {"type": "definite"}
    )  # of vehicles without one of their own
    duration: Annotated[float, Meta(gt=0.0, le=86400.0)] = 300.0  # [s]
    step: Annotated[float, Meta(ge=0.2, le=60.0)] = 2.0  # of looking and planning [s]
    horizon: Annotated[int, Meta(ge=2, le=60)] = 10  # [steps]
    replan: Annotated[int, Meta(ge=1, le=60)] = 1  # a round each so many [steps]
    decisions: Annotated[int, Meta(ge=1, le=5)] = 4  # turn rates chosen in a horizon
    worth: str = "discounted"  # a name of ``vedette.domains.search.worth.WORTH``
    gamma: Annotated[float, Meta(gt=0.0, le=1.0)] = (
        0.97  # worth of a step's delay, for `discounted` and `endless`
    )
    tail: Annotated[float, Meta(ge=0.0, le=1.0)] = 1.0  # worth of what is promised after the horizon
    declare: Declare = Declare()

    @property
    def vehicle_names(self) -> list[str]:
        """As given, ``vehicle-N`` where not."""
        return names_of("vehicle", (each.name for each in self.vehicles))

    @property
    def frame(self) -> GridFrame:
        """The grid over the area, whole cells."""
        return GridFrame.over(self.area, self.cell)

    @property
    def weights(self) -> Worth:
        """What detections are worth when."""
        return worth_of(self.worth, self.horizon, self.gamma, self.tail)
