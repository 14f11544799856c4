"""What an exploring robot tells the operator: its map, what it has seen itself, what it has given up."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Annotated, NamedTuple, cast

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette import wire
from vedette.agent import Agent, GroundBehaviour
from vedette.domains.mapping.impact import MapImpactCodec
from vedette.domains.mapping.leftovers import Leftover, Why
from vedette.fusion.frame_edges import MOST_AWAY
from vedette.maps import OCCUPIED, GridFrame
from vedette.maps.bounds import Extent
from vedette.maps.transform import TURN, Transform
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.net.gather import figures_of, path_of
from vedette.net.report import FARTHEST, MOST_BYTES, Condition, Count, Real, Word, inflated
from vedette.net.witness import Known
from vedette.outcome import Outcome
from vedette.record.explore.log import Ahead, RobotSample
from vedette.record.explore.views import GroundFigures, RobotView, held, left_out

MOST_CELLS = 1 << 26
UNTOUCHED = GroundFigures().min_clearance_m  # [m]
Cells = Annotated[int, Meta(ge=0, le=MOST_CELLS)]
Grid = Annotated[bytes, Meta(max_length=MOST_BYTES)]
Millimetres = Annotated[int, Meta(ge=-MOST_AWAY, le=MOST_AWAY)]


class Spot(NamedTuple):
    """A frontier that the robot leaves, as ``vedette.domains.mapping.leftovers.Leftover``."""

    x: Real  # [m], team frame
    y: Real
    unknown: Count  # cells near it
    why: Why


class StopAhead(NamedTuple):
    """A stop of its tour, as ``vedette.record.explore.log.Ahead``."""

    x: Real  # [m], team frame
    y: Real
    after: Real  # [s]
    reveals: Real  # [m^2]


class PlacedTold(NamedTuple):
    """Where a contributor's frame lies, as ``vedette.missions.explore.frames.graph.Placed``."""

    robot: Count
    boot: Count
    anchor: tuple[Count, Count]  # robot and boot of the one whose frame is that of all that are joined
    x: Millimetres
    y: Millimetres
    angle: Annotated[int, Meta(ge=0, lt=TURN)]
    met: bool = False

    @property
    def there(self) -> Transform:
        """T_anchor_contributor."""
        return Transform(self.x, self.y, self.angle)


class FramesTold(msgspec.Struct, frozen=True, array_like=True):
    """What a robot that shares no frame has found out about others'."""

    graph: Annotated[tuple[PlacedTold, ...], Meta(max_length=1024)] = ()  # in order
    refused: Annotated[dict[Word, Count], Meta(max_length=64)] = {}  # pairs of maps not believed, by why


NOTHING_FOUND = FramesTold()


class MapContent(msgspec.Struct, frozen=True, array_like=True, tag=5):
    """A robot's map: the part of the team's lattice outside of which it knows nothing."""

    row: Cells  # of the lattice, where the part begins
    col: Cells
    rows: Cells
    cols: Cells
    classes: Grid  # deflated
    seen: Grid  # bits of what its own sensor observed, deflated
    impact: Grid | None  # of its last decision
    resolution: Annotated[float, Meta(gt=0.0, le=FARTHEST)]  # [m]
    x: Real  # of the part's corner [m], team frame
    y: Real
    lattice: tuple[Cells, Cells]  # rows and columns of all of it
    left_out: Annotated[tuple[Spot, ...], Meta(max_length=1024)] = ()
    tour: Annotated[tuple[StopAhead, ...], Meta(max_length=64)] = ()
    way_left: Real | None = None  # that its energy is good for [m]; None: nobody says
    found: FramesTold = NOTHING_FOUND


_CONTENTS: msgspec.msgpack.Decoder[MapContent] = msgspec.msgpack.Decoder(MapContent)
_encode = msgspec.msgpack.Encoder().encode


@dataclass(frozen=True, eq=False)
class ExploreTeller:
    """Tells what an agent has found out; ``vedette.net.witness.Teller``."""

    agent: Agent

    @property
    def _mission(self) -> Exploring:
        return cast(Exploring, self.agent.mission)

    @property
    def known(self) -> Known:
        """How much of the team's ground it knows."""
        mission, lattice, extent = self._mission, self._mission.lattice, self._mission.known
        classes, _ = held(mission.fusion.classes, mission.own.log_odds, extent)
        if lattice.area is not None:
            classes *= lattice.area.holds(lattice.frame.window(*extent))
        cells = np.count_nonzero(classes)
        share = None if lattice.cells is None else float(cells / lattice.cells)
        area = float(cells) * lattice.frame.resolution**2
        return Known(share, area, mission.frontiers, mission.own.beyond, lattice.room)

    def path(self, now: float) -> NDArray[np.float64]:
        """Return the way that the robot wants to go."""
        wanted = cast(GroundBehaviour, self.agent.behaviour).driver.wanted
        return np.empty((0, 2)) if wanted is None else wanted.path

    def content(self, now: float) -> bytes:
        """Return its map."""
        mission, decided = self._mission, self.agent.rounds.impact
        shown = MapImpactCodec(mission.planning.size)
        impact = None if decided is None else shown.encode(mission.on_map(decided))
        spots = tuple(Spot(each.x, each.y, each.unknown, each.why) for each in mission.left_out)
        grids = held(mission.fusion.classes, mission.own.log_odds, mission.known)
        tour = tuple(StopAhead(*stop) for stop in mission.ahead(now))
        budget = mission.platform.budget
        left = budget.left if budget.limited else None
        found = NOTHING_FOUND if not isinstance(mission, FramedExploring) else _found(mission)
        if found.graph:
            impact = None  # it is over the rounds' plane, where nobody's map lies
        return content(mission.frame, mission.known, *grids, impact, spots[-1024:], tour, left, found)


def content(
    lattice: GridFrame,
    known: Extent,
    classes: NDArray[np.uint8],
    seen: NDArray[np.bool_],
    impact: bytes | None,
    left: tuple[Spot, ...] = (),
    tour: tuple[StopAhead, ...] = (),
    way_left: float | None = None,
    found: FramesTold = NOTHING_FOUND,
) -> bytes:
    """Return a map as bytes; ``classes`` and ``seen`` are ``(R, C)``, the known rows and columns."""
    (rows, cols), part = known, lattice.window(*known)
    packed = zlib.compress(np.ascontiguousarray(classes).tobytes(), 1)
    bits = zlib.compress(np.packbits(seen).tobytes(), 1)
    corner, place = (rows.start, cols.start), (part.resolution, part.origin_x, part.origin_y)
    size = part.rows, part.cols
    return _encode(
        MapContent(*corner, *size, packed, bits, impact, *place, lattice.shape, left, tour, way_left, found)
    )


def _found(mission: FramedExploring) -> FramesTold:
    graph = sorted(mission.frames.graph.items())[:1024]
    placed = tuple(PlacedTold(*key, each.anchor, *each.there, each.met) for key, each in graph)
    return FramesTold(placed, dict(mission.refused))


def read_content(payload: bytes) -> MapContent:
    """Return a robot's map; its grids are still packed.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_CONTENTS, payload, "report")


def view_of(
    condition: Condition, payload: bytes, frame: GridFrame, codec: MapImpactCodec, name: str
) -> RobotView:
    """Return what a robot of this name reports, over a lattice with this frame.

    Raises:
        ValueError: malformed, or of another lattice.
    """
    told = read_content(payload)
    end = told.row + told.rows, told.col + told.cols
    if end[0] > frame.rows or end[1] > frame.cols:
        raise ValueError(
            f"report of a map up to cell {end}, beyond the {frame.rows} x {frame.cols} there are"
        )
    return RobotView(
        sample=sample_of(condition, told, name),
        frame=frame.window(slice(told.row, end[0]), slice(told.col, end[1])),
        classes=classes_of(told),
        seen=seen_of(told),
        impact=None if told.impact is None else codec.decode(told.impact),
        figures=GroundFigures(
            **vars(figures_of(condition)),
            collisions=condition.collisions,
            min_clearance_m=UNTOUCHED if condition.min_clearance is None else condition.min_clearance,
            pose_error_m=condition.pose_error,
        ),
        digest=condition.digest,
        left_out=left_out([Leftover(*spot) for spot in told.left_out], name),
        frontiers=condition.frontiers,
        beyond=condition.beyond,
        turned_back=condition.ending == Outcome.SPENT.value,
    )


def sample_of(condition: Condition, told: MapContent, name: str) -> RobotSample:
    """Return a robot of this name as it tells of itself."""
    path = path_of(condition)
    return RobotSample(
        *(condition.x, condition.y, condition.heading, condition.state, True, path, name),
        goal=(float(path[-1, 0]), float(path[-1, 1])) if len(path) else None,
        driven=condition.travelled,
        tour=tuple(Ahead(*stop) for stop in told.tour),
        way_left=told.way_left,
        rounds=condition.rounds,
        sent=sum(condition.bytes.values()),
        orders=tuple(each.order for each in condition.orders),
    )


def frame_of(told: MapContent) -> GridFrame:
    """Return where the map lies that was told."""
    return GridFrame(told.resolution, told.rows, told.cols, told.x, told.y)


def classes_of(told: MapContent) -> NDArray[np.uint8]:
    """Return ``(R, C)``: the map that was told.

    Raises:
        ValueError: not a map of that size.
    """
    classes = np.frombuffer(inflated(told.classes, _cells(told)), np.uint8)
    if classes.max(initial=0) > OCCUPIED:
        raise ValueError("report: a cell is neither unknown, free nor occupied")
    return classes.reshape(told.rows, told.cols)


def seen_of(told: MapContent) -> NDArray[np.bool_]:
    """Return ``(R, C)``: which cells the robot's own sensor has observed.

    Raises:
        ValueError: not of that size.
    """
    cells = _cells(told)
    bits = np.frombuffer(inflated(told.seen, -(-cells // 8)), np.uint8)
    return np.unpackbits(bits, count=cells).astype(np.bool_).reshape(told.rows, told.cols)


def _cells(told: MapContent) -> int:
    cells = told.rows * told.cols
    if cells > MOST_CELLS:
        raise ValueError(f"report: a map of {cells} cells; at most {MOST_CELLS} are taken")
    return cells
