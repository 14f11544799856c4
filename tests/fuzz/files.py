"""Targets that are files: scenarios, teams, maps and their images."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from datetime import UTC, datetime
from importlib import resources
from pathlib import Path

import numpy as np
from PIL import Image

from tests.fuzz.mutation import Mutate, mutate_bytes, mutate_text
from tests.fuzz.target import Broken, Target
from vedette.errors import InputError
from vedette.maps import read_map
from vedette.missions.search.case import read_case
from vedette.missions.track.scenario import read_scenario
from vedette.net.config import access_of, load_config
from vedette.sim.faults import load_faults
from vedette.study.combinations import runs_of
from vedette.study.spec import load_spec
from vedette.team import load_team

TEAM = b"""platforms:
- {name: scout, speed: 1.0, range: 12, start: [2.0, 3.5, 90]}
- {turn_rate: 2e0, view: 270, beams: 180}
- {}
"""
MAP = b"""image: map.pgm
mode: trinary
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
PRIORS = b"""area: [0, 0, 800, 600]
cell: 40
prior:
- {type: uniform}
- {type: polygon, corners: [[100, 100], [500, 120], [300, 400]]}
- {type: heat, file: map.pgm, weight: 2}
- {type: gaussian, mean: [350, 450], covariance: [[900, 0], [0, 400]]}
detector: {type: definite, detection: 0.9, range: 70}
vehicles:
- {start: [200, 100, 60], speed: 30, turn_rate: 0.4}
"""
FAULTS = b"""faults:
- {at: 0, fault: skew, robot: 2, s: 3.5, ppm: -40}
- {at: 3, fault: loss, share: 0.3, for: 9}
- {at: 4, fault: delay, between: [0.01, 0.4]}
- {at: 5, fault: partition, parts: [[1, 2], [3]], for: 6}
- {at: 6, fault: one-way, from: 1, to: 3}
- {at: 7, fault: crash, robot: 3}
- {at: 9, fault: restart, robot: 3}
- {at: 12, fault: freeze, robot: 1, for: 4}
- {at: 20, fault: heal}
"""
CONFIG = b"""team: office
robot: 2
robots: 3
best: {range: 12, speed: 1.0}
body: {map: map.yaml, start: [2.0, 3.5, 90], range: 12, beams: 180}
links:
  listen: [tcp/0.0.0.0:7447]
  connect: ['tcp/[::1]:7448', tcp/robot-1.local:7447]
  insecure: true
  address: 10.0.0.2
explore: {planner: tours, scheme: jacobi, fusion: channel, return_home: true}
"""
STUDY = b"""planners: [tours, greedy]
worlds:
- {kind: maze, seeds: [1, 2], width: 10, height: 8}
robots: [1, 3]
starts: [together, apart]
seeds: [0, 1]
platform: {range: [6.0, 8.0], beams: 90}
setup: {scheme: [token, jacobi], link_loss: 0.1}
reference: greedy
"""
ROBOTS = 4  # that a schedule of faults is for
NOW = datetime(2026, 1, 1, tzinfo=UTC)
PIXELS = np.array([[0, 254, 205, 100], [254, 254, 0, 0], [205, 0, 254, 254]], np.uint8)


def _file(
    name: str,
    load: Callable[[Path], object],
    file: str,
    seeds: Callable[[], list[bytes]],
    mutate: Mutate = mutate_text,
) -> Target:
    """A target that writes its input to a file of this name, beside an image, and reads it."""

    def read(data: bytes) -> None:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "map.pgm").write_bytes(_image("PPM"))
            path = Path(folder) / file
            path.write_bytes(data)
            try:
                load(path)
            except InputError as error:
                if "\n" in str(error):
                    raise Broken(f"{name}: the message is more than a line: {error}") from error

    return Target(name, seeds, read, mutate)


def _image(kind: str, mode: str = "L") -> bytes:
    file = io.BytesIO()
    Image.fromarray(PIXELS).convert(mode).save(file, kind)
    return file.getvalue()


def _images() -> list[bytes]:
    return [
        b"P2\n# a comment\n4 2\n255\n0 254 205 3\n254 254 0 9\n",
        b"P5\n2 2\n65535\n" + bytes(range(8)),
        *(
            _image(kind, mode)
            for kind in ("PPM", "PNG", "BMP", "JPEG")
            for mode in ("L", "RGB", "1")
            if _can(kind, mode)
        ),
        *(_image("PNG", mode) for mode in ("LA", "RGBA", "P", "I;16")),
    ]


def _can(kind: str, mode: str) -> bool:
    return (kind, mode) != ("JPEG", "1")


def _packaged(name: str) -> bytes:
    return resources.files("vedette.missions").joinpath("scenarios", name).read_bytes()


def _read_plain(path: Path) -> object:
    return read_map(path, 0.1)


def _read_faults(path: Path) -> object:
    return load_faults(str(path), ROBOTS)


def _read_config(path: Path) -> object:
    config = load_config(path)
    return config.links.reached_at, access_of(config, path.parent, NOW)


def _read_study(path: Path) -> object:
    return runs_of(load_spec(path), path)


def files() -> list[Target]:
    """Return them all."""
    return [
        _file("file-search", read_case, "search.yaml", lambda: [_packaged("search.yaml"), PRIORS]),
        _file("file-track", read_scenario, "track.yaml", lambda: [_packaged("track.yaml")]),
        _file("file-team", load_team, "team.yaml", lambda: [TEAM]),
        _file("file-map", read_map, "map.yaml", lambda: [MAP, MAP.replace(b"trinary", b"raw")]),
        _file("file-faults", _read_faults, "faults.yaml", lambda: [FAULTS]),
        _file("file-agent", _read_config, "agent.yaml", lambda: [CONFIG]),
        _file("file-study", _read_study, "study.yaml", lambda: [STUDY]),
        _file("file-image", _read_plain, "map.png", _images, mutate_bytes),
    ]
