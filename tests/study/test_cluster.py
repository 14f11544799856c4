"""A study on a Dask cluster of two workers on this host, one of which is killed midway."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.commands import start
from tests.support.dask_cluster import PATIENCE, Cluster
from tests.support.net_team import wait_until
from tests.support.schemas import valid

RUNS = 24
SPEC = f"""
planners: [nearest, burgard]
worlds: [{{kind: maze, seeds: {list(range(RUNS // 2))}, width: 10, height: 10}}]
robots: [1]
platform: {{beams: 90, rate: 2}}
setup: {{max_time: 60}}
"""


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


@pytest.mark.slow
def test_a_worker_of_a_cluster_that_is_killed_loses_nothing_and_nothing_is_counted_twice(
    cluster: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", cluster.address)
    doomed, _ = cluster.worker(), cluster.worker()
    (tmp_path / "tiny.yaml").write_text(SPEC)
    process = start(["study", "tiny.yaml", "--backend", "dask", "--out", "out"], tmp_path)
    results = tmp_path / "out" / "runs"
    wait_until(lambda: process.poll() is not None or len(list(results.glob("*.json"))) >= 4, PATIENCE)
    assert process.poll() is None, "the study was over before the worker could be killed"
    doomed.kill()
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    files = [valid("study-run", file.read_bytes()) for file in results.glob("*.json")]
    assert [file["result"]["figures"]["error"] for file in files] == [""] * RUNS
    told = Counter(re.findall(r"left: (.*): ", out.decode()))
    assert len(told) == RUNS
    assert set(told.values()) == {1}
    again = start(["study", "tiny.yaml", "--backend", "dask", "--out", "out"], tmp_path)
    assert (
        f"{RUNS} runs, {RUNS} of them done before, 0 to do".encode() in again.communicate(timeout=PATIENCE)[0]
    )
