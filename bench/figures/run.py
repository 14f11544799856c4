"""One mission by its command, and what is kept of what it says and leaves."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from PIL import Image

from bench.figures.missions import FREE_AREA, Mission
from vedette.errors import InputError

OUT = "out"  # the mission's folder, in the one that it is run in
WHITE = 254  # of free cells, as map_server takes them
_STATE = re.compile(r"\brobot-\d+ (\w+)")


def carry_out(mission: Mission, folder: Path, maps: Path | None) -> dict[str, Any]:
    """Run a mission in an empty folder; return its figures, and its wall and CPU time [s].

    Raises:
        InputError: its map is not in the folder of maps.
    """
    if mission.map:
        _copy_map(mission.map, maps, folder)
    if mission.before:
        _run(mission.before, folder)
    began, before = time.perf_counter(), os.times()
    said = _run(f"{mission.command} --out {OUT}", folder)
    wall, after = time.perf_counter() - began, os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    summary = json.loads((folder / OUT / "summary.json").read_text(encoding="utf-8"))
    return {
        "command": mission.command,
        **_told(said, summary["outcome"]),
        "figures": {name: _figure(folder / OUT, summary, name) for name in mission.figures},
        "wall_s": round(wall, 1),
        "cpu_s": round(cpu, 1),
    }


def _told(said: str, outcome: str) -> dict[str, Any]:
    """Return the line that tells the outcome, of frontiers left out, and how each robot was in the end."""
    lines = said.splitlines()
    end = next(i for i, line in enumerate(lines) if line.startswith(outcome))
    states = _STATE.findall(lines[end - 1]) if end else []
    left = [line for line in lines[end + 1 :] if line.startswith("frontiers left out")]
    told: dict[str, Any] = {"closing": lines[end]}
    if left:
        told["left_out"] = left[0]
    return told | ({"robots": states} if states else {})


def _figure(folder: Path, summary: Mapping[str, Any], name: str) -> Any:
    """Return a field of the summary, or the area that the map shows free."""
    if name == FREE_AREA:
        resolution = yaml.safe_load((folder / "map.yaml").read_text(encoding="utf-8"))["resolution"]
        cells = np.asarray(Image.open(folder / "map.pgm")) == WHITE
        return round(np.count_nonzero(cells) * resolution**2, 1)
    value: Any = summary
    for part in name.split("."):
        value = value[part]
    return value


def _copy_map(name: str, maps: Path | None, folder: Path) -> None:
    files = [] if maps is None else sorted(maps.glob(f"{name}.*"))
    if not files:
        raise InputError(f"no {name}.yaml in {maps}; give --maps DIR" if maps else f"{name} needs --maps DIR")
    for path in files:
        shutil.copy(path, folder)


def _run(command: str, folder: Path) -> str:
    """Run a command of ``vedette`` in a folder; return what it says on standard output."""
    words = [sys.executable, "-m", *shlex.split(command)]
    ran = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    if ran.returncode not in (0, 1):
        raise RuntimeError(f"{command}: exit status {ran.returncode}\n{ran.stderr}")
    return ran.stdout
