"""A moment of a mission as the page draws it: what is told of robots in words and numbers, and the map."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import NoGo, Order, Priority
from vedette.maps import OCCUPIED, UNKNOWN, GridFrame
from vedette.record import palette
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.told import progress
from vedette.record.links import Link

SHADES = 8  # of what is about to be seen, in the place of UNKNOWN: cells of the page's map from 3 on
MOST_LEFT = 100  # frontiers that robots leave, of which each is shown
TILE = 32  # cells a side, in which changes of the map travel
MOST_PATH = 40  # points of a path that are drawn
WHY = {"unseeable": "looked at in vain", "unreached": "not got to", "out_of_reach": "no way there"}


@dataclass(frozen=True)
class Beside:
    """What is told beside a snapshot, where there is somebody to tell it."""

    numbers: Sequence[int] = ()  # of the robots, from 1; none: 1, 2, ...
    silent: Mapping[int, float] = field(default_factory=dict)  # by robot's number: for how long [s]
    links: Sequence[Link] = ()  # between robots, by their places among those that are shown
    orders: Sequence[tuple[str, Sequence[str]]] = ()  # in force, and who holds each
    areas: Sequence[Mapping[str, Any]] = ()  # that are ordered: kind, name and corners
    alerts: Sequence[str] = ()
    counts: Mapping[int, tuple[int, int]] = field(default_factory=dict)  # by number: rounds, and bytes sent


NOTHING = Beside()


def ordered(
    held: Iterable[tuple[str, Iterable[Order]]],
) -> tuple[list[tuple[str, list[str]]], list[Mapping[str, Any]]]:
    """Return the orders in force with who holds each, and the areas among them, by what robots hold."""
    holders, areas = dict[str, list[str]](), dict[str, Mapping[str, Any]]()
    for name, orders in held:
        for order in orders:
            holders.setdefault(said(order), []).append(name)
            if isinstance(order, NoGo | Priority):
                kind = "no-go" if isinstance(order, NoGo) else "priority"
                areas[order.area] = {"kind": kind, "name": order.area, "corners": order.corners}
    return list(holders.items()), list(areas.values())


def said(order: Order) -> str:
    """Return an order in words, without the corners of an area."""
    told = {name: value for name, value in msgspec.to_builtins(order).items() if name != "corners"}
    kind = told.pop("order")
    return " ".join([kind, *(f"{name} {value}" for name, value in told.items())])


@dataclass(frozen=True, eq=False)
class Picture:
    """What the page shows of one moment."""

    t: float  # [s]
    text: bytes  # JSON: all but the map
    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C), never changed afterwards


class Mark(NamedTuple):
    """An ellipse about what is known of a target."""

    x: float  # [m], team frame
    y: float
    width: float  # [m]
    height: float
    angle: float  # of its width [deg]
    name: str


def picture(scene: ExploreScene, snapshot: ExploreSnapshot, beside: Beside = NOTHING) -> Picture:
    """Return a moment of an exploration."""
    figures = list(progress(snapshot))
    if snapshot.coverage is not None:
        figures.insert(0, ("covered", f"{100 * snapshot.coverage:.1f} %"))
    if snapshot.frontiers is not None and snapshot.coverage is not None:
        figures.append(("frontiers", str(snapshot.frontiers)))
    figures.append(("rounds", str(max(robot.rounds for robot in snapshot.robots))))
    figures.append(("sent", size(sum(robot.sent for robot in snapshot.robots))))
    left = [
        (round(spot.x, 2), round(spot.y, 2), f"{WHY[spot.why]}, says {spot.by}")
        for spot in snapshot.left_out[-MOST_LEFT:]
    ]
    orders, areas = ordered((robot.name, robot.orders) for robot in snapshot.robots)
    share = snapshot.known_fraction if snapshot.coverage is None else snapshot.coverage
    return drawn(
        snapshot.t,
        scene.frame,
        shaded(scene, snapshot),
        snapshot.robots,
        figures,
        share=share,
        links=snapshot.links or (),
        left=left,
        beside=replace(beside, orders=orders, areas=areas, counts={}),
    )


def size(count: int) -> str:
    """Return so many bytes, for people."""
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def drawn(
    t: float,
    frame: GridFrame,
    ground: NDArray[np.uint8],
    robots: Sequence[RobotSample],
    figures: Sequence[tuple[str, str]],
    *,
    share: float | None = None,
    links: Sequence[Link] = (),
    left: Sequence[tuple[float, float, str]] = (),
    marks: Sequence[Mark] = (),
    beside: Beside = NOTHING,
) -> Picture:
    """Return a moment [s] of any mission.

    Args:
        t: [s].
        frame: of the ground.
        ground: ``(R, C)`` UNKNOWN, FREE, OCCUPIED, or a shade from 3 on.
        robots: with their names.
        figures: names and values, for the page's head.
        share: of what there is to do that is done, 0..1; None: nobody knows.
        links: between robots.
        left: x, y [m] and why nobody goes there.
        marks: of targets.
        beside: what is told beside.
    """
    numbers = beside.numbers or range(1, len(robots) + 1)
    robots, figures = _counted(numbers, robots, beside.counts), [*figures, *_totals(beside.counts)]
    told = {
        "t": round(t, 2),
        "robots": [
            _robot(number, robot.name, robot, beside.silent.get(number))
            for number, robot in zip(numbers, robots, strict=True)
        ],
        "figures": figures,
        "share": share,
        "links": [(link.a, link.b, link.on_tree, round(link.loss, 2)) for link in links or beside.links],
        "orders": beside.orders,
        "areas": beside.areas,
        "alerts": [*_lost(robots), *beside.alerts],
        "left": left,
        "marks": marks,
    }
    text = msgspec.json.encode(told, enc_hook=lambda number: number.item())  # NumPy's
    return Picture(t, text, frame, ground)


def _counted(
    numbers: Sequence[int], robots: Sequence[RobotSample], counts: Mapping[int, tuple[int, int]]
) -> list[RobotSample]:
    """Return robots with their rounds and what they have sent, of those of whom it is told beside."""
    return [
        replace(robot, rounds=counts[number][0], sent=counts[number][1]) if number in counts else robot
        for number, robot in zip(numbers, robots, strict=True)
    ]


def _totals(counts: Mapping[int, tuple[int, int]]) -> list[tuple[str, str]]:
    if not counts:
        return []
    rounds, sent = zip(*counts.values(), strict=True)
    return [("rounds", str(max(rounds))), ("sent", size(sum(sent)))]


def shaded(scene: ExploreScene, snapshot: ExploreSnapshot) -> NDArray[np.uint8]:
    """Return ``(R, C)`` the map, with a shade from 3 on where it is unknown and about to be seen."""
    classes = snapshot.classes.copy()
    if snapshot.impact is None or not snapshot.impact.any():
        return classes
    factor = round(scene.planning.resolution / scene.frame.resolution)
    shade = np.ceil(np.clip(snapshot.impact, 0.0, 1.0) * SHADES - 0.5).astype(np.uint8)
    fine = shade.repeat(factor, axis=0).repeat(factor, axis=1)[: classes.shape[0], : classes.shape[1]]
    seen = (classes == UNKNOWN) & (fine > 0)
    classes[seen] = OCCUPIED + fine[seen]
    return classes


def _robot(number: int, name: str, robot: RobotSample, silent: float | None) -> dict[str, Any]:
    path = np.asarray(robot.path, np.float64)[:MOST_PATH].round(2).tolist()
    return {
        "id": number,
        "name": name,
        "x": round(robot.x, 3),
        "y": round(robot.y, 3),
        "heading": round(robot.heading, 3),
        "state": robot.state,
        "alive": robot.alive,
        "silent": None if silent is None else round(silent, 1),
        "path": path,
        "driven": round(robot.driven, 1),
        "way_left": None if robot.way_left is None else round(robot.way_left),
        "rounds": robot.rounds,
        "sent": size(robot.sent) if robot.sent else "",
        "trust": robot.trust,
        "tour": [[round(number, 2) for number in stop] for stop in robot.tour],
        "colour": palette.robot_colour(number - 1),
    }


def _lost(robots: Sequence[RobotSample]) -> list[str]:
    """Return what an operator should look at."""
    return [f"{robot.name}: {robot.fate or robot.state}" for robot in robots if _is_bad(robot)]


def _is_bad(robot: RobotSample) -> bool:
    return robot.fate == "lost" or robot.state == "stuck"


def changes(
    frame: GridFrame, classes: NDArray[np.uint8], shown: NDArray[np.uint8] | None
) -> tuple[bool, bytes]:
    """Return what a page that shows one map needs to show another, and whether that is all of it.

    The bytes are, for each tile of 32 x 32 cells that differs, its row and column of tiles as little-endian
    16 bits, then its cells row by row; beyond the map's edge they are 0.
    """
    whole = shown is None or shown.shape != classes.shape
    rows, cols = -(-frame.rows // TILE), -(-frame.cols // TILE)
    tiles = _tiles(classes, rows, cols)
    differs = tiles != (0 if whole or shown is None else _tiles(shown, rows, cols))
    row, col = np.nonzero(differs.any(axis=(1, 3)))
    heads = np.column_stack((row, col)).astype("<u2").view(np.uint8)
    body = tiles.transpose(0, 2, 1, 3)[row, col].reshape(len(row), TILE * TILE)
    return whole, np.hstack((heads, body)).tobytes()


def _tiles(classes: NDArray[np.uint8], rows: int, cols: int) -> NDArray[np.uint8]:
    """Return ``(rows, 32, cols, 32)``."""
    high, wide = rows * TILE, cols * TILE
    if classes.shape != (high, wide):
        padded = np.zeros((high, wide), np.uint8)
        padded[: classes.shape[0], : classes.shape[1]] = classes
        classes = padded
    return classes.reshape(rows, TILE, cols, TILE)
