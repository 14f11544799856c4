"""What a fault schedule must keep to: its robots exist, and what it says can happen."""

from __future__ import annotations

from vedette.errors import InputError
from vedette.sim.faults.kinds import (
    Crash,
    Cut,
    Delay,
    Fault,
    FreezeFault,
    OneWay,
    Partition,
    Restart,
    Schedule,
    Skew,
)


def check_faults(schedule: Schedule, robots: int, where: str) -> None:
    """Refuse a schedule that a team of so many ``robots`` cannot go through.

    Raises:
        InputError: there is no such robot, or what is to happen cannot; the line begins with ``where`` and
            names the fault by its place in the list from 0.
    """
    crashed: set[int] = set()
    frozen: dict[int, float] = {}  # until [s]
    for place, fault in schedule.in_time():
        wrong = (
            _strangers(fault, robots) or _wrong_links(fault, robots) or _wrong_life(fault, crashed, frozen)
        )
        if wrong:
            raise InputError(f"{where}: faults[{place}]{wrong}")


def _strangers(fault: Fault, robots: int) -> str | None:
    named: dict[str, tuple[int, ...]] = {}
    match fault:
        case OneWay(sender=sender, to=to):
            named = {"from": (sender,), "to": (to,)}
        case Cut(robots=pair):
            named = {"robots": pair}
        case Partition(parts=parts):
            named = {f"parts[{k}]": part for k, part in enumerate(parts)}
        case Crash(robot=robot) | Restart(robot=robot) | FreezeFault(robot=robot) | Skew(robot=robot):
            named = {"robot": (robot,)}
    for field, numbers in named.items():
        for number in numbers:
            if number > robots:
                return f".{field}: there is no robot {number} in a team of {robots}"
    return None


def _wrong_links(fault: Fault, robots: int) -> str | None:
    match fault:
        case Delay(between=(shortest, longest)) if shortest > longest:
            return f".between: shortest and longest delay in this order; it is [{shortest:g}, {longest:g}]"
        case OneWay(sender=sender, to=to) if sender == to:
            return f".to: must be another robot than from; both are {to}"
        case Cut(robots=(a, b)) if a == b:
            return f".robots: must be two robots; both are {a}"
        case Partition(parts=parts):
            return _wrong_parts(parts, robots)
    return None


def _wrong_parts(parts: tuple[tuple[int, ...], ...], robots: int) -> str | None:
    seen: set[int] = set()
    for k, part in enumerate(parts):
        for robot in part:
            if robot in seen:
                return f".parts[{k}]: robot {robot} is named twice; a robot is in one part"
            seen.add(robot)
    if sum(map(bool, parts)) + (len(seen) < robots) < 2:
        return ".parts: the whole team is in one part; name robots of two parts"
    return None


def _wrong_life(fault: Fault, crashed: set[int], frozen: dict[int, float]) -> str | None:
    """Follow who is up; tell what cannot happen to whom."""
    match fault:
        case Crash(robot=robot):
            if robot in crashed:
                return f".robot: robot {robot} has crashed already by {fault.at:g} s; restart it first"
            crashed.add(robot)
            frozen.pop(robot, None)
        case Restart(robot=robot):
            if robot not in crashed:
                return (
                    f".robot: robot {robot} is up at {fault.at:g} s; only a robot that has crashed restarts"
                )
            crashed.remove(robot)
        case FreezeFault(robot=robot):
            if robot in crashed:
                return f".robot: robot {robot} has crashed by {fault.at:g} s; only one that is up freezes"
            if fault.at < frozen.get(robot, 0.0):
                return f".robot: robot {robot} is frozen until {frozen[robot]:g} s; freeze it after that"
            frozen[robot] = fault.at + fault.lasts
        case Skew(s=s) if s != 0.0 and fault.at > 0.0:
            return f".s: a running clock does not jump; give s at 0 s, or ppm alone (at is {fault.at:g} s)"
    return None
