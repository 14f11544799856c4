"""``vedette team ... --watch`` with real processes: one page for the team, which ends with it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
import yaml
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tests.support import search_missions, track_scenes
from tests.support.monitor_scenes import SMALL

pytestmark = pytest.mark.slow


@contextmanager
def team(*arguments: object) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A team that is watched, and the address that it prints."""
    command = [sys.executable, "-m", "vedette", "team", *map(str, arguments), "--watch"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr is not None
            said = iter(process.stderr.readline, "")
            yield process, next(found[1] for line in said if (found := re.search(r"watch it at (\S+)", line)))
        finally:
            process.terminate()


def until(page: ClientConnection, holds: Any) -> dict[str, Any]:
    """Take what comes until it tells of a moment in which something holds."""
    end = time.monotonic() + 90.0
    while time.monotonic() < end:
        message = page.recv(timeout=30.0)
        if isinstance(message, str) and "now" in (told := json.loads(message)) and holds(told["now"]):
            return dict(told)
    raise AssertionError("it never came to that")


def flying(moment: dict[str, Any]) -> bool:
    """Whether all vehicles are on their way, and linked."""
    return all(each["path"] for each in moment["robots"]) and bool(moment["links"])


@pytest.mark.parametrize(
    ("mission", "scenario"),
    [
        ("track", track_scenes.content()),
        ("search", search_missions.SMALL | {"target": {"start": [1100, 700]}}),
        ("monitor", SMALL | {"duration": 30}),
    ],
)
def test_a_team_of_vehicles_is_on_one_page_that_ends_with_it(
    mission: str, scenario: dict[str, Any], tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scenario))
    out = tmp_path / "out"
    with team(mission, tmp_path / "scene.yaml", "--speed", 2, "--out", out) as (process, address):
        watch = address.replace("http", "ws").replace("/?", "/watch?")
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(address.partition("?")[0], timeout=5.0)
        with connect(watch) as page, connect(watch) as garbage:
            told = until(page, flying)
            assert len(told["now"]["robots"]) == len(scenario["vehicles"])
            garbage.send("[")
            with pytest.raises(ConnectionClosed):
                list(garbage)
            until(page, lambda moment: moment["t"] > told["now"]["t"])
            with suppress(ConnectionClosed):  # the page ends with the team
                list(page)
        process.communicate(timeout=60.0)
    assert process.returncode in (0, 1)
    assert (out / "summary.json").exists()


def test_orders_of_a_file_are_given_at_their_times_and_obeyed_by_processes(tmp_path: Path) -> None:
    corners = [[130, 100], [190, 100], [190, 160], [130, 160]]
    orders = [
        {"at": 4, "order": "no-go", "area": "yard", "corners": corners},
        {"at": 6, "order": "recall", "to": [150, 130]},
        {"at": 8, "order": "recall"},
    ]
    (tmp_path / "orders.yaml").write_text(yaml.safe_dump({"orders": orders[:1] + orders[2:]}))
    (tmp_path / "wrong.yaml").write_text(yaml.safe_dump({"orders": orders}))
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(track_scenes.content(duration=60)))
    command = [sys.executable, "-m", "vedette", "team", "track", tmp_path / "scene.yaml", "--speed", 2]
    ran, refused = (
        subprocess.run(
            [*map(str, command), "--orders", str(tmp_path / file), "--out", str(tmp_path / "out"), "--json"],
            capture_output=True, text=True, timeout=120.0, check=False,
        )
        for file in ("orders.yaml", "wrong.yaml")
    )  # fmt: skip
    assert refused.returncode == 2
    assert "150, 130 lies in the no-go area yard" in refused.stderr
    told = json.loads(ran.stdout)
    assert told["outcome"] == "ordered"
    assert ran.returncode == 0
    assert (
        len(re.findall(r"order (?:no-go area yard|recall): taken by vehicle-1, vehicle-2", ran.stderr)) == 2
    )
