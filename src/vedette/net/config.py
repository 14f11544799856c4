"""What one robot's agent process is told: its team, its links, its mission, its body."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields
from datetime import datetime
from pathlib import Path
from typing import Annotated

from msgspec import Meta, Struct

from vedette.domains.mapping.planners import planner
from vedette.errors import InputError, nearest_name
from vedette.fusion.gaussian import WAYS
from vedette.maps.area import Area
from vedette.missions.explore.assemble import FUSIONS
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.flights import COORDINATIONS, TeamOptions
from vedette.missions.flights import FUSIONS as STEP_FUSIONS
from vedette.missions.search.options import SearchOptions
from vedette.missions.track import options as track_options
from vedette.missions.track.options import TrackOptions
from vedette.negotiation import SCHEMES
from vedette.net.access import Access
from vedette.net.credentials import credentials
from vedette.net.names import MOST_ROBOTS
from vedette.net.own import OwnSettings
from vedette.parts import look_in
from vedette.ros2.settings import Ros2Settings
from vedette.scenario import load_scenario
from vedette.team import ENDLESS, PlatformSpec

OF_BODY = tuple(field.name for field in fields(PlatformSpec) if field.name not in ("name", "start"))
MISSIONS = ("explore", "track", "search", "domain")
RESOLUTION = 0.1  # of the map that robots make which are not simulated in one [m]
ADMITTED = 64  # robots numbered higher are let in only by a robot that knows of so many

Robot = Annotated[int, Meta(ge=1, le=MOST_ROBOTS)]


class LinkSettings(Struct, forbid_unknown_fields=True, frozen=True):
    """How the robot is reached, and whom it reaches."""

    listen: tuple[str, ...] = ()  # endpoints of this robot
    connect: tuple[str, ...] = ()  # endpoints of others; whichever end connects, the link goes both ways
    keys: str | None = None  # folder with ca.pem, cert.pem and key.pem, beside this file
    insecure: bool = False  # plain TCP, open to everybody
    scouting: bool = False  # find others by multicast as well
    lease: Annotated[float, Meta(ge=0.2, le=60.0)] = 3.0  # after which a silent neighbour is given up [s]
    delay: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.02  # of a message, as vehicles reckon with it [s]
    address: str | None = None  # where others reach ``listen``, if that says 0.0.0.0

    @property
    def reached_at(self) -> tuple[str, ...]:
        """Endpoints as others have to write them."""
        if self.address is None:
            return self.listen
        return tuple(
            re.sub(r"/(?:0\.0\.0\.0|\[::\]):", f"/{self.address}:", endpoint) for endpoint in self.listen
        )


class BodySettings(Struct, forbid_unknown_fields=True, frozen=True):
    """The robot itself: one that runs ROS 2, a class of one's own, or a simulated one."""

    ros2: Ros2Settings | None = None  # how a real one is reached; its lidar is what it tells of it
    own: OwnSettings | None = None  # a class of one's own for a robot of any kind
    map: str | None = None  # the world: a map_server .yaml beside this file, or an image
    start: tuple[float, float, float] | None = None  # x, y, heading [m, m, deg], the world's frame
    frame: tuple[float, float, float] | None = None  # a simulated robot's own; None: that
    resolution: float | None = None  # of an image [m]
    seed: Annotated[int, Meta(ge=0)] = 0  # of the lidar's noise
    speed: float = 0.5  # [m/s]
    turn_rate: float = 1.5  # [rad/s]
    radius: float = 0.2  # [m]
    range: float = 8.0  # of the lidar [m]
    view: float = 360.0  # [deg]
    beams: int = 360
    rate: float = 5.0  # scans a second [Hz]
    range_noise: float = 0.01  # [m]
    pose_std: float = 0.0  # of the pose that the robot is told [m]
    pose_std_heading: float = 0.0  # [deg]
    drift: float = 0.0  # of the simulated robot's odometry [m, rad]
    energy: float = ENDLESS  # way that it can drive [m]; with ``drain``, what its battery holds [Wh]
    drain: float = 1.0  # [Wh/m]
    sensor: str | None = None  # a class of somebody's own, ``module:NAME``; None: the lidar

    def spec(self, name: str) -> PlatformSpec:
        """Return the platform.

        Raises:
            InputError: a field is out of its range.
        """
        return PlatformSpec(name, start=self.start, **{field: getattr(self, field) for field in OF_BODY})


class BestOfTeam(Struct, forbid_unknown_fields=True, frozen=True):
    """What no robot of the team exceeds: who claims to see more is not believed."""

    range: Annotated[float, Meta(gt=0.0)]  # of the lidar [m]
    speed: Annotated[float, Meta(gt=0.0)]  # [m/s]


class DomainOptions(TeamOptions, forbid_unknown_fields=True, frozen=True, kw_only=True):
    """The domain of a vehicle, if it is neither of the others; ``vedette.sim.domains`` knows of it."""

    name: str


class AgentConfig(Struct, forbid_unknown_fields=True, frozen=True):
    """One robot's file for ``vedette agent``."""

    team: str
    robot: Robot
    body: BodySettings = BodySettings()
    robots: Robot = 1  # it waits for so many, itself included, before it begins; for a while
    best: BestOfTeam | None = None  # of the whole team; None: as this robot
    links: LinkSettings = LinkSettings()
    explore: ExploreOptions | None = None  # one of the four; without any, it explores
    track: TrackOptions | None = None
    search: SearchOptions | None = None
    domain: DomainOptions | None = None
    scenario: str | None = None  # of vehicles, beside this file; None: the one that is built in
    begins: Annotated[datetime, Meta(tz=True)] | None = None  # when the mission's, or the faults', time is 0
    faults: str | None = None  # a schedule of what befalls links, beside this file; to try a team
    out: str | None = None  # folder for what it finds out, beside this file

    @property
    def mission(self) -> str:
        """What the robot does: one of MISSIONS."""
        return next((name for name in MISSIONS if getattr(self, name) is not None), MISSIONS[0])

    @property
    def flies(self) -> TrackOptions | TeamOptions | None:
        """How it is one of a team of vehicles, by a scenario; None: it explores."""
        return self.track or self.search or self.domain


def load_config(path: Path | str) -> AgentConfig:
    """Read and check a robot's file.

    Raises:
        InputError: as :func:`vedette.scenario.load_scenario`, or a name or number that cannot be.
    """
    config = load_scenario(path, AgentConfig, "robot's file")
    look_in(Path(path).parent)
    try:
        _check_missions(config)
        if config.mission == "explore":
            _check_explore(config)
        else:
            _check_flight(config)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return config


def access_of(config: AgentConfig, folder: Path, now: datetime) -> Access:
    """Return how a robot takes part in its team; paths are relative to ``folder``.

    Raises:
        InputError: keys that do not admit this robot now, or links that cannot be.
    """
    links = config.links
    return Access(
        team=config.team,
        listen=links.listen,
        connect=links.connect,
        credentials=None if links.keys is None else credentials(folder / links.keys, now),
        insecure=links.insecure,
        robots=max(ADMITTED, config.robots, config.robot),
        lease=links.lease,
        scouting=links.scouting,
    )


def _check_missions(config: AgentConfig) -> None:
    given = [name for name in MISSIONS if getattr(config, name) is not None]
    if len(given) > 1:
        raise InputError(f"{given[1]}: a robot has one mission, and {given[0]} is given too; leave one out")


def _check_explore(config: AgentConfig) -> None:
    options = config.explore or ExploreOptions()
    try:
        planner(options.planner, config.robots)
    except InputError as error:
        raise InputError(f"explore.planner: {error}") from error
    _check_scheme("explore", options.scheme)
    _check_word("explore.fusion", options.fusion, list(FUSIONS))
    _ = options.negotiates_by
    _check_frames(config.body, options)
    _check_ground(config.body, options)
    real = config.body.ros2
    if real is not None and real.evidence == "map" and options.fusion == "channel":
        raise InputError(
            "body.ros2.evidence: a channel filter cannot take back what an older map said; leave out "
            "explore.fusion, or evidence: map"
        )
    _check_kind(config.body)
    config.body.spec(f"robot-{config.robot}")
    if config.scenario is not None:
        raise InputError("scenario: is for vehicles, not for robots that explore; leave it out")
    if config.links.delay != LinkSettings().delay:
        raise InputError("links.delay: is for vehicles, which reckon with it; leave it out")
    if config.faults is not None and config.begins is None:
        raise InputError("begins: missing; faults need the time at which the mission begins")


def _check_frames(body: BodySettings, options: ExploreOptions) -> None:
    try:
        options.check()
    except InputError as error:
        raise InputError(f"explore: {error}") from error
    if options.frames == "unknown" and body.ros2 is not None and body.ros2.start != Ros2Settings().start:
        raise InputError("body.ros2.start: lies in a frame that nobody has, by explore.frames; leave it out")
    if body.frame is not None and (options.frames == "known" or body.map is None):
        why = "robots that share a frame" if options.frames == "known" else "a real robot"
        raise InputError(f"body.frame: is not for {why}; leave it out")


def _check_kind(body: BodySettings) -> None:
    """Refuse what is not one of the three: a world to be simulated in, ROS 2, a class of one's own."""
    given = [name for name in ("ros2", "own", "map") if getattr(body, name) is not None]
    if len(given) > 1:
        what = "is the world of a simulated robot" if given[1] == "map" else "is a robot of another kind"
        raise InputError(f"body.{given[1]}: {what}; leave it, or body.{given[0]}, out")
    if not given:
        raise InputError(
            "body.map: missing; name the world that the robot is simulated in, or give body.ros2 or body.own "
            "of a real one"
        )
    if body.map is not None and body.start is None:
        raise InputError("body.start: missing; give x, y and heading [m, m, deg]")


def _check_ground(body: BodySettings, options: ExploreOptions) -> None:
    try:
        if body.map is None:
            options.lattice(body.resolution or RESOLUTION)
        elif options.area is not None:
            Area.of(options.area)
    except InputError as error:
        raise InputError(f"explore.{error}") from error
    if options.unbounded and body.map is None:
        raise InputError("explore.unbounded: no real robot is told how far its ground goes; leave it out")


def _check_flight(config: AgentConfig) -> None:
    mission, options = config.mission, config.flies
    assert options is not None
    if mission == "track":  # the optimum is nobody's to work out
        _check_word("track.coordination", options.coordination, track_options.COORDINATIONS[:-1])
    elif mission == "search":
        _check_word("search.coordination", options.coordination, COORDINATIONS)
    _check_scheme(mission, options.scheme)
    _check_word(f"{mission}.fusion", options.fusion, WAYS if mission == "track" else STEP_FUSIONS)
    if config.begins is None:
        raise InputError(
            "begins: missing; vehicles plan by a common clock: give the time at which the mission begins, "
            "the same for all, such as 2027-01-31T12:00:00Z"
        )
    if config.body.map is not None:
        raise InputError("body.map: vehicles fly over their scenario's area; leave it out")
    for name in ("ros2", "own"):
        if getattr(config.body, name) is not None:
            raise InputError(f"body.{name}: is for robots that explore; vehicles are simulated: leave it out")
    for name in ("resolution", "frame", *OF_BODY):
        if getattr(config.body, name) != getattr(BodySettings(), name):
            raise InputError(f"body.{name}: the scenario says how each vehicle is; leave it out")
    if config.best is not None:
        raise InputError("best: the scenario says how each vehicle is; leave it out")


def _check_scheme(mission: str, scheme: str | None) -> None:
    if scheme is not None:
        _check_word(f"{mission}.scheme", scheme, SCHEMES)


def _check_word(where: str, word: str, words: Sequence[str]) -> None:
    if word not in words:
        what = where.rpartition(".")[2]
        raise InputError(f"{where}: unknown {what} {word!r}; {nearest_name(word, words)}")
