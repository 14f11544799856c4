"""Hosts whose cables are worse than any office's: the team finishes with one map, or says who holds another.

Slow, and only where network namespaces can be made: as root, with ``ip``, ``tc`` and ``nft``. Each prints a
line of the table in ``docs/how-to/faults.md``.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from threading import Event, Thread, Timer

import pytest

from tests.support.net_hosts import Cable, HostedTeam, Hosts, missing
from tests.support.net_processes import Diary, Fault, Mission, plan_of, run
from tests.support.small_missions import small_maze
from vedette.maps.world import World
from vedette.outcome import Outcome

pytestmark = pytest.mark.slow

FLAPS = 3.0  # up, and as long down [s]
CUT = 20.0  # [s]

_missing = cache(missing)


def chain(count: int) -> list[Cable]:
    """Each host has a cable to the next."""
    return list(pairwise(range(count)))


@contextmanager
def hosts_of(count: int, cables: list[Cable]) -> Iterator[Hosts]:
    """So many hosts with these cables."""
    if (lacking := _missing()) is not None:
        pytest.skip(lacking)
    with Hosts(count, cables) as hosts:
        yield hosts


def mission_of(
    hosts: Hosts, world: World, logs: Path, speed: float, faults: list[Fault] | None = None
) -> Mission:
    """A mission with a robot on each host."""
    plan = plan_of(world, hosts.count, speed)
    return run(plan, logs, faults or [], partial(HostedTeam, hosts=hosts), max_time=1800.0)


def check_told(what: str, mission: Mission) -> None:
    """It is complete if all are heard and hold one map, which is right; else it is said who holds which."""
    summary, diary = mission.report.summary, mission.diary
    trees = len({told.said.number for reports in diary.by_robot.values() for told in reports})
    rounds = [diary.last(i).rounds for i in sorted(diary.by_robot)]
    took = mission.report.timing.round_ms
    print(
        f"\n{what}: {summary.outcome} after {summary.time_s:.0f} s, {100 * summary.coverage:.1f} %, "
        f"{summary.map_errors} wrong cells, {len(summary.maps)} maps, apart for {summary.apart_s:.0f} s, "
        f"{trees} trees, rounds {rounds}, {'-' if took is None else round(took.p95)} ms p95, "
        f"{sum(sent.overlay for sent in summary.bytes.values()) / 1e3:.0f} kB of overlay of "
        f"{sum(sum(vars(sent).values()) for sent in summary.bytes.values()) / 1e3:.0f}"
    )
    assert summary.map_errors == 0
    agreed = len(summary.maps) == 1 and not summary.lost
    assert agreed == (summary.outcome is Outcome.COMPLETE)
    assert sorted(name for names in summary.maps for name in names) == sorted(summary.path_m)


@pytest.mark.parametrize("percent", [30, 40])
def test_a_chain_that_loses_a_third_and_more_is_complete_with_one_map_or_says_who_differs(
    percent: int, tmp_path: Path
) -> None:
    with hosts_of(4, chain(4)) as hosts:
        hosts.lose(percent)
        check_told(f"{percent} % loss on a chain of four", mission_of(hosts, small_maze(), tmp_path, 2.0))


@contextmanager
def flapping(hosts: Hosts, cable: Cable) -> Iterator[None]:
    """A cable that is up for a while, and down for as long."""
    over = Event()

    def flap() -> None:
        percent = 0
        while not over.wait(FLAPS):
            percent = 100 - percent
            hosts.lose(percent, [cable])

    thread = Thread(target=flap)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        hosts.lose(0, [cable])


@pytest.mark.parametrize("cables", [chain(4), [*chain(4), (3, 0)]], ids=["chain", "ring"])
def test_a_link_that_flaps_is_left_alone_or_used_and_the_team_finishes(
    cables: list[Cable], tmp_path: Path
) -> None:
    with hosts_of(4, cables) as hosts, flapping(hosts, (1, 2)):
        mission = mission_of(hosts, small_maze(), tmp_path, 2.0)
        check_told(f"a link of {len(cables)} that flaps every {FLAPS:.0f} s", mission)
        assert mission.report.summary.coverage >= 0.99


@pytest.mark.parametrize(("kbit", "count"), [(250, 5), (250, 8), (64, 5), (64, 8)])
def test_teams_on_links_of_an_old_modem_finish(kbit: int, count: int, tmp_path: Path) -> None:
    with hosts_of(count, chain(count)) as hosts:
        hosts.limit(kbit)
        mission = mission_of(hosts, small_maze(), tmp_path, 1.0)
        check_told(f"{kbit} kbit/s, a chain of {count}", mission)
        assert mission.report.summary.outcome is Outcome.COMPLETE


def test_a_partition_in_one_direction_is_as_good_as_one_in_both(tmp_path: Path) -> None:
    with hosts_of(4, chain(4)) as hosts:

        def strike(diary: Diary) -> None:
            hosts.deafen(1, 2)
            Timer(CUT, hosts.deafen, (1, 2, 0)).start()

        mission = mission_of(hosts, small_maze(), tmp_path, 2.0, [Fault(0.2, "one way", strike)])
        check_told(f"one way cut for {CUT:.0f} s in a chain of four", mission)
        assert mission.report.summary.outcome is Outcome.COMPLETE
