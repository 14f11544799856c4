"""Evidence of steps that robots sign: nobody speaks for another, whoever passes it on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from tests.support.notaries import certified
from vedette.fusion import link
from vedette.fusion.contradictions import Histories
from vedette.fusion.contributors import MOST_STARTS
from vedette.fusion.proofs import check_histories
from vedette.fusion.steps import ReplicatedSteps, SignedSteps, Sparse, SparseIntegers, sealed
from vedette.fusion.steps.sealed import SealedEntries
from vedette.fusion.steps.wire import pack

ELEMENTS = SparseIntegers(20)
Team = dict[int, SignedSteps[Sparse]]


def element(value: int, at: int = 3) -> Sparse:
    return ELEMENTS.of(np.array([at]), np.array([value]))


def robot(number: int, boot: int = 1) -> SignedSteps[Sparse]:
    return SignedSteps(number, boot, ELEMENTS, notary=certified(number, lambda: 100.0))


def chain(robots: int) -> Team:
    """Robots in a row."""
    team = {i: robot(i) for i in range(robots)}
    for i, each in team.items():
        each.set_neighbours([k for k in (i - 1, i + 1) if k in team])
    return team


Change = Callable[[SealedEntries], SealedEntries]


def pass_on(team: Team, a: int, b: int, now: float, change: Change | None = None) -> None:
    """Let one tell another, with all that it passes on of others changed."""
    payload = team[a].outgoing(b, now)
    if payload is None:
        return
    if change is not None:
        told = team[a]._decode(payload)
        sections = [(key, entries if key[0] == a else change(entries)) for key, entries in told.sections]
        payload = team[a]._encode(replace(told, sections=sections))
    team[b].receive(a, payload, now)


def exchange(team: Team, rounds: int = 6, start: float = 0.0) -> None:
    for k in range(rounds):
        for a in team:
            for b in team:
                if abs(a - b) == 1:
                    pass_on(team, a, b, start + 3.0 * k)


def totals(evidence: SignedSteps[Sparse] | ReplicatedSteps[Sparse], steps: int) -> list[list[int]]:
    return [ELEMENTS.dense(evidence.total(step)).tolist() for step in range(steps)]


def test_signed_steps_on_a_chain_are_the_sums_that_there_are_without_signatures() -> None:
    team, alone = chain(4), ReplicatedSteps(9, 1, ELEMENTS)
    for step in range(5):
        for i, each in team.items():
            each.publish(step, element(10 * step + i + 1, i))
            alone.publish(step, element(10 * step + i + 1, i))
        exchange(team, 2, 10.0 * step)
    exchange(team, start=100.0)
    assert all(totals(each, 5) == totals(alone, 5) for each in team.values())
    assert len({each.digest for each in team.values()}) == 1
    assert not any(each.complaints for each in team.values())


OTHER = pack(0, ELEMENTS.encode(element(77)))
CHANGES: dict[str, Change] = {
    "an entry": lambda told: told._replace(data=OTHER),
    "one entry more": lambda told: told._replace(data=told.data + OTHER, version=told.version + 1),
    "signature": lambda told: told._replace(seal=told.seal._replace(signature=bytes(64))),
    "time": lambda told: told._replace(seal=told.seal._replace(time=told.seal.time + 1)),
    "certificate": lambda told: told.certified(certified(1, lambda: 0.0).certificate),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_whoever_changes_what_it_passes_on_is_caught_and_changes_nothing(change: Change) -> None:
    team = chain(3)
    team[0].publish(0, element(5))
    for k in range(4):
        pass_on(team, 0, 1, float(k))
        pass_on(team, 1, 0, float(k))
        pass_on(team, 2, 1, float(k))
        pass_on(team, 1, 2, float(k), change)
    assert team[2].standing.forgers == {1}
    assert "robot-1" in team[2].complaints[1]
    assert team[2].contributors() == 0
    assert ELEMENTS.is_zero(team[2].total(0))
    assert not team[1].complaints


def test_who_signs_two_histories_is_named_and_who_passes_one_on_is_not() -> None:
    team, double = chain(3), robot(0)
    team[0].publish(0, element(5))
    exchange({i: team[i] for i in (0, 1)})
    double.publish(0, element(6))
    double.set_neighbours([2])
    team[2].set_neighbours([0, 1])
    for k in range(4):
        for a, b in ((0, 2), (2, 0)):
            pass_on({0: double, 2: team[2]}, a, b, float(k))
    team[0].publish(1, element(7))
    exchange({i: team[i] for i in (0, 1)}, start=20.0)
    exchange({i: team[i] for i in (1, 2)}, start=40.0)
    assert not team[1].standing.forgers
    assert not team[2].standing.forgers
    ((liar, proof),) = team[2].standing.found
    assert liar == 0
    assert isinstance(proof, Histories)
    check_histories(proof, team[1].standing.notary, 0)
    for no_proof in (
        structs.replace(proof, late=proof.early),
        structs.replace(proof, entries=proof.entries + OTHER),
        structs.replace(proof, early=structs.replace(proof.early, signature=bytes(64))),
    ):
        with pytest.raises(ValueError, match=r"proof|prove|truncated|signature"):
            check_histories(no_proof, team[1].standing.notary, 0)


def test_a_revoked_robots_evidence_leaves_the_totals_of_all_who_know_and_digests_agree() -> None:
    team, without = chain(3), chain(2)
    for step in range(3):
        for i, each in team.items():
            each.publish(step, element(step + 1, i))
        for i, each in without.items():
            each.publish(step, element(step + 1, i))
    exchange(team)
    exchange(without)
    for i in (0, 1):
        team[i].standing.revoke(frozenset({2}))
        team[i].heed()
    team[2].publish(0, element(50))
    exchange(team, start=50.0)
    for i in (0, 1):
        assert totals(team[i], 3) == totals(without[i], 3)
        assert team[i].take_changed() == 0
        assert not team[i].standing.forgers
    assert team[0].digest == team[1].digest != without[0].digest


def test_who_joins_late_gets_all_in_pieces_that_end_where_their_writer_has_signed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for module in (sealed, link):
        monkeypatch.setattr(module, "MOST_BYTES", 100)
    team = chain(3)
    pair = {i: team[i] for i in (0, 1)}
    for step in range(30):
        team[0].publish(step, element(step + 1))
        exchange(pair, 1, 3.0 * step)
    exchange({i: team[i] for i in (1, 2)}, 40, 200.0)
    assert totals(team[2], 30) == totals(team[0], 30)
    assert not team[2].complaints


def test_a_robot_that_starts_anew_gets_its_own_earlier_evidence_back() -> None:
    team = chain(2)
    team[0].publish(0, element(5))
    exchange(team)
    again = robot(0, boot=2)
    again.set_neighbours([1])
    exchange({0: again, 1: team[1]}, start=50.0)
    assert ELEMENTS.dense(again.total(0))[3] == 5
    again.publish(1, element(6))
    exchange({0: again, 1: team[1]}, start=100.0)
    assert totals(team[1], 2) == totals(again, 2)
    assert team[1].contributors() == 2


def test_nothing_counts_of_a_robot_of_more_starts_than_there_can_be() -> None:
    team = chain(3)
    team[0].publish(0, element(5))
    for boot in range(1, MOST_STARTS + 3):
        liar = robot(3, boot)
        liar.set_neighbours([2])
        team[2].set_neighbours([1, 3])
        liar.publish(0, element(100, 4))
        pass_on({2: team[2], 3: liar}, 2, 3, 0.0)
        pass_on({2: team[2], 3: liar}, 3, 2, 0.0)
    exchange(team)
    assert [each.out for each in team.values()] == [{3}] * 3
    assert all(ELEMENTS.dense(each.total(0))[3:5].tolist() == [5, 0] for each in team.values())
    assert len({each.digest for each in team.values()}) == 1
    assert all("started" in each.complaints[3] for each in team.values())
