"""One run of a study: all that decides how it goes, and its name."""

from __future__ import annotations

import hashlib
import json
import warnings
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeAlias

import msgspec

from vedette.domains.mapping.planners import PLANNER
from vedette.errors import InputWarning
from vedette.maps.world import World
from vedette.number import many
from vedette.sensor import SENSOR
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import WORLD, generated
from vedette.team import PlatformSpec

Value: TypeAlias = str | int | float | bool | None
LAYOUT = 1  # of a result file; goes up when its figures change their meaning
OF_PLATFORM = tuple(f.name for f in fields(PlatformSpec) if f.name not in ("name", "start"))
OF_SETUP = tuple(f.name for f in fields(ExploreSetup) if f.name not in ("planner", "seed", "faults_from"))


@dataclass(frozen=True)
class GeneratedWorld:
    """A world that is made when it is needed."""

    kind: str  # a name of ``vedette.sim.worlds.WORLD``
    seed: int
    width: float  # [m]
    height: float  # [m]
    resolution: float  # [m]

    @property
    def name(self) -> str:
        """What worlds of this kind and size are called together."""
        size = f" {self.width:g}x{self.height:g}"
        return self.kind + (size if (self.width, self.height) != (30.0, 20.0) else "")

    def identity(self) -> dict[str, Value]:
        """Return what makes it this world and no other."""
        return asdict(self)

    def build(self) -> World:
        """Make it."""
        return generated(self.kind, self.seed, self.width, self.height, self.resolution)


@dataclass(frozen=True)
class MapWorld:
    """A map in a file, known again by what is in it, wherever the file is."""

    path: Path
    scale: float | None  # [m per pixel], of a plain image
    name: str
    digest: str  # of its cells
    resolution: float  # [m]
    seed: None = None

    @classmethod
    def read(cls, path: Path, scale: float | None) -> MapWorld:
        """Read the map of a file.

        Raises:
            InputError: as ``World.from_map``.
        """
        world = World.from_map(path, scale)
        digest = hashlib.sha256(world.solid.tobytes() + str(world.frame).encode()).hexdigest()[:12]
        return cls(path.resolve(), scale, world.name, digest, world.frame.resolution)

    def identity(self) -> dict[str, Value]:
        """Return what makes it this world and no other."""
        return {"map": self.digest}

    def build(self) -> World:
        """Read it again; what there is to say of it was said when it was first read."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputWarning)
            return World.from_map(self.path, self.scale)


@dataclass(frozen=True)
class Run:
    """One mission of a study."""

    world: GeneratedWorld | MapWorld
    robots: int
    starts: str  # together, apart
    platform: PlatformSpec  # of every robot
    setup: ExploreSetup  # with the planner and the seed

    def key(self, code: str) -> str:
        """Return 16 hexadecimal digits that name the run as this code carries it out."""
        return _digest({"code": code, "layout": LAYOUT, **self._own_code(), **self._parameters()}, 16)

    @property
    def case(self) -> str:
        """12 hexadecimal digits that runs have in common if they differ in their planner alone."""
        return _digest(replace(self, setup=replace(self.setup, planner=""))._parameters(), 12)

    def columns(self) -> dict[str, Value]:
        """Return what a row of results says of the run itself."""
        return {
            "planner": self.setup.planner,
            "world": self.world.name,
            "world_seed": self.world.seed,
            "world_id": _digest(self.world.identity(), 12),
            "resolution": self.world.resolution,
            "robots": self.robots,
            "starts": self.starts,
            "seed": self.setup.seed,
            **{name: _cell(getattr(self.platform, name)) for name in OF_PLATFORM},
            **{name: _cell(getattr(self.setup, name)) for name in OF_SETUP},
            "scheme": self.setup.options.negotiates_by,
        }

    def __str__(self) -> str:
        """Name the run in a line of progress."""
        world = self.world.name + ("" if self.world.seed is None else f" {self.world.seed}")
        team = f"{many(self.robots, 'robot')} {self.starts}"
        return f"{world}, {team}, {self.setup.planner}"

    def _own_code(self) -> dict[str, Value]:
        """Return what changes with the code of parts that are somebody's own; nothing where none is."""
        named = [("planner", PLANNER.fingerprint(self.setup.planner))]
        if self.platform.sensor is not None:
            named.append(("sensor", SENSOR.fingerprint(self.platform.sensor)))
        if isinstance(self.world, GeneratedWorld):
            named.append(("kind", WORLD.fingerprint(self.world.kind)))
        return {f"code of {what}": code for what, code in named if code is not None}

    def _parameters(self) -> dict[str, Any]:
        return {
            "world": self.world.identity(),
            "robots": self.robots,
            "starts": self.starts,
            "platform": {name: getattr(self.platform, name) for name in OF_PLATFORM},
            "setup": self.setup,
        }


def _cell(value: Any) -> Value:
    """Return a value that a column can hold: what has parts is JSON, nothing where it has none."""
    if value is None or isinstance(value, str | bool | int | float):
        return value
    return _text(value) if value else ""


def _text(value: Any) -> str:
    return json.dumps(msgspec.to_builtins(value), sort_keys=True, separators=(",", ":"))


def _digest(value: Any, digits: int) -> str:
    return hashlib.sha256(_text(value).encode()).hexdigest()[:digits]
