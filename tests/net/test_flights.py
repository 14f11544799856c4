"""Vehicles as real processes: they track and search as the simulation does, whatever befalls one of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from click.testing import CliRunner, Result

from tests.fuzz.decoders import conditions
from tests.support.memory import watched
from tests.support.search_missions import case
from tests.support.track_scenes import content, scenario
from vedette.cli.team import team
from vedette.missions.flying import RoundTimes
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.net.report import Condition, read_condition
from vedette.net.search import content as pdfs
from vedette.net.track import content as tracks

TIMES = RoundTimes(0.02, 0.03)


def ran(*arguments: object) -> Result:
    """``vedette team`` with these arguments."""
    return CliRunner().invoke(team, list(map(str, arguments)), catch_exceptions=False)


def summary(folder: Path) -> dict[str, Any]:
    """Of a run."""
    loaded: dict[str, Any] = json.loads((folder / "summary.json").read_text())
    return loaded


def condition() -> Condition:
    """Some robot's."""
    (told,) = conditions()
    assert isinstance(told, Condition)
    return told


def test_tracks_that_a_vehicle_reports_are_its_own() -> None:
    """And not those that its team began with."""
    still = [{"model": "static", "mean": [100 * k, 80]} for k in (1, 2)]
    begun, plan = (
        TrackTeam(scenario(targets=[each | {"sd": [sd, sd]} for each in still]), TrackOptions(), TIMES)
        for sd in (25, 10)
    )
    told = tracks.TrackTeller(plan.assemble(0, 1), plan.scenario).content(0.0)
    view = tracks.view_of(condition(), told, begun.prior)
    np.testing.assert_array_equal(view.tracks.means, plan.prior.means)
    np.testing.assert_array_equal(view.tracks.covariances, plan.prior.covariances)
    assert (view.tracks.covariances != begun.prior.covariances).any()


def test_a_pdf_that_a_vehicle_reports_is_its_own() -> None:
    begun, plan = (
        SearchTeam(case(prior=[{"type": "gaussian", "mean": [x, 400], "sigma": 100}]), SearchOptions(), TIMES)
        for x in (300, 800)
    )
    told = pdfs.SearchTeller(plan.assemble(0, 1), plan.case).content(0.0)
    view, looks = pdfs.view_of(condition(), told, begun.case.pdf)
    assert view.pdf is not None
    np.testing.assert_allclose(view.pdf.mass, plan.case.pdf.mass, rtol=1e-6)
    assert np.abs(view.pdf.mass - begun.case.pdf.mass).sum() > 1.0
    assert looks == {}


def test_how_probably_the_target_has_left_is_reported_with_the_pdf() -> None:
    leaving = case(target={"drift": [60.0, 0.0], "border": "leave"})
    pdf = leaving.pdf.predict(3)
    agent = SearchTeam(replace(leaving, pdf=replace(pdf, step=0)), SearchOptions(), TIMES).assemble(0, 1)
    told = pdfs.SearchTeller(agent, leaving).content(0.0)
    view, _ = pdfs.view_of(condition(), told, leaving.pdf)
    assert view.pdf is not None
    assert 0.2 < pdf.outside == pytest.approx(view.pdf.outside, abs=1e-6)
    np.testing.assert_allclose(view.pdf.mass, pdf.mass, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("damage", [b"", b"\x00", b"\xff" * 40])
def test_reports_that_make_no_sense_are_refused(damage: bytes) -> None:
    with pytest.raises(ValueError, match="report"):
        tracks.view_of(condition(), damage, TrackTeam(scenario(), TrackOptions(), TIMES).prior)
    with pytest.raises(ValueError, match="report"):
        pdfs.view_of(condition(), damage, case().pdf)
    with pytest.raises(ValueError, match="report"):
        read_condition(damage)


def test_nobody_on_a_network_can_work_out_the_optimum() -> None:
    result = CliRunner().invoke(team, ["track", "--coordination", "optimum"])
    assert "nobody on a network can work it out" in str(result.exception)


@pytest.mark.slow
def test_processes_track_as_well_as_the_simulation(tmp_path: Path) -> None:
    result = ran("track", "--speed", 2, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    told = summary(tmp_path / "out")
    assert told["outcome"] == "complete"
    assert told["steps"] == 120
    assert told["rounds"] > 90
    assert told["entropy_mean_nat"] < 39.0  # 36.4 simulated; with shared beliefs alone 38.9
    assert 0.6 < told["nees"] < 1.6


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc")
def test_memory_is_flat_over_half_an_hour(tmp_path: Path) -> None:
    (tmp_path / "long.yaml").write_bytes(msgspec.yaml.encode(content(duration=1800)))
    with watched(5.0) as samples:
        result = ran("track", tmp_path / "long.yaml", "--speed", 8, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    team = [sample for sample in samples if len(sample) == 3 and min(sample) > 0.0]
    early, late = (np.mean(team[at : at + 3], axis=0) for at in (len(team) // 6, len(team) - 4))
    print(f"\nthree trackers' agents after 5 and 30 minutes: {early.round()} and {late.round()} MB")
    assert (late < early + 10.0).all()


@pytest.mark.slow
def test_processes_find_the_raft(tmp_path: Path) -> None:
    result = ran("search", "--speed", 4, "--out", tmp_path / "out")
    told = summary(tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert told["outcome"] == "found"
    assert told["error_m"] < 200.0
    assert told["detection_then"] > 0.3


@pytest.mark.slow
def test_a_tracking_team_gets_over_a_crash_a_restart_a_freeze_and_a_partition(tmp_path: Path) -> None:
    faults = tmp_path / "faults.yaml"
    faults.write_text(
        "faults:\n"
        "  - {at: 20, fault: crash, robot: 2}\n"
        "  - {at: 40, fault: restart, robot: 2}\n"
        "  - {at: 50, fault: freeze, robot: 3, for: 10}\n"
        "  - {at: 60, fault: partition, parts: [[1, 2], [3, 4]], for: 15}\n"
        "  - {at: 80, fault: loss, share: 0.2, for: 20}\n"
    )
    result = ran("track", "--speed", 2, "--out", tmp_path / "out", "--faults", faults)
    told = summary(tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert told["outcome"] == "complete"
    assert told["entropy_mean_nat"] < 48.0  # 57.5 without any coordination
    assert 0.5 < told["nees"] < 1.8
    assert min(told["path_m"].values()) > 800.0  # of 2400 m
