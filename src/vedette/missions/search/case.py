"""A search made ready from its scenario: read, checked, and its parts made."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import yaml

from vedette.agent.body import TICK
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import Detector, detector_from
from vedette.domains.search.motion import TargetMotion
from vedette.domains.search.platform import SearchPlatform
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.missions.search.prior import parts_of, prior_of
from vedette.missions.search.scenario import SearchScenario
from vedette.missions.search.suits import MOST_CELLS, check_cells, check_drift
from vedette.parts import look_in
from vedette.scenario import as_scenario, load_scenario

DEFAULT = "search.yaml"


@dataclass(frozen=True, eq=False)
class SearchCase:
    """A search that is known to make sense."""

    name: str
    scenario: SearchScenario
    pdf: TargetPdf  # at step 0
    detectors: tuple[Detector, ...]  # by vehicle

    @property
    def names(self) -> list[str]:
        """Of the vehicles."""
        return self.scenario.vehicle_names

    @property
    def false_alarms(self) -> bool:
        """Whether any vehicle may report what is not there."""
        return any(detector.false_alarm > 0.0 for detector in self.detectors)

    def looks(self, i: int) -> int:
        """Return how often vehicle i looks in a step: as it says, or every half range; at most each tick.

        Looks are evenly spaced on ticks of the simulator, so their number divides that of the step's ticks.
        """
        vehicle, step = self.scenario.vehicles[i], self.scenario.step
        ticks = round(step / TICK)
        wanted = vehicle.looks or math.ceil(vehicle.speed * step / (self.detectors[i].range / 2.0))
        return min(n for n in range(1, ticks + 1) if ticks % n == 0 and n >= min(wanted, ticks))

    def platform(self, i: int) -> SearchPlatform:
        """Return what vehicle i can do."""
        vehicle = self.scenario.vehicles[i]
        return SearchPlatform(
            vehicle.speed,
            vehicle.turn_rate,
            self.detectors[i],
            controls=self.scenario.decisions,
            looks=self.looks(i),
        )


def default_case() -> SearchCase:
    """Return the search of ``vedette search`` without a file; also ``examples/scenarios/search.yaml``."""
    text = resources.files("vedette.missions").joinpath("scenarios", DEFAULT).read_text(encoding="utf-8")
    return made(as_scenario(yaml.safe_load(text), SearchScenario, DEFAULT), Path(DEFAULT))


def read_case(path: Path | str) -> SearchCase:
    """Read and check a scenario file; images lie beside it.

    Raises:
        InputError: as ``vedette.scenario.load_scenario`` and `made`.
    """
    look_in(Path(path).parent)
    return made(load_scenario(path, SearchScenario, "search scenario"), Path(path))


def made(scenario: SearchScenario, path: Path) -> SearchCase:
    """Return the search that a scenario describes.

    Raises:
        InputError: an area without inside or with too many cells, a step that the simulator cannot make, a
            name used twice, a start outside the area, a detector or a prior that is none, cells far too large
            for a sensor; the line names file and field.
        InputWarning: cells that are large for a sensor; a drift that takes the target to the border.
    """
    try:
        _check_area(scenario)
        _check_step(scenario)
        _check_vehicles(scenario)
        _ = scenario.weights
        frame, target = scenario.frame, scenario.target
        if target.start is not None:
            _check_inside("target.start", target.start, frame)
        parts = parts_of(scenario, path.parent)
        motion = TargetMotion(target.drift, target.diffusion, target.border == "leave")
        pdf = TargetPdf(frame, prior_of(scenario, parts), motion, scenario.step)
        _ = pdf.stencil
        detectors = tuple(_detectors(scenario))
        check_cells(pdf, detectors, scenario.vehicle_names)
        means = {f"the mean of prior[{i}]": frame.mean(part) for i, part in enumerate(parts)}
        check_drift(means | ({} if target.start is None else {"target.start": target.start}), scenario)
        return SearchCase(path.stem, scenario, pdf, detectors)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _detectors(scenario: SearchScenario) -> list[Detector]:
    detectors = []
    for i, vehicle in enumerate(scenario.vehicles):
        own = vehicle.detector is not None
        try:
            detectors.append(
                detector_from(vehicle.detector if vehicle.detector is not None else scenario.detector)
            )
        except InputError as error:
            raise InputError(f"vehicles[{i}].{error}" if own else str(error)) from error
    return detectors


def _check_area(scenario: SearchScenario) -> None:
    x0, y0, x1, y1 = scenario.area
    if not (x1 - x0 >= scenario.cell and y1 - y0 >= scenario.cell):
        raise InputError(
            "area: must be lowest x, lowest y, highest x, highest y, at least a cell of "
            f"{scenario.cell:g} m a side; got {list(scenario.area)}"
        )
    if scenario.frame.size > MOST_CELLS:
        raise InputError(
            f"cell: the area has {scenario.frame.size} cells of {scenario.cell:g} m, at most {MOST_CELLS}; "
            "take larger ones"
        )


def _check_step(scenario: SearchScenario) -> None:
    ticks = scenario.step / TICK
    if abs(ticks - round(ticks)) > 1e-6:
        raise InputError(
            f"step: must be a multiple of the simulator's tick of {TICK:g} s; got {scenario.step}"
        )
    if scenario.duration < scenario.step:
        raise InputError(f"duration: must be at least a step of {scenario.step} s; got {scenario.duration}")


def _check_vehicles(scenario: SearchScenario) -> None:
    names = scenario.vehicle_names
    for i, vehicle in enumerate(scenario.vehicles):
        if names[i] in names[:i]:
            raise InputError(f"vehicles[{i}].name: {names[i]!r} is used twice")
        _check_inside(f"vehicles[{i}].start", vehicle.start, scenario.frame)


def _check_inside(what: str, place: Sequence[float], frame: GridFrame) -> None:
    if not frame.contains(place[0], place[1]):
        x0, x1, y0, y1 = frame.extent
        raise InputError(
            f"{what}: {place[0]:.10g}, {place[1]:.10g} is outside the area; "
            f"x is {x0:.10g} to {x1:.10g} m, y is {y0:.10g} to {y1:.10g} m"
        )
