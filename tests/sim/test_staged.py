"""Faults staged on a real network do to datagrams what the schedule says."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.sim.faults import Schedule, StagedLinks, Timeline
from vedette.sim.faults.kinds import Delay, Duplicate, Heal, Loss, OneWay, Partition


def staged(*faults: object, robot: int = 0) -> StagedLinks:
    """One robot's links of three, under a schedule."""
    schedule = Schedule(tuple(faults))  # type: ignore[arg-type]
    return StagedLinks(Timeline(schedule, 3), robot, np.random.default_rng(0))


def sent(links: StagedLinks, times: np.ndarray, to: int = 1, until: float = 1e9) -> list[tuple[int, bytes]]:
    """What is sent of a datagram put at each time."""
    out = []
    for time in times.tolist():
        links.put(to, f"{time:.3f}".encode(), time)
        out += list(links.take(time))
    return out + list(links.take(until))


def test_without_a_fault_at_work_everything_is_sent_at_once_and_in_order() -> None:
    times = np.arange(0.0, 9.0, 0.01)
    assert [payload for _, payload in sent(staged(Loss(at=10.0, share=1.0)), times)] == [
        f"{time:.3f}".encode() for time in times.tolist()
    ]


def test_a_share_is_lost_while_a_loss_lasts_and_none_afterwards() -> None:
    times = np.arange(0.0, 30.0, 0.01)
    kept = np.array([float(p) for _, p in sent(staged(Loss(at=10.0, lasts=10.0, share=0.3)), times)])
    during = ((kept >= 10.0) & (kept < 20.0)).sum()
    assert (kept < 10.0).sum() == (kept >= 20.0).sum() == 1000
    assert 0.64 * 1000 <= during <= 0.76 * 1000  # four deviations of a binomial


@pytest.mark.parametrize(("fault", "robot", "cut"), [
    (Partition(at=1.0, parts=((1, 2), (3,))), 0, {2}),
    (OneWay(at=1.0, sender=1, to=2), 0, {1}),
    (OneWay(at=1.0, sender=1, to=2), 1, set()),
])  # fmt: skip
def test_what_is_cut_gets_nothing_until_it_heals(fault: object, robot: int, cut: set[int]) -> None:
    links = staged(fault, Heal(at=5.0), robot=robot)
    for peer in {0, 1, 2} - {robot}:
        assert bool(sent(links, np.array([2.0]), peer, 2.0)) == (peer not in cut)
    for peer in {0, 1, 2} - {robot}:
        assert sent(links, np.array([6.0]), peer, 6.0)


def test_delays_and_repeats_send_later_and_twice_and_nothing_else() -> None:
    links = staged(Delay(at=0.0, between=(0.1, 0.3)), Duplicate(at=0.0, share=1.0))
    links.put(1, b"word", 1.0)
    assert list(links.take(1.0999)) == []
    assert list(links.take(1.3001)) == [(1, b"word")] * 2
