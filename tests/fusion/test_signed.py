"""Signed evidence: nobody speaks for another, whoever passes it on; and who is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.support.notaries import certified
from vedette.fusion import ReplicatedEvidence
from vedette.fusion.contributors import MOST_STARTS
from vedette.fusion.link import MOST_STREAMS, Greeting, Payload
from vedette.fusion.particulars import Capabilities, Particulars, encode
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.snapshots import Delta
from vedette.kernels.tiles import TiledGrid

SHAPE, COUNTS = (80, 100), 3
LIMITS = Capabilities(0.1, 8.0, 0.5)


class Clock:
    """A clock that a test sets [s]."""

    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def holder(robot: int, clock: Clock, boot: int = 1) -> SignedEvidence:
    """A robot that sets out in the middle."""
    evidence = SignedEvidence(robot, boot, SHAPE, COUNTS, notary=certified(robot, clock), limits=LIMITS)
    evidence.set_out(40, 50)
    return evidence


def saw(evidence: SignedEvidence, grid: np.ndarray, count: int = 0) -> None:
    counts = np.array((count, 0, 0), np.int64)
    evidence.publish(TiledGrid.of(grid.astype(np.int8)), None, counts)


def exchange(holders: dict[int, SignedEvidence], edges: list[tuple[int, int]], rounds: int = 8) -> None:
    for i, one in holders.items():
        one.set_neighbours([b if a == i else a for a, b in edges if i in (a, b)])
    for k in range(rounds):
        for a, b in [*edges, *(edge[::-1] for edge in edges)]:
            payload = holders[a].outgoing(b, 3.0 * k)
            if payload is not None:
                holders[b].receive(a, payload, 3.0 * k)


def random_grid(rng: np.random.Generator) -> np.ndarray:
    return rng.choice([-20, -1, 0, 1, 20], SHAPE, p=[0.3, 0.1, 0.4, 0.1, 0.1])


def test_signed_evidence_on_a_chain_is_the_sum_of_all_as_without_signatures(clock: Clock) -> None:
    rng = np.random.default_rng(1)
    team = {i: holder(i, clock) for i in range(4)}
    plain = [ReplicatedEvidence(i, 1, SHAPE, COUNTS) for i in range(4)]
    chain = [(0, 1), (1, 2), (2, 3)]
    for count in range(3):
        clock.now += 2.0
        for i in team:
            grid = random_grid(rng)
            saw(team[i], grid, count)
            plain[i].publish(TiledGrid.of(grid.astype(np.int8)), None, np.array((count, 0, 0)))
        exchange(team, chain)
    for link in chain:
        for a, b in (link, link[::-1]):
            plain[a].set_neighbours([b])
            plain[b].set_neighbours([a])
    for k in range(12):
        for a, b in [*chain, *(edge[::-1] for edge in chain[::-1])]:
            plain[a].set_neighbours([*{b} | {c for e in chain if a in e for c in e} - {a}])
            plain[b].set_neighbours([*{a} | {c for e in chain if b in e for c in e} - {b}])
            if (payload := plain[a].outgoing(b, 3.0 * k)) is not None:
                plain[b].receive(a, payload, 3.0 * k)
    for i in team:
        assert np.array_equal(team[i].classes.window(), plain[0].classes.window())
        assert np.array_equal(team[i].counts, plain[0].counts)
        assert team[i].digest == team[0].digest
        assert not team[i].complaints


Change = Callable[[Delta[np.uint8]], Delta[np.uint8]]


def pass_on(
    team: dict[int, SignedEvidence], a: int, b: int, now: float, change: Change | None = None
) -> None:
    """Let one tell another, with all that it passes on of others changed."""
    payload = team[a].outgoing(b, now)
    if payload is None:
        return
    if change is not None:
        told = team[a]._codec.decode(payload)
        sections = [(key, delta if key[0] == a else change(delta)) for key, delta in told.sections]
        payload = team[a]._codec.encode(replace(told, sections=sections))
    team[b].receive(a, payload, now)


def vouched(delta: Delta[np.uint8], **fields: Any) -> Delta[np.uint8]:
    assert delta.voucher is not None
    return replace(delta, voucher=delta.voucher._replace(**fields))


CHANGES: dict[str, Change] = {
    "cells": lambda delta: replace(delta, values=np.where(delta.values == 3, 4, 3).astype(np.uint8)),
    "a cell left out": lambda delta: replace(
        delta,
        mask=delta.mask & (np.cumsum(delta.mask).reshape(delta.mask.shape) > 1),
        values=delta.values[1:],
    ),
    "a tile elsewhere": lambda delta: replace(delta, tiles=np.where(delta.tiles == 7, 6, delta.tiles)),
    "version": lambda delta: replace(delta, version=delta.version + 7),
    "counts": lambda delta: replace(delta, counts=np.array((9, 9, 9))),
    "times": lambda delta: vouched(delta, times=delta.voucher.times - 1),  # type: ignore[union-attr]
    "particulars": lambda delta: vouched(delta, particulars=encode(Particulars(1, 1, 1))),
    "signature": lambda delta: vouched(delta, seal=delta.voucher.seal._replace(signature=bytes(64))),  # type: ignore[union-attr]
    "time": lambda delta: vouched(delta, seal=delta.voucher.seal._replace(time=delta.voucher.seal.time + 1)),  # type: ignore[union-attr]
    "certificate": lambda delta: vouched(delta, certificate=certified(1, Clock()).certificate),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_whoever_changes_what_it_passes_on_is_caught_and_changes_nothing(
    change: Change, clock: Clock
) -> None:
    rng, team = np.random.default_rng(2), {i: holder(i, clock) for i in range(3)}
    grid = random_grid(rng)
    grid[32:64, 64:96] = 0  # one tile that nobody has seen
    for i, links in {0: [1], 1: [0, 2], 2: [1]}.items():
        team[i].set_neighbours(links)
    saw(team[0], grid)
    for k in range(4):
        pass_on(team, 0, 1, float(k))
        pass_on(team, 1, 0, float(k))
        pass_on(team, 2, 1, float(k))
        pass_on(team, 1, 2, float(k), change)
    assert 1 in team[2].standing.forgers
    assert "robot-1" in team[2].complaints[1]
    assert team[2].contributors() == 0
    assert not team[2].classes.window().any()
    assert not team[1].complaints


def test_a_difference_goes_on_from_any_version_that_is_held(clock: Clock) -> None:
    rng, team = np.random.default_rng(3), {i: holder(i, clock) for i in range(3)}
    for k in range(12):
        clock.now += 1.0
        saw(team[0], random_grid(rng), k)
        exchange({i: team[i] for i in (0, 1)}, [(0, 1)], 2)
        if k % 4 == 3:
            exchange(team, [(0, 1), (1, 2)], 4)
            assert team[2].digest == team[0].digest
    assert not any(each.complaints for each in team.values())


def test_a_contributor_that_signs_one_version_twice_harms_nobody_who_passes_it_on(clock: Clock) -> None:
    rng = np.random.default_rng(4)
    team, double = {i: holder(i, clock) for i in range(3)}, holder(0, clock)
    saw(team[0], random_grid(rng))
    exchange({i: team[i] for i in (0, 1)}, [(0, 1)], 4)
    saw(double, random_grid(rng))
    exchange({0: double, 2: team[2]}, [(0, 2)], 4)
    clock.now += 1.0
    saw(team[0], random_grid(rng))
    exchange({i: team[i] for i in (0, 1)}, [(0, 1)], 4)
    exchange({i: team[i] for i in (1, 2)}, [(1, 2)], 8)
    assert team[2].digest == team[1].digest == team[0].digest
    assert not team[2].standing.forgers
    assert not team[1].standing.forgers


def test_a_tile_farther_than_its_maker_can_have_driven_is_refused_by_all_alike(clock: Clock) -> None:
    team = {i: holder(i, clock) for i in range(3)}
    grid = np.zeros((80, 2000), np.int8)
    team = {
        i: SignedEvidence(i, 1, grid.shape, COUNTS, notary=certified(i, clock), limits=LIMITS)
        for i in range(3)
    }
    for each in team.values():
        each.set_out(40, 50)
    grid[40, 50:140] = -20
    clock.now += 10.0
    saw(team[0], grid)
    exchange(team, [(0, 1), (1, 2)])
    assert team[2].digest == team[0].digest
    far = grid.copy()
    far[40, 1500] = -20
    saw(team[0], far)
    exchange(team, [(0, 1), (1, 2)])
    assert "a tile 14" in team[1].complaints[0]
    assert not team[2].classes.window()[40, 1500]
    assert team[1].digest == team[2].digest
    clock.now += 300.0
    grid[40, 140:1500] = -20
    saw(team[0], grid)
    exchange(team, [(0, 1), (1, 2)], 12)
    assert team[2].classes.window()[40, 1400]


@pytest.mark.parametrize("seconds", [1.0, 30.0])
def test_who_says_to_have_visited_two_places_at_once_is_not_heard(seconds: float, clock: Clock) -> None:
    team = {i: holder(i, clock) for i in range(2)}
    grid = np.full(SHAPE, -20, np.int8)
    team[0].tell([(500, 400, 30)])
    saw(team[0], grid)
    exchange(team, [(0, 1)])
    assert team[1].notes() == {0: {(500, 400, 30, 10000)}}
    clock.now += seconds
    team[0].tell([(500, 400, 30), (1500, 400, 30)])
    saw(team[0], grid, 1)
    exchange(team, [(0, 1)])
    assert (len(team[1].notes()[0]) == 2) == (seconds > 10.0)
    assert (0 in team[1].complaints) == (seconds < 10.0)


def test_nothing_counts_that_a_revoked_robot_has_signed_before_or_after(clock: Clock) -> None:
    rng, team = np.random.default_rng(7), {i: holder(i, clock) for i in range(3)}
    grids = [random_grid(rng) for _ in team]
    for i in team:
        saw(team[i], grids[i], 1)
    exchange(team, [(0, 1), (1, 2)])
    before = team[0].contributors()
    for i in (0, 1):
        assert team[i].standing.revoke(frozenset({2}))
        team[i].heed()
    saw(team[2], random_grid(rng), 2)
    exchange(team, [(0, 1), (1, 2)])
    rest = {i: holder(i, clock) for i in range(2)}
    for i in rest:
        saw(rest[i], grids[i], 1)
    exchange(rest, [(0, 1)])
    for i in rest:
        assert np.array_equal(team[i].classes.window(), rest[i].classes.window())
        assert np.array_equal(team[i].counts, rest[i].counts)
        assert set(team[i].complaints) == {2}
        assert not team[i].standing.forgers
        assert team[i].contributors() == before
    assert team[0].digest == team[1].digest != rest[0].digest


def test_a_revoked_robot_is_nobodys_errand_any_more(clock: Clock) -> None:
    team = {i: holder(i, clock) for i in range(3)}
    for i in team:
        saw(team[i], random_grid(np.random.default_rng(i)))
    exchange({i: team[i] for i in (0, 1)}, [(0, 1)])
    team[1].standing.revoke(frozenset({0}))
    team[1].heed()
    exchange({i: team[i] for i in (1, 2)}, [(1, 2)])
    assert team[2].contributors() == 2
    assert not team[2].complaints


def starts_of(liar: int, boots: range, clock: Clock) -> list[SignedEvidence]:
    """Many processes of one robot, each with something to tell."""
    made = [holder(liar, clock, boot) for boot in boots]
    for each in made:
        saw(each, np.full(SHAPE, -20))
    return made


def test_a_robot_of_more_starts_than_there_can_be_is_out_for_all_and_keeps_nobodys_evidence_back(
    clock: Clock,
) -> None:
    """Its neighbour once passed on more of them than others took, who took nothing of that neighbour then."""
    rng = np.random.default_rng(5)
    team = {i: holder(i, clock) for i in range(3)}
    for i in team:
        saw(team[i], random_grid(rng))
    for each in starts_of(3, range(1, 2 * MOST_STARTS + 10), clock):
        each.set_neighbours([0])
        team[0].set_neighbours([1, 3])
        greeting = team[0].outgoing(3, 0.0)
        assert greeting is not None
        each.receive(0, greeting, 0.0)
        payload = each.outgoing(0, 0.0)
        assert payload is not None
        team[0].receive(3, payload, 0.0)
    exchange(team, [(0, 1), (1, 2)])
    assert [evidence.out for evidence in team.values()] == [{3}] * 3
    assert len({evidence.digest for evidence in team.values()}) == 1
    assert all("started" in evidence.complaints[3] for evidence in team.values())
    assert {key for key in team[2]._contributors.known() if key[0] < 3} == {(0, 1), (1, 1), (2, 1)}
    assert len(team[0]._contributors.copies) <= 3 + 2 * MOST_STARTS


def test_versions_that_a_robot_has_signed_keep_nobody_from_who_passes_them_on(clock: Clock) -> None:
    """Who raised its own step by step was known to those that were there, and they to no newcomer."""
    team = {i: holder(i, clock) for i in range(3)}
    for i in team:
        saw(team[i], np.full(SHAPE, -20 if i else 20))
    for k in range(4):
        team[2]._contributors.own.overtake((1 << 62) + k * (1 << 32))
        clock.now += 2.0
        saw(team[2], np.full(SHAPE, -20 + 40 * (k % 2)))
        exchange({i: team[i] for i in (1, 2)}, [(1, 2)], rounds=3)
    exchange({i: team[i] for i in (0, 1)}, [(0, 1)])
    assert team[0]._contributors.known() == team[1]._contributors.known()
    assert team[0].contributors() == 3


def test_no_payload_tells_of_more_versions_than_anybody_can_hold(clock: Clock) -> None:
    evidence = holder(0, clock)
    evidence.set_neighbours([1])
    have = {(1, boot): 1 for boot in range(MOST_STREAMS + 1)}
    with pytest.raises(ValueError, match="out of range"):
        evidence.receive(1, evidence._codec.encode(Payload(1, Greeting(-1, True), have)), 0.0)
