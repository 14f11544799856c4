"""A host a robot, with cables that lose and break: the team finishes with one map.

Slow, and only where network namespaces can be made: as root, with ``ip`` and ``nft``.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from threading import Timer

import pytest

from tests.support.net_hosts import Cable, HostedTeam, Hosts, missing
from tests.support.net_processes import Diary, Fault, Mission, plan_of, run
from tests.support.net_team import real_time
from tests.support.small_missions import small_maze
from vedette.outcome import Outcome

pytestmark = [pytest.mark.slow, real_time]

CHAIN: list[Cable] = [(0, 1), (1, 2), (2, 3)]
RING: list[Cable] = [*CHAIN, (3, 0)]
SPEED, LEASE = 2.0, 3.0


@cache
def _missing() -> str | None:
    return missing()


@contextmanager
def hosts_of(cables: list[Cable]) -> Iterator[Hosts]:
    """Hosts 0..3, joined as told."""
    if (lacking := _missing()) is not None:
        pytest.skip(lacking)
    with Hosts(4, cables) as hosts:
        yield hosts


def mission_of(hosts: Hosts, logs: Path, faults: list[Fault]) -> Mission:
    """A mission in a maze, a robot on each host."""
    return run(plan_of(small_maze(), 4, SPEED, LEASE), logs, faults, partial(HostedTeam, hosts=hosts))


def check_finished(what: str, mission: Mission) -> None:
    """All four have the whole map, and the same one."""
    summary, diary = mission.report.summary, mission.diary
    trees = len({told.said.number for reports in diary.by_robot.values() for told in reports})
    print(
        f"\n{what}: {summary.outcome} after {summary.time_s:.0f} s, apart for {summary.apart_s:.0f} s, "
        f"{trees} trees, {sum(sent.overlay for sent in summary.bytes.values()) / 1e3:.0f} kB of overlay"
    )
    assert summary.outcome is Outcome.COMPLETE, summary
    assert summary.coverage >= 0.995
    assert summary.map_errors == 0
    assert mission.survivors == [0, 1, 2, 3]
    assert diary.agree(mission.survivors)
    assert {tuple(link.robot for link in diary.last(i).links) for i in range(4)}


@pytest.mark.parametrize("cables", [CHAIN, RING], ids=["chain", "ring"])
@pytest.mark.parametrize("percent", [0, 20], ids=["no loss", "20 % loss"])
def test_a_team_on_hosts_in_a_row_finishes(cables: list[Cable], percent: int, tmp_path: Path) -> None:
    with hosts_of(cables) as hosts:
        hosts.lose(percent)
        mission = mission_of(hosts, tmp_path, [])
        check_finished(f"{len(cables)} cables, {percent} % loss", mission)
        for i in range(4):  # neighbours hear each other, nobody passes anything on
            heard = {link.robot for link in mission.diary.last(i).links}
            assert heard == {a + b - i for a, b in cables if i in (a, b)}


@pytest.mark.parametrize(
    ("cables", "cut"), [(CHAIN, [(1, 2)]), (RING, [(1, 2)]), (RING, [(1, 2), (3, 0)])],
    ids=["chain in two", "ring opened", "ring in two"],
)  # fmt: skip
def test_a_team_that_is_cut_without_a_word_goes_on_and_comes_together_again(
    cables: list[Cable], cut: list[Cable], tmp_path: Path
) -> None:
    with hosts_of(cables) as hosts:

        def strike(diary: Diary) -> None:
            hosts.lose(100, cut)
            Timer(8.0, hosts.lose, (0, cut)).start()

        mission = mission_of(hosts, tmp_path, [Fault(0.3, "cut", strike)])
        cost = mission.recovery
        print(f"\ncut: noticed after {cost.noticed:.2f} s, planned anew after {cost.replanned:.2f} s")
        check_finished(f"{len(cables)} cables, {len(cut)} cut for 8 s", mission)
        on_tree = mission.diary.last(0).size
        assert on_tree == 4
