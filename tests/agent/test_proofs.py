"""Proofs of lies travel, and convict nobody who is honest."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from tests.support.signing_agents import agent, hears, notary
from vedette.agent import messages
from vedette.agent.account import Claimed, account_of, contradicts, words_of
from vedette.agent.effects import Effect, Send
from vedette.agent.events import Pose
from vedette.agent.messages import Proof
from vedette.agent.proofs import AGAIN
from vedette.fusion import contradictions
from vedette.fusion.contradictions import Accounted, Histories, SignedWord, Twice
from vedette.fusion.seals import BEACON, EVIDENCE, STEPS

LIAR = 0
AT = Pose(1.0, 1.0, 0.0)


def word(*what: int | bytes | str, robot: int = LIAR) -> SignedWord:
    return SignedWord(what, notary(robot).sign(*what))


def seal(version: int, root: bytes, robot: int = LIAR) -> SignedWord:
    return word(EVIDENCE, robot, 1, version, 100, root, robot=robot)


TWICE = Twice(seal(3, b"a" * 16), seal(3, b"b" * 16))


def proof(of: Twice = TWICE, robot: int = LIAR) -> Proof:
    return Proof(robot, notary(robot).certificate, contradictions.encode(of))


def proofs_in(effects: Iterable[Effect]) -> dict[int, Proof]:
    """Return what is said to prove something, by whom it is said to."""
    sends = [effect for effect in effects if isinstance(effect, Send)]
    said = [(send.to, messages.decode(send.payload)) for send in sends]
    return {to: message for to, message in said if isinstance(message, Proof)}


# -- what is proof -----------------------------------------------------------------------------------------


NO_PROOFS = {
    "one word twice": Twice(seal(3, b"a" * 16), seal(3, b"a" * 16)),
    "two versions": Twice(seal(3, b"a" * 16), seal(4, b"b" * 16)),
    "another's word": Twice(seal(3, b"a" * 16), seal(3, b"b" * 16, robot=1)),
    "a word that is not signed": Twice(
        seal(3, b"a" * 16), structs.replace(seal(3, b"b" * 16), signature=bytes(64))
    ),
    "another's signature": Twice(
        seal(3, b"a" * 16), SignedWord(seal(3, b"b" * 16).what, notary(1).sign(*seal(3, b"b" * 16).what))
    ),
    "a kind that there is not": Twice(word("x", LIAR, 1, 3, 1), word("x", LIAR, 1, 3, 2)),
    "no kind": Twice(word(7, LIAR), word(7, LIAR, 1)),
    "a seal and a beacon": Twice(seal(3, b"a" * 16), word(BEACON, b"")),
    "a beacon that is a number": Twice(word(BEACON, 5), word(BEACON, 6)),
    "a version that is text": Twice(word(EVIDENCE, LIAR, 1, "x", 1), word(EVIDENCE, LIAR, 1, "y", 1)),
    "words cut short": Twice(word(EVIDENCE, LIAR), word(EVIDENCE, LIAR, 1)),
}


@pytest.mark.parametrize("no_proof", NO_PROOFS.values(), ids=NO_PROOFS)
def test_what_is_no_proof_convicts_nobody_but_who_says_so_is_named(no_proof: Twice) -> None:
    hearer = agent(2, (1, 3))
    assert proofs_in(hears(hearer, 1, proof(no_proof))) == {}
    assert hearer.dropped_of == {1: 1}
    assert hearer.signed is not None
    assert hearer.signed.out == frozenset()
    assert "no proof" in hearer.complaints[1]
    assert LIAR not in hearer.complaints


@pytest.mark.parametrize("odd", [[1], {}, None, 1.5, True])
def test_words_of_other_kinds_are_refused(odd: Any) -> None:
    """Signed or not: whoever lies could sign them."""
    hearer, words = agent(2, (1, 3)), structs.replace(TWICE.first, what=(STEPS, LIAR, 1, odd, 100, b""))
    histories = Histories(words, words, b"")
    hears(hearer, 1, Proof(LIAR, notary(LIAR).certificate, contradictions.encode(histories)))
    hears(hearer, 1, proof(Twice(words, structs.replace(words, what=(odd, LIAR)))))
    assert hearer.dropped == 2
    assert hearer.signed is not None
    assert hearer.signed.out == frozenset()


def test_nobody_is_convicted_in_anothers_name() -> None:
    hearer = agent(2, (1, 3))
    hears(hearer, 1, structs.replace(proof(), robot=3, certificate=notary(3).certificate))
    hears(hearer, 1, structs.replace(proof(), certificate=notary(3).certificate))
    assert hearer.dropped == 2
    assert hearer.signed is not None
    assert hearer.signed.out == frozenset()


# -- how it travels ----------------------------------------------------------------------------------------


def test_a_proof_goes_on_once_and_whom_it_convicts_is_out_for_all() -> None:
    near, far = agent(1, (0, 2)), agent(2, (1, 3))
    assert near.proofs is not None
    assert near.signed is not None
    near.signed.standing.notary.admit(LIAR, notary(LIAR).certificate)
    near.signed.standing.catch(LIAR, TWICE)
    told = proofs_in(near.proofs.tick((0, 2), 1.0))
    assert set(told) == {0, 2}
    assert set(proofs_in(hears(far, 1, told[2]))) == {3}
    assert hears(far, 3, told[2]) == []
    for each in (near, far):
        assert each.signed is not None
        assert each.signed.out == {LIAR}
        assert LIAR in each.rounds.distrusted
        assert "two different things" in each.complaints[LIAR]
    assert near.mission.fusion.digest == far.mission.fusion.digest != agent(3, ()).mission.fusion.digest


def test_who_comes_late_gets_the_proofs_that_it_lacks() -> None:
    knows, late = agent(1, (2,)), agent(2, (1,))
    hears(knows, 2, proof())
    assert knows.proofs is not None
    assert late.proofs is not None
    (hint,) = [e for e in knows.proofs.tick((2,), 5.0) if isinstance(e, Send)]
    assert knows.proofs.tick((2,), 6.0) == []
    (asked,) = hears(late, 1, messages.decode(hint.payload))
    assert isinstance(asked, Send)
    answers = hears(knows, 2, messages.decode(asked.payload))
    hears(late, 1, proofs_in(answers)[2])
    assert late.signed is not None
    assert late.signed.out == {LIAR}
    assert len(knows.proofs.tick((2,), 5.0 + AGAIN)) == 1


def test_of_each_name_one_proof_is_kept() -> None:
    hearer = agent(2, (1, 3))
    hears(hearer, 1, proof())
    other = Twice(seal(9, b"a" * 16), seal(9, b"b" * 16))
    assert proofs_in(hears(hearer, 3, proof(other))) == {}
    assert hearer.dropped == 0


# -- accounts ----------------------------------------------------------------------------------------------


def cells(odd: float, even: float) -> np.ndarray:
    return np.tile((odd, even), 6)


def claimed(told: tuple[float, float]) -> Claimed:
    own, left, right, sent = (cells(*two) for two in ([0.5, 1.0], [1.0, 0.25], [0.5, 0.5], told))
    return Claimed((1, 2), None, own, {3: left, 4: right}, {3: sent}, {})


def test_an_account_answers_for_the_sums_that_its_robot_has_told_and_no_others() -> None:
    mission = agent(1, ()).mission
    honest = account_of(claimed((0.25, 0.5)), mission, 1, 1)
    assert [k for k, _ in honest.told] == [3]
    assert not contradicts(honest, mission)
    stale = account_of(claimed((0.5, 0.5)), mission, 1, 1)
    assert stale.told == ()
    assert not contradicts(stale, mission)
    lie = structs.replace(honest, told=((3, b"x" * 16),))
    assert contradicts(lie, mission)
    other = structs.replace(honest, impact=mission.codec.encode(cells(0.1, 0.1)))
    assert contradicts(other, mission)


def test_an_account_that_contradicts_itself_is_proof_if_it_is_signed() -> None:
    hearer = agent(2, (1, 3))
    account = account_of(claimed((0.25, 0.5)), hearer.mission, LIAR, 1)
    for told, out in ((account.told, set()), (((3, b"x" * 16),), {LIAR})):
        says = structs.replace(account, told=told)
        signed = structs.replace(says, signature=notary(LIAR).sign(*words_of(says)))
        for each in (says, signed):
            data = contradictions.encode(Accounted(messages.encode(each)))
            hears(hearer, 1, Proof(LIAR, notary(LIAR).certificate, data))
        assert hearer.signed is not None
        assert hearer.signed.out == out
