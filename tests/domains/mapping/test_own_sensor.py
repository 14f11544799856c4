"""Sensors of somebody's own: what they see makes the map, what they would see is what a tour promises."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from tests.support.commands import Command
from tests.support.own_parts import example, module
from tests.support.places import ROOT
from tests.support.small_missions import small_maze
from vedette import run
from vedette.domains.mapping.impact import STEPS_PER_NAT
from vedette.domains.mapping.stops import Stops
from vedette.errors import InputError
from vedette.parts import look_in
from vedette.sensor import CheckedSensor
from vedette.sim.explore.run import prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.team import PlatformSpec

ODD = """
import numpy as np

class Half:
    def __init__(self, spec): self.range = spec.range
    def scan(self, cast, rng):
        angles = np.linspace(-3, 3, 60)
        return angles, cast(angles)
    def sees(self, distance, bearing):
        return np.where((distance <= 2.0) & (np.abs(bearing) <= 0.5), 0.5, 0.0)

class All(Half):
    def sees(self, distance, bearing): return np.ones(len(distance))

class Short(Half):
    def scan(self, cast, rng): return np.zeros(3), np.zeros(2)

class Behind(Half):
    def scan(self, cast, rng): return np.zeros(3), np.full(3, -1.0)

class Surer(Half):
    def sees(self, distance, bearing): return np.full(len(distance), 1.5)

class Fewer(Half):
    def sees(self, distance, bearing): return np.ones(1)

class Raises(Half):
    def scan(self, cast, rng): raise OSError("no\\nlight")

class Blind:
    def __init__(self, spec): pass
    def scan(self, cast, rng): pass

def dear(spec): return spec.price
"""


@pytest.mark.parametrize(
    ("name", "body"),
    [
        ("Camera", {"range": 5.0, "view": 70.0, "beams": 120}),
        ("Feelers", {"range": 0.6, "radius": 0.1, "beams": 32}),
    ],
)
def test_robots_with_the_examples_sensors_map_a_maze(tmp_path: Path, name: str, body: dict[str, Any]) -> None:
    look_in(tmp_path)
    sensor = f"{example('own_sensor', tmp_path)}:{name}"
    team = [PlatformSpec(f"robot-{i}", sensor=sensor, **body) for i in (1, 2)]
    done = run.explore(small_maze(), team, max_time=900.0)
    assert done.outcome.completed
    assert done.coverage is not None
    assert done.coverage > 0.99
    assert done.map_error_share < 0.005
    assert done.collisions == 0


def stops_of(sensor: str | None, view: float) -> tuple[Stops, Any]:
    """What a robot finds after its first scans, and what of the map it planned on."""
    spec = PlatformSpec(sensor=sensor, range=4.0, view=view)
    simulation = prepare(small_maze(), [spec], ExploreSetup(planner="rate", max_time=60.0))
    mission = simulation.missions[0]
    while mission.platform.stops is None or not len(mission.platform.stops):
        simulation.step()
    assert mission.platform.stops is not None
    return mission.platform.stops, mission


@pytest.mark.parametrize("view", [360.0, 60.0])
def test_a_tour_promises_what_a_lidars_would_times_how_likely_the_sensor_sees_it(
    tmp_path: Path, view: float
) -> None:
    look_in(tmp_path)
    own = module(tmp_path, ODD)
    (everything, mission), (half, _) = stops_of(f"{own}:All", view), stops_of(f"{own}:Half", view)
    assert len(everything) >= len(half) > 0
    planning = mission.frame.coarse(2)
    for k, (target, at) in enumerate(zip(half.targets, half.views, strict=True)):
        same = int(np.argmin(np.abs(everything.targets - target).sum(axis=1)))
        assert np.allclose(everything.views[same], at, atol=1e-9)
        lidar, seen = likely(everything, same), likely(half, k)
        x, y = (planning.centres(np.array(sorted(lidar))) - at).T
        bearing = np.arctan2(y, x) - np.arctan2(*(target - at)[::-1])
        inside = (np.hypot(x, y) <= 2.0) & (np.abs(np.remainder(bearing + np.pi, 2 * np.pi) - np.pi) <= 0.5)
        for cell, within in zip(sorted(lidar), inside.tolist(), strict=True):
            expected = 0.5 * lidar[cell] if within else 0.0
            assert abs(seen.get(cell, 0.0) - expected) <= 0.12  # rounded to eighths, both of them


def likely(stops: Stops, k: int) -> dict[int, float]:
    """By planning cell, the probability that stop k shows it."""
    marks = stops.footprints
    row = slice(int(marks.starts[k]), int(marks.starts[k + 1]))
    shares = 1.0 - np.exp(-marks.misses[row].astype(float) / STEPS_PER_NAT)
    return dict(zip(marks.cells[row].tolist(), shares.tolist(), strict=True))


def scanned(sensor: CheckedSensor) -> object:
    return sensor.scan(lambda angles: np.ones(len(angles)), np.random.default_rng(0))


def seen(sensor: CheckedSensor) -> object:
    return sensor.sees(np.ones(2), np.zeros(2))


@pytest.mark.parametrize(
    ("name", "does", "said"),
    [
        ("Short", scanned, "scan: ValueError: gives angles (3,) and ranges (2,); give (B,) of both"),
        ("Behind", scanned, "scan: ValueError: gives an angle that is not finite, or a range below 0"),
        ("Raises", scanned, "scan: OSError: no light (own_part_"),
        ("Surer", seen, "sees: ValueError: gives a probability that is not 0 to 1"),
        ("Fewer", seen, "sees: ValueError: gives (1,) for places (2,)"),
        ("Blind", seen, "TypeError: it lacks sees; see docs/how-to/own-sensor.md"),
        ("dear", seen, "AttributeError: 'PlatformSpec' object has no attribute 'price' (own_part_"),
        ("np", seen, "is module, not a class of sensors; see docs/how-to/own-sensor.md"),
    ],
)
def test_what_a_sensor_does_wrong_is_told_in_a_line(
    tmp_path: Path, name: str, does: Callable[[CheckedSensor], object], said: str
) -> None:
    look_in(tmp_path)
    own = f"{module(tmp_path, ODD)}:{name}"
    with pytest.raises(InputError) as told:
        does(cast(CheckedSensor, CheckedSensor.of(PlatformSpec(sensor=own))))
    assert str(told.value).startswith(f"sensor {own}: {said}")
    assert "\n" not in str(told.value)


def test_a_sensor_that_there_is_not_is_told_with_the_team_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    own = module(tmp_path, ODD)
    Path("team.yaml").write_text(f"platforms: [{{}}, {{sensor: '{own}:Halv'}}]")
    ran = Command(monkeypatch, capsys, "explore")("--team", "team.yaml")
    assert ran.err == (f"vedette: team.yaml: platform 2: sensor: {own} has no 'Halv'; did you mean 'Half'?\n")


def test_the_examples_are_those_that_are_explained() -> None:
    for name in ("own_sensor", "own_planner"):
        code = (ROOT / "examples" / f"{name}.py").read_text(encoding="utf-8")
        page = ROOT / "docs" / "how-to" / f"{name.replace('_', '-')}.md"
        assert f"```python\n{code}```" in page.read_text(encoding="utf-8")
