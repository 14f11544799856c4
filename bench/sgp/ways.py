"""SGP-Tools' ways: asked for in its own environment, and gone by robots that share what they measure."""

from __future__ import annotations

import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.sgp import planner
from vedette.agent import Agent
from vedette.domains.monitoring.case import MonitorCase
from vedette.domains.monitoring.ways import Place, Way
from vedette.errors import InputError
from vedette.missions.flights import FlightTeam
from vedette.missions.monitor.monitoring import Monitoring
from vedette.sim.domains import DOMAINS
from vedette.sim.monitor.domain import Monitor
from vedette.sim.network import Spawn

HOW = (
    "make an environment with `python3.11 -m venv DIR && DIR/bin/pip install sgptools` "
    "and give --sgptools DIR/bin/python"
)


@dataclass(frozen=True)
class Ways:
    """What SGP-Tools plans for a whole mission, once."""

    ways: tuple[Way, ...]  # a robot each
    cpu_s: float  # that it took


def check(python: str | None) -> None:
    """Raise InputError, which says how to make one, where there is no environment with SGP-Tools."""
    if python is None:
        raise InputError(f"sgptools needs its own environment; {HOW}")
    _run(python)


def ask(python: str, case: MonitorCase, seed: int) -> Ways:
    """Hand over field, prior, starts and budgets as a file; return the ways that come back.

    Raises:
        InputError: it cannot be run, or fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "task.json", Path(folder) / "ways.json"
        given.write_text(json.dumps(task(case, seed)), encoding="utf-8")
        _run(python, given, answer)
        told = json.loads(answer.read_text(encoding="utf-8"))
    ways = (Way(tuple((x, y) for x, y in places)) for places in told["ways"])
    return Ways(tuple(ways), told["cpu_s"])


def task(case: MonitorCase, seed: int) -> dict[str, Any]:
    """Return what a planner is told of a mission: what our robots know beforehand, too."""
    scenario = case.scenario
    [budget] = {vehicle.speed * scenario.duration for vehicle in scenario.vehicles}
    [variance] = {case.sensor(i).variance for i in range(len(scenario.vehicles))}
    return {
        "seed": seed,
        "area": scenario.area,
        "deviation": case.model.deviation,
        "length": case.model.length,
        "noise": variance**0.5,
        "starts": [vehicle.start for vehicle in scenario.vehicles],
        "budget": budget,
    }


class Given(Monitor):
    """Monitoring by robots that follow ways which are given beforehand, and go on from where they are."""

    def __init__(self, ways: Ways) -> None:
        super().__init__(DOMAINS["monitor"])
        self.ways = ways.ways

    def spawn(self, team: FlightTeam[MonitorCase]) -> Spawn:
        """Return who makes agents."""

        def assemble(robot: int, boot: int) -> Agent:
            def route(here: Place) -> Way:
                return Way((here, *self.ways[robot].places[1:]))

            agent = team.assemble(robot, boot)
            assert isinstance(agent.mission, Monitoring)
            agent.mission.patrol = route
            return agent

        return assemble


def _run(python: str, *files: Path) -> None:
    command = [python, planner.__file__, *map(str, files)]
    try:
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError(f"sgptools: cannot run {python}: {error.strerror}; {HOW}") from error
    if ran.returncode:
        said = ran.stderr.strip().splitlines() or ["it said nothing"]
        raise InputError(f"sgptools: {python} failed: {said[-1]}; {HOW}")
