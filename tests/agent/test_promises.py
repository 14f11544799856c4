"""Claims that are repeated and never fulfilled lose weight; those that come true, or planned anew, do not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.support.signing_agents import agent
from vedette.agent import Agent
from vedette.agent.holdups import HoldUps
from vedette.agent.messages import Beacon
from vedette.agent.promises import LEAST, MOST_HELD_UP, NOTHING, PAUSE, SOON, TWICE, Promises
from vedette.domains.mapping.impact import Impact, discounted, promised
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT

MANY = np.arange(2 * LEAST)


def never(cells: np.ndarray) -> np.ndarray:
    return np.ones(len(cells), np.bool_)


def sure(cells: np.ndarray) -> np.ndarray:
    return np.zeros(len(cells), np.bool_)


def rounds(promises: Promises, until: float, cells: np.ndarray = MANY, seen: float = np.inf) -> list[float]:
    """Promise cells in five seconds, each second; return when that lost weight."""
    lost = []
    for now in np.arange(0.0, until).tolist():
        unseen = never if now < seen else sure
        if promises.note(cells, np.full(len(cells), now + 5.0), unseen, now):
            lost.append(now)
    return lost


def test_a_promise_that_is_never_kept_loses_weight_after_twice_its_time() -> None:
    promises = Promises()
    assert rounds(promises, 60.0) == [10.0, 21.0, 32.0, 43.0, 54.0]
    assert promises.halvings == NOTHING
    assert promises.until == 54.0 + PAUSE


def test_a_promise_that_is_kept_in_time_or_is_small_loses_nothing() -> None:
    assert rounds(Promises(), 60.0, seen=9.0) == []
    assert rounds(Promises(), 60.0, MANY[: LEAST - 1]) == []


def test_what_is_promised_at_once_has_the_time_of_some_rounds() -> None:
    promises, times = Promises(), np.arange(0.0, 10.0, 0.5).tolist()
    due = np.full(len(MANY), 0.5)
    assert [now for now in times if promises.note(MANY, now + due, never, now)] == [5.0]


def test_what_is_planned_anew_was_no_promise() -> None:
    promises = Promises()
    for now in np.arange(0.0, 60.0):
        cells = MANY + 1000 * int(now // 8)
        assert not promises.note(cells, np.full(len(cells), now + 5.0), never, now)


@pytest.mark.parametrize("seed", range(8))
def test_each_cell_is_due_by_when_it_was_first_promised_for_as_long_as_it_is_repeated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    promises, kept, lost = Promises(), dict[int, tuple[float, float]](), []
    for now in np.arange(0.0, 60.0, 0.5).tolist():
        cells = np.flatnonzero(rng.random(4 * LEAST) < rng.choice([0.9, 0.99]))
        due = now + rng.uniform(1.0, 8.0, len(cells))
        before, kept = kept, {}
        for cell, time in zip(cells.tolist(), due.tolist(), strict=True):
            first, soonest = before.get(cell, (now, time))
            kept[cell] = first, min(soonest, time)
        overdue = sum(now >= first + max(2.0 * (time - first), 5.0) for first, time in kept.values())
        assert promises.note(cells, due, never, now) == (overdue >= LEAST)
        if overdue >= LEAST:
            lost.append(now)
            kept = {}
    assert 3 <= len(lost) < 60


class Promised:
    """A mission in which every robot promises the same, within some time, and keeps it at last, or never."""

    def __init__(self, within: float, kept: float = np.inf) -> None:
        self.within, self.kept, self.now = within, kept, 0.0

    def promised(self, belief: Any, impact: Any) -> tuple[np.ndarray, np.ndarray]:
        """The same."""
        return MANY, np.full(len(MANY), self.within)

    def unseen(self, belief: Any, cells: np.ndarray) -> np.ndarray:
        """All of it, until it is kept."""
        return never(cells) if self.now < self.kept else sure(cells)

    def discounted(self, impact: Any, halvings: int) -> Any:
        """As it is."""
        return impact


LIAR, WHO, LINK = 0, 3, 2


def tells_of(hearer: Agent, now: float, slowed: float, x: float) -> None:
    """A robot behind a link, whose beacons are passed on, is heard there."""
    hearer.mates.hear(
        Beacon(WHO, 1, int(10 * now), round(100 * x), 0, 0, round(10 * slowed), 20, 50, ()), now, LINK
    )


def found_out(within: float, slowed: Any, x: Any, kept: float = np.inf) -> tuple[list[float], list[float]]:
    """Let a robot promise the same each second; return when it, and its link, lose weight.

    ``slowed(now)``, ``x(now)``: for how long it says to be without progress [s], and where it is [m].
    """
    judge = agent(1, (LIAR, LINK))
    auditor, mission = judge.rounds.scrutiny.auditor, Promised(within, kept)
    assert auditor is not None
    robot, link = list[float](), list[float]()
    for now in np.arange(0.0, 100.0, 0.25).tolist():
        mission.now = now
        tells_of(judge, now, slowed(now), x(now))
        if now == round(now):
            robot += [now] * len(auditor.promises.note(mission, None, {WHO: None}, now))  # type: ignore[arg-type]
            link += [now] * len(judge.rounds.scrutiny.suspicion.note(mission, None, {LINK: None}, now))  # type: ignore[arg-type]
    return robot, link


def on(now: float) -> float:
    """It drives on."""
    return 0.5 * now


@pytest.mark.parametrize(
    ("slowed", "x"),
    [
        pytest.param(lambda now: min(now, 15.0) if now < 15.0 else 0.0, on, id="as it says"),
        pytest.param(lambda now: 0.0, lambda now: on(max(now - 15.0, 0.0)), id="as its place shows"),
    ],
)
@pytest.mark.parametrize("within", [3.0, 5.0])
def test_a_robot_that_is_held_up_for_15_s_has_so_much_longer(slowed: Any, x: Any, within: float) -> None:
    asked = found_out(within, slowed, x)
    for lost in asked:
        assert TWICE * within + 14.5 <= lost[0] <= TWICE * within + 16.0
    after = 15.0 + within
    assert found_out(within, slowed, x, kept=after) == ([], [])
    assert all(found_out(within, lambda now: 0.0, on, kept=after))


@pytest.mark.parametrize("within", [3.0, 5.0, SOON])
def test_who_always_says_to_be_held_up_is_found_out_all_the_same(within: float) -> None:
    for lost in found_out(within, lambda now: now, lambda now: 0.0):
        assert lost[0] == TWICE * within + MOST_HELD_UP
    assert found_out(within, lambda now: 0.0, on)[0][0] == TWICE * within


def test_of_another_link_nobody_is_held_up() -> None:
    holdups = HoldUps()
    for now in np.arange(0.0, 10.25, 0.25).tolist():
        holdups.note(WHO, 1.0, 1.0, 0.0, LINK, now)
        holdups.note(LIAR, on(now), 1.0, 0.0, LIAR, now)
    assert (holdups.of(WHO), holdups.behind(LINK)) == (10.0, 10.0)
    assert (holdups.of(LIAR), holdups.behind(LIAR)) == (0.0, 0.0)


def test_two_that_are_held_up_at_once_behind_a_link_are_so_once() -> None:
    holdups = HoldUps()
    for now in np.arange(0.0, 10.25, 0.25).tolist():
        holdups.note(WHO, 1.0, 1.0, 0.0, LINK, now)
        holdups.note(LINK, 2.0, 1.0, now, LINK, now)
    assert holdups.behind(LINK) == 10.0


def test_what_is_said_of_the_time_before_one_was_heard_counts_for_nothing() -> None:
    holdups = HoldUps()
    holdups.note(WHO, 1.0, 1.0, 2.0**50, LINK, 5.0)
    assert holdups.of(WHO) == 0.0


def test_weight_comes_back_in_quiet_times() -> None:
    promises = Promises()
    assert rounds(promises, 12.0) == [10.0]
    none = MANY[:0]
    for now in np.arange(12.0, 10.0 + PAUSE + 2.0):
        promises.note(none, np.empty(0), never, float(now))
    assert promises.halvings == 0


@pytest.mark.parametrize("halvings", [1, 2, 3])
def test_a_discounted_claim_is_that_much_less_likely(halvings: int) -> None:
    misses = np.array([1, 8, 16, 64, CERTAIN], np.uint8)
    impact = Impact(np.arange(5, dtype=np.uint32) * LAYERS, misses)
    less = discounted(impact, halvings)
    seen = np.where(misses == CERTAIN, 1.0, 1.0 - np.exp(-misses.astype(np.float64) / STEPS_PER_NAT))
    for key, miss in zip(less.keys, less.misses, strict=True):
        wanted = seen[key // LAYERS] / 2**halvings
        assert 1.0 - np.exp(-float(miss) / STEPS_PER_NAT) == pytest.approx(wanted, abs=0.04)


def test_what_an_impact_promises_is_what_is_more_likely_seen_than_not_and_by_when() -> None:
    edges = np.arange(1.0, LAYERS + 1.0)
    keys = np.array([3 * LAYERS + 2, 7 * LAYERS + 1, 7 * LAYERS + 4, 9 * LAYERS], np.uint32)
    cells, after = promised(Impact(keys, np.array([12, 6, 6, 10], np.uint8)), edges)
    assert cells.tolist() == [3, 7]
    assert after.tolist() == [3.0, 5.0]
