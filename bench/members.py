"""Teams of real processes with one member that misbehaves: do the others finish, in time, and name it?

Each is held against the same team with that member dead from the start. One line of results a mission.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bench.journal import append, read
from bench.table import figure, markdown
from tests.support.bad_member import MODES
from tests.support.lies import LIES
from tests.support.net_processes import Doubled, Mission, misbehaving, plan_of, run
from vedette.errors import InputError, check_word
from vedette.maps import UNKNOWN
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.launch import TeamProcesses
from vedette.record.explore.score import Reference, coverage, map_errors
from vedette.sim.worlds import office

DEAD, DOUBLE, SLOW = "dead", "double", "slow"
SLOW_BY = "slow=0.7"  # for every job [s]
ALL = (*MODES, *LIES, DOUBLE)
SIZES = (3, 5)
KNOWN, LATE, WRONG, NAMED = 0.99, 1.5, 0.005, 30.0  # asked: share, ratio, share, [s]
MOST = 900.0  # a mission may last [s]


@dataclass(frozen=True)
class MemberResult:
    """How the others fared; one line of the results file."""

    mode: str
    robots: int
    time_s: float  # mission time at which all others were done; MOST where they were not
    known: float  # of what can be seen, by the one of them that knows least
    wrong: float  # share of the cells that they know
    named_s: float | None  # real time after which one of them named it; None: nobody did
    rounds: int  # that the one of them with the fewest has decided
    load: float
    commit: str

    @property
    def key(self) -> tuple[str, int]:
        """What tells it from all others."""
        return self.mode, self.robots

    @property
    def outcome(self) -> str:
        """Whether the others were done."""
        return "done" if self.time_s < MOST else "not done"


def measure(mode: str, robots: int, world: World, speed: float, commit: str) -> MemberResult:
    """Run one team; its last robot, which becomes the root, misbehaves."""
    others = list(range(robots - 1))
    with TemporaryDirectory(prefix="vedette-bench-") as logs:
        plan = plan_of(world, robots, speed)
        if mode in LIES and LIES[mode].unbounded:
            plan = replace(plan, options=ExploreOptions(unbounded=True))
        mission = run(plan, Path(logs), team=_team(mode, robots), max_time=MOST, enough=others)
    diary = mission.diary
    named = diary.named_at(others, robots - 1)
    known, wrong = _map_of(mission, others, world)
    return MemberResult(
        mode,
        robots,
        min(max(diary.done_at(i) for i in others), MOST),
        known,
        wrong,
        named if isfinite(named) else None,
        min(diary.last(i).rounds for i in others),
        round(os.getloadavg()[0], 1),
        commit,
    )


def _team(mode: str, robots: int) -> type[TeamProcesses]:
    if mode == DOUBLE:
        return Doubled
    return misbehaving(SLOW_BY if mode == SLOW else mode, robots - 1)


def _map_of(mission: Mission, others: Sequence[int], world: World) -> tuple[float, float]:
    """Return which share of what can be seen the others know, and which share of that is wrong."""
    plan = mission.diary.plan
    reference = Reference(world, plan.specs, plan.starts)
    maps = [mission.views[i].classes_on(world.frame) for i in others]
    looked = np.logical_or.reduce([mission.views[i].seen_on(world.frame) for i in others])
    wrong = max(map_errors(world, np.where(looked, classes, UNKNOWN))[0] for classes in maps)
    return min(coverage(reference, classes) for classes in maps), wrong / max(int(looked.sum()), 1)


def modes_of(text: str) -> tuple[str, ...]:
    """Return the modes that an option names, with commas between; ``all``: each there is.

    Raises:
        InputError: there is no such mode.
    """
    modes = ALL if text == "all" else tuple(text.split(","))
    for mode in modes:
        check_word("mode", mode, ALL)
    return modes


def sizes_of(text: str) -> tuple[int, ...]:
    """Return the sizes of teams that an option names, with commas between.

    Raises:
        InputError: one is no number of robots from 3 on.
    """
    sizes = [int(each) if each.isdecimal() else 0 for each in text.split(",")]
    if min(sizes) < 3:
        raise InputError(f"--robots must be numbers from 3 on, such as 3,5; got {text!r}")
    return tuple(sizes)


def results(
    path: Path, modes: Collection[str], sizes: Collection[int], speed: float, commit: str
) -> Iterator[MemberResult]:
    """Run what the file of results does not have yet, the teams with a dead member first; yield all."""
    world = office(np.random.default_rng(0), 12.0, 10.0)
    done = read(path, MemberResult)
    for robots in sizes:
        for mode in (DEAD, *modes):
            if (mode, robots) not in done:
                done[mode, robots] = measure(mode, robots, world, speed, commit)
                append(path, done[mode, robots])
            yield done[mode, robots]


def table(path: Path) -> str:
    """Return all that the file of results has against what is asked, MET or MISSED."""
    found = sorted(read(path, MemberResult).values(), key=lambda each: (each.robots, each.mode != DEAD))
    dead = {each.robots: each.time_s for each in found if each.mode == DEAD}
    rows = [_row(each, dead.get(each.robots, inf)) for each in found]
    header = ["mode", "robots", "done", "of dead", "known", "wrong", "named", "rounds", "load", "verdict"]
    return markdown(header, rows, "lrrrrrrrrl")


def _row(each: MemberResult, dead: float) -> list[str]:
    ratio = each.time_s / dead
    named = inf if each.named_s is None else each.named_s
    misses = {
        "known": each.known < KNOWN,
        "late": ratio > LATE or each.time_s >= MOST,
        "wrong": each.wrong > WRONG,
        "not named": named > NAMED and each.mode != DEAD,
    }
    missed = [what for what, is_so in misses.items() if is_so]
    return [
        each.mode,
        str(each.robots),
        f"{each.time_s:.0f} s",
        f"{ratio:.2f}",
        f"{100 * each.known:.1f} %",
        f"{100 * each.wrong:.2f} %",
        f"{figure(named)} s" if isfinite(named) else "-",
        str(each.rounds),
        f"{each.load:.0f}",
        f"MISSED: {', '.join(missed)}" if missed else "MET",
    ]
