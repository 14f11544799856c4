"""Vehicles of a declared domain as processes: what they tell is their own, and they do as in simulation."""

from __future__ import annotations

import json
import zlib
from pathlib import Path

import msgspec
import numpy as np
import pytest
import yaml
from click.testing import CliRunner, Result

from tests.fuzz.decoders import conditions
from tests.support.monitor_scenes import SMALL, case
from vedette import InputError
from vedette.agent.events import Pose, Sensed
from vedette.cli.team import team
from vedette.domains.monitoring.content import FieldContent, belief_of
from vedette.missions.flights import TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.missions.monitor.assemble import MonitorTeam
from vedette.missions.monitor.monitoring import FieldLook, Monitoring
from vedette.net.config import load_config
from vedette.net.domain import DomainTeller, DomainWatcher, vehicle
from vedette.record.summary import Setting
from vedette.sim.domains import domain_of

TIMES = RoundTimes(0.02, 0.03)
MONITOR = domain_of("monitor")


def ran(*arguments: object) -> Result:
    """``vedette team`` with these arguments."""
    return CliRunner().invoke(team, list(map(str, arguments)), catch_exceptions=False)


def plan() -> MonitorTeam:
    return MonitorTeam(case(), TeamOptions(), TIMES)


def test_a_belief_that_a_vehicle_reports_is_its_own() -> None:
    known = plan()
    agent = known.assemble(0, 1)
    mission = agent.mission
    assert isinstance(mission, Monitoring)
    mission.observe(Sensed(FieldLook(50, 23.0), 1.0), Pose(2.0, 3.0, 0.0), (), 1.0)
    mission.publish(1.0)
    told = DomainTeller(agent, MONITOR, known.case).content(3.0)
    belief = belief_of(msgspec.msgpack.decode(told, type=FieldContent), known.plan.prior)
    np.testing.assert_array_equal(belief.information, mission.known(3).information)
    np.testing.assert_array_equal(belief.vector, mission.known(3).vector)
    assert belief.information.max() > 0.0


def damaged(information: bytes) -> bytes:
    return msgspec.msgpack.encode(FieldContent(0, information, zlib.compress(np.zeros(384).tobytes())))


@pytest.mark.parametrize(
    "damage",
    [
        b"",
        b"\xff" * 40,
        damaged(b"junk"),
        damaged(zlib.compress(b"\0" * 8)),
        damaged(zlib.compress(np.full(384, np.nan).tobytes())),
        damaged(zlib.compress(np.full(384, -1.0).tobytes())),
    ],
)
def test_reports_that_make_no_sense_are_refused(damage: bytes) -> None:
    (condition,) = conditions()
    watcher = DomainWatcher(MONITOR, plan(), Setting(seed=0))
    with pytest.raises(ValueError, match="report"):
        watcher.take(condition, damage)


@pytest.mark.parametrize(
    ("domain", "words"),
    [
        ({"name": "monitr"}, "did you mean 'monitor'"),
        ({"name": "monitor", "coordination": "optimum"}, "domain.coordination"),
        ({"name": "monitor", "fusion": "sum"}, "domain.fusion"),
        ({"name": "monitor", "scheme": "tokn"}, "domain.scheme"),
    ],
)
def test_a_robots_file_of_a_domain_that_cannot_be_is_refused(
    domain: dict[str, str], words: str, tmp_path: Path
) -> None:
    file = tmp_path / "robot.yaml"
    begins = "2027-01-31T12:00:00Z"
    file.write_text(yaml.safe_dump({"team": "t", "robot": 1, "domain": domain, "begins": begins}))
    with pytest.raises(InputError, match=words):
        vehicle(load_config(file), tmp_path, 1, 1.0)


def test_nobody_on_a_network_can_work_out_the_optimum() -> None:
    result = CliRunner().invoke(team, ["monitor", "--coordination", "optimum"])
    assert "nobody on a network can work it out" in str(result.exception)


@pytest.mark.slow
def test_processes_measure_a_field_and_go_on_when_one_dies(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(yaml.safe_dump(SMALL | {"duration": 30}))
    (tmp_path / "faults.yaml").write_text("faults:\n  - {at: 15, fault: crash, robot: 2}\n")
    out = tmp_path / "out"
    result = ran(
        "monitor", tmp_path / "small.yaml", "--speed", 2, "--out", out, "--faults", tmp_path / "faults.yaml"
    )
    assert result.exit_code == 0, result.output
    told = json.loads((out / "summary.json").read_text())
    assert told["outcome"] == "complete"
    assert told["lost"] == ["heron"]
    assert told["rounds"] > 3
    assert told["rmse"] < 3.0
    assert told["nees"] < 2.0
