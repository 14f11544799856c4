"""Orders that an operator gives in the course of a simulated mission, from a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from vedette.agent.orders import Exclude, LookThere, NoGo, Order, Priority, Recall, Reinstate, Remove
from vedette.errors import InputError, nearest_name
from vedette.maps.area import Area
from vedette.maps.world import World, standable
from vedette.missions.sense import Grounds, forbidden_by
from vedette.scenario import as_scenario, load_scenario
from vedette.team import PlatformSpec

Instant = Annotated[float, Meta(ge=0.0, le=86400.0)]  # since the start [s]


class OrderAt(Struct, frozen=True):
    """An order, and when it is given."""

    at: Instant
    what: Order


class _OrderFile(Struct, forbid_unknown_fields=True, frozen=True):
    orders: tuple[dict[str, Any], ...]


def load_orders(path: Path | str) -> tuple[OrderAt, ...]:
    """Read a file of orders, each with its time, in order of time.

    Raises:
        InputError: as :func:`vedette.scenario.load_scenario`.
    """
    told = load_scenario(path, _OrderFile, "file of orders").orders
    return tuple(sorted((_order(each, f"{path}: orders[{i}]") for i, each in enumerate(told)), key=_time))


def check_frames(orders: Sequence[OrderAt], frames: str, robots: int) -> None:
    """Raise InputError for an order that names a robot's frame where all share one, or one of no robot."""
    for each in orders:
        frame = getattr(each.what, "frame", None)
        if frame is not None and frames == "known":
            raise InputError("orders: frame: the robots share one frame; leave it out")
        if frame is not None and frame > robots:
            raise InputError(f"orders: frame: there is no robot {frame} in a team of {robots}")


def check_orders(
    orders: Sequence[OrderAt],
    world: World,
    specs: Sequence[PlatformSpec],
    where: str,
    known: Sequence[NoGo | Priority] = (),
    signed: bool = False,
) -> None:
    """Refuse orders that make no sense to this team in this world.

    ``known``: areas that there are already; ``signed``: robots sign what they say.

    Raises:
        InputError: there is no such robot, or no such area yet; an area, or a place, lies outside or in a
            wall or a no-go area; or it is about whom to believe, where nobody signs what it says.
    """
    areas: dict[str, NoGo | Priority] = {each.area: each for each in known}
    for each in orders:
        order, at = each.what, f"{where}: {each.what.subject} at {each.at:g} s"
        if order.robot_number > len(specs):
            raise InputError(f"{at}: there is no robot {order.robot_number} in a team of {len(specs)}")
        match order:
            case NoGo() | Priority():
                _check_area(order.corners, world, at)
                areas[order.area] = order
            case Remove() if order.area not in areas:
                raise InputError(f"{at}: there is no such area by then; {nearest_name(order.area, areas)}")
            case Remove():
                del areas[order.area]
            case Recall(to=(x, y)) | LookThere(at=(x, y)):
                robots = specs if order.robot is None else [specs[order.robot - 1]]
                _check_place(x, y, world, max(spec.radius for spec in robots), at)
                if (objection := forbidden_by(x, y, areas.values())) is not None:
                    raise InputError(f"{at}: {objection}")
            case Exclude() | Reinstate() if not signed:
                raise InputError(f"{at}: simulated robots sign nothing, and all are believed; leave it out")


def check_flight_orders(
    orders: Sequence[OrderAt], grounds: Grounds, where: str, known: Sequence[NoGo | Priority] = ()
) -> None:
    """Refuse orders that make no sense to a team of vehicles; ``known``: areas that there are already.

    Raises:
        InputError: there is no such robot, or no such area yet, or what `Grounds.objection` says.
    """
    areas: dict[str, NoGo | Priority] = {each.area: each for each in known}
    for each in orders:
        order, at = each.what, f"{where}: {each.what.subject} at {each.at:g} s"
        no_go = [area for area in areas.values() if isinstance(area, NoGo)]
        if (objection := grounds.objection(order, no_go)) is not None:
            raise InputError(f"{at}: {objection}")
        match order:
            case NoGo() | Priority():
                areas[order.area] = order
            case Remove() if order.area not in areas:
                raise InputError(f"{at}: there is no such area by then; {nearest_name(order.area, areas)}")
            case Remove():
                del areas[order.area]


def _time(each: OrderAt) -> float:
    return each.at


def _order(told: dict[str, Any], where: str) -> OrderAt:
    what = {name: value for name, value in told.items() if name != "at"}
    if what.get("order") == "look" and "to" in what:  # for in a file `at` is when
        what["at"] = what.pop("to")
    at = {"at": told["at"]} if "at" in told else {}
    try:
        return as_scenario({**at, "what": what}, OrderAt, where)
    except InputError as error:
        raise InputError(str(error).replace(": what.", ": ", 1).replace(": what:", ":", 1)) from None


def _check_area(corners: Sequence[tuple[float, float]], world: World, at: str) -> None:
    try:
        area = Area.of(corners)
    except InputError as error:
        raise InputError(f"{at}: {error}") from None
    if not area.holds(world.frame).any():
        x_min, x_max, y_min, y_max = world.frame.extent
        raise InputError(
            f"{at}: the area lies outside: x is {x_min:g} to {x_max:g} m, y is {y_min:g} to {y_max:g} m"
        )


def _check_place(x: float, y: float, world: World, radius: float, at: str) -> None:
    x_min, x_max, y_min, y_max = world.frame.extent
    if not (x_min <= x < x_max and y_min <= y < y_max):
        raise InputError(
            f"{at}: {x:g},{y:g} lies outside; x is {x_min:g} to {x_max:g} m, y is {y_min:g} to {y_max:g} m"
        )
    if not standable(world, radius).flat[world.frame.flat(x, y)]:
        raise InputError(f"{at}: no robot can stand at {x:g},{y:g}: there is a wall")
