"""What a team is made of: each platform's body and lidar, as a team file lists them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from reprlib import repr as repr_short

from vedette.errors import InputError, check_limits
from vedette.number import is_number, is_whole
from vedette.parts import look_in
from vedette.scenario import as_scenario
from vedette.sensor import SENSOR
from vedette.yaml_file import read_yaml

ENDLESS = 1e6  # energy of a robot of which nobody says how far it gets
_LIMITS = {
    "speed": (0.01, 10.0, "m/s"),
    "turn_rate": (0.05, 20.0, "rad/s"),
    "radius": (0.02, 5.0, "m"),
    "range": (0.2, 200.0, "m"),
    "view": (1.0, 360.0, "deg"),
    "beams": (8, 4096, "beams"),
    "rate": (0.2, 50.0, "Hz"),
    "range_noise": (0.0, 1.0, "m"),
    "pose_std": (0.0, 1.0, "m"),
    "pose_std_heading": (0.0, 30.0, "deg"),
    "drift": (0.0, 0.1, "per root of m and rad"),
    "energy": (1.0, ENDLESS, "m, or Wh"),
    "drain": (1e-3, 1e4, "Wh/m"),
}
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")


@dataclass(frozen=True)
class PlatformSpec:
    """One robot: a disc that drives and turns in place, with a planar lidar at its centre.

    Raises:
        InputError: a field has the wrong type or is out of its range; the line names field, value and range.
    """

    name: str = "robot-1"  # letters, digits, '-', '_' and '.', for it becomes part of file and topic names
    speed: float = 0.5  # top speed [m/s]
    turn_rate: float = 1.5  # top turn rate [rad/s]
    radius: float = 0.2  # of the disc [m]
    range: float = 8.0  # of the lidar [m]
    view: float = 360.0  # field of view, centred on the heading [deg]
    beams: int = 360
    rate: float = 5.0  # scans a second [Hz]
    range_noise: float = 0.01  # standard deviation of a range [m]
    start: tuple[float, ...] | None = None  # x, y[, heading] [m, m, deg], team frame; None: chosen
    pose_std: float = 0.0  # standard deviation of each coordinate of the place that it is told [m]
    pose_std_heading: float = 0.0  # and of the heading [deg]
    drift: float = 0.0  # of its odometry after a metre [m, rad] and a radian [rad], SLAM corrects it
    energy: float = ENDLESS  # way that it can drive [m]; with ``drain``, what its battery holds [Wh]
    drain: float = 1.0  # [Wh/m]
    sensor: str | None = None  # a class of somebody's own, ``module:NAME``; None: the lidar

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not _NAME.fullmatch(self.name):
            raise InputError(
                f"name must be letters, digits, '-', '_' or '.', at most 64; got {repr_short(self.name)}"
            )
        check_limits(self, _LIMITS)
        if self.drift and (self.pose_std or self.pose_std_heading):
            raise InputError("drift makes the pose wrong already; leave out pose_std and pose_std_heading")
        if not is_whole(self.beams):
            raise InputError(f"beams must be a whole number; got {self.beams}")
        if self.sensor is not None:
            SENSOR.find(self.sensor)
        if self.start is not None and not _is_start(self.start):
            got = list(self.start) if isinstance(self.start, tuple) else self.start
            raise InputError(f"start must be [x, y] or [x, y, heading in deg]; got {repr_short(got)}")

    @property
    def way(self) -> float:
        """The way that its energy is good for [m]; inf: nobody says."""
        return inf if self.energy == ENDLESS else self.energy / self.drain


def _is_start(start: object) -> bool:
    return isinstance(start, tuple) and len(start) in (2, 3) and all(map(is_number, start))


def check_team(specs: Iterable[PlatformSpec]) -> tuple[PlatformSpec, ...]:
    """Return a team's platforms; InputError for nobody, what is no platform, or two of one name."""
    if not isinstance(specs, Iterable):
        raise InputError(f"the team is {repr_short(specs)}; give a list of PlatformSpec")
    team, names = tuple(specs), set[str]()
    if not team:
        raise InputError("the team is empty; give at least one PlatformSpec")
    for i, spec in enumerate(team):
        if not isinstance(spec, PlatformSpec):
            raise InputError(f"platform {i} is {repr_short(spec)}; give a PlatformSpec")
        if spec.name in names:
            raise InputError(f"platform {i}: the name {spec.name!r} is used twice; names must differ")
        names.add(spec.name)
    return team


@dataclass(frozen=True)
class Most:
    """What no platform of the team exceeds."""

    range: float  # of the lidar or detector [m]
    speed: float  # [m/s]

    @classmethod
    def of(cls, specs: Sequence[PlatformSpec]) -> Most:
        """Return the limits of a team; uncertain poses blur footprints over the lidar's range."""
        reaches = [spec.range + 4.0 * spec.pose_std for spec in specs]
        return cls(max(reaches), max(spec.speed for spec in specs))


def load_team(path: Path | str) -> list[PlatformSpec]:
    """Read a team file: YAML with one list, ``platforms``, of which every field has a default.

    Units are those of :class:`PlatformSpec`: metres, m/s, rad/s, Hz, and degrees for ``view``,
    ``pose_std_heading`` and the heading in ``start``. A platform without a name is called ``robot-N``, N its
    place in the list from 1::

        platforms:
          - {name: scout, speed: 1.0, range: 12, start: [2.0, 3.5, 90]}
          - {}

    Raises:
        InputError: unreadable, not YAML, no platforms, an unknown field (with the nearest valid name), a
            wrong type, a value out of range, a name used twice; the line names file, platform and field.
    """
    remedy = "a team file is a list under 'platforms:' of at least one, for instance '- {}'"
    content = read_yaml(Path(path), "team file", remedy)
    look_in(Path(path).parent)
    entries = content.get("platforms") if isinstance(content, dict) and len(content) == 1 else None
    if not isinstance(entries, list) or not entries:
        raise InputError(f"{path}: {remedy}; got {repr_short(content)}")
    specs: list[PlatformSpec] = []
    names: set[str] = set()
    for number, entry in enumerate(entries, start=1):
        where = f"{path}: platform {number}"
        spec = as_scenario({} if entry is None else entry, PlatformSpec, where)
        specs.append(spec if entry and "name" in entry else replace(spec, name=f"robot-{number}"))
        if specs[-1].name in names:
            raise InputError(f"{where}: the name {specs[-1].name!r} is used twice; names must differ")
        names.add(specs[-1].name)
    return specs
