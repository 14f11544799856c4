"""Claims that are repeated and never fulfilled lose weight; those that come true, or planned anew, do not."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.agent.promises import LEAST, NOTHING, PAUSE, Promises
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
        overdue = sum(now >= first + 2.0 * (time - first) for first, time in kept.values())
        assert promises.note(cells, due, never, now) == (overdue >= LEAST)
        if overdue >= LEAST:
            lost.append(now)
            kept = {}
    assert 3 <= len(lost) < 60


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
