"""When audits are held, what they find out, and that nobody honest is caught."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from msgspec import structs

from tests.support.agent_team import Float, ToyMission
from tests.support.priced import PRICED
from tests.support.signing_agents import agent, hears, notary
from vedette.agent import Agent, messages
from vedette.agent.account import Claimed, account_of, contradicts, print_of, words_of
from vedette.agent.audit import EVERY, WAITS
from vedette.agent.effects import Send
from vedette.agent.messages import MOST_ANSWERED, Account, Audit, Proof
from vedette.agent.promises import LEAST
from vedette.agent.scrutiny import IDLE_ROUNDS
from vedette.problem import Coverage

WORTH = np.arange(1.0, 13.0)
STAMP = (1, 7)


def misses(*seen: int) -> Float:
    """An impact that is sure to see some points, and no others."""
    impact = np.ones(12)
    impact[list(seen)] = 0.0
    return impact


NOTHING, ALL, SOME = misses(), misses(*range(12)), misses(3, 4)


def robot(number: int, neighbours: tuple[int, ...]) -> Agent:
    """One that can stay or see some points."""
    made = agent(number, neighbours)
    mission: Any = made.mission
    mission.candidates, mission.strategy = [NOTHING, SOME], 0
    made.rounds.scrutiny.anybody_moves = lambda: False
    return made


# -- when ----------------------------------------------------------------------------------------------------


def stands_about(made: Agent, claims: dict[int, Float], own: Float = NOTHING) -> list[bool]:
    return [made.rounds.scrutiny._stands_about(WORTH, own, claims) for _ in range(IDLE_ROUNDS + 1)]


def test_an_audit_is_called_for_where_nobody_goes_though_a_robot_would_without_one_link() -> None:
    waiting = [False] * (IDLE_ROUNDS - 1)
    assert stands_about(robot(1, (0, 2)), {0: NOTHING, 2: ALL}) == [*waiting, True, True]


@pytest.mark.parametrize(
    ("claims", "goes", "moves"),
    [
        pytest.param({0: NOTHING, 2: NOTHING}, False, False, id="nobody keeps it from going"),
        pytest.param({0: ALL, 2: ALL}, False, False, id="two say so"),
        pytest.param({0: NOTHING, 2: ALL}, True, False, id="it goes itself"),
        pytest.param({0: NOTHING, 2: ALL}, False, True, id="a mate is on its way"),
        pytest.param({}, False, False, id="it is alone"),
    ],
)
def test_otherwise_none_is_called_for(claims: dict[int, Float], goes: bool, moves: bool) -> None:
    made = robot(1, (0, 2))
    made.rounds.scrutiny.anybody_moves = lambda: moves
    if not claims or claims[2] is NOTHING:
        made.mission.candidates = [NOTHING]  # type: ignore[attr-defined]
    assert not any(stands_about(made, claims, SOME if goes else NOTHING))


def claimed(own: Float = NOTHING, heard: dict[int, Float] | None = None, **told: Float) -> Claimed:
    sums = {int(k[1:]): impact for k, impact in told.items()}
    return Claimed(STAMP, WORTH, own, heard or {}, sums, {})


def said(effects: list[Any]) -> list[Any]:
    """Return the messages that are sent."""
    return [messages.decode(each.payload) for each in effects if isinstance(each, Send)]


def test_audits_are_held_for_a_while_and_not_too_often() -> None:
    made = robot(1, (0,))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    assert auditor.decided(claimed(), (0,), 0.0) == []
    auditor.want(1.0)
    audit, own = said(auditor.decided(claimed(), (0,), 1.0))
    assert audit == Audit(*STAMP)
    assert isinstance(own, Account)
    later = Claimed((1, 8), WORTH, NOTHING, {}, {}, {})
    assert auditor.decided(later, (0,), 1.0 + 0.9 * EVERY) == []
    assert len(auditor.decided(later, (0,), 1.0 + EVERY)) == 2


def test_of_a_round_account_is_given_once_whatever_is_asked() -> None:
    """Who could get two of one round could have an honest robot convicted."""
    made = robot(1, (0, 2))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    auditor.decided(claimed(), (0, 2), 0.0)
    for stamp, own, gives in ((STAMP, NOTHING, True), ((1, 8), NOTHING, True), (STAMP, SOME, False)):
        auditor.decided(Claimed(stamp, WORTH, own, {}, {}, {}), (0, 2), 0.0)
        answers = said(hears(made, 0, Audit(*stamp)))
        assert any(isinstance(each, Account) for each in answers) == gives


# -- what it finds out ---------------------------------------------------------------------------------------


def account(teller: int, made: Agent, what: Claimed, **changes: Any) -> Account:
    """Return a robot's signed account."""
    says = structs.replace(account_of(what, made.mission, teller, 1), **changes)
    return structs.replace(says, signature=notary(teller).sign(*words_of(says)))


def judged(*accounts: Account) -> tuple[Agent, list[Proof]]:
    """Let a robot hold an audit to which others give these accounts; return what it proves."""
    made = robot(1, (0, 2))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    for teller in (0, 2, 3):
        auditor.standing.notary.admit(teller, notary(teller).certificate)
    auditor.want(0.0)
    auditor.decided(claimed(heard={0: NOTHING, 2: ALL}), (0, 2), 0.0)
    for each in accounts:
        hears(made, 0 if each.robot == 0 else 2, each, 0.5)
    auditor.tick(2.0 * WAITS)
    assert made.proofs is not None
    told = said(made.proofs.tick((0, 2), 2.0 * WAITS))
    return made, [each for each in told if isinstance(each, Proof)]


def test_a_false_sum_that_is_signed_as_the_sum_convicts_its_teller_and_nobody_else() -> None:
    made = robot(1, (0, 2))
    honest = account(0, made, claimed(k1=NOTHING))
    adds_up = claimed(heard={3: SOME}, k1=SOME)
    liar = account(2, made, adds_up, told=((1, bytes(16)),))
    judge, proofs = judged(honest, liar)
    assert {proof.robot for proof in proofs} == {2}
    assert judge.signed is not None
    assert judge.signed.out == {2}
    far = robot(0, (1,))
    hears(far, 1, proofs[0])
    assert far.signed is not None
    assert far.signed.out == {2}
    _, none = judged(honest, account(2, made, adds_up))
    assert none == []


def test_who_gives_two_accounts_of_one_round_is_convicted_and_not_who_gives_one_twice() -> None:
    made = robot(1, (0, 2))
    first, second = account(2, made, claimed()), account(2, made, claimed(own=SOME))
    again = structs.replace(first, signature=notary(2).sign(*words_of(first)))
    assert again != first
    assert judged(first, again)[1] == []
    judge, proofs = judged(first, second)
    assert {proof.robot for proof in proofs} == {2}
    assert judge.rounds.distrusted >= {2}


def test_a_robot_with_many_links_answers_for_some_of_its_sums_and_is_understood() -> None:
    made = robot(1, (0,))
    links = range(2, 2 + 3 * MOST_ANSWERED)
    many = Claimed(STAMP, WORTH, SOME, dict.fromkeys(links, NOTHING), dict.fromkeys(links, SOME), {})
    own = account_of(many, made.mission, 1, 1)
    assert len(own.told) == MOST_ANSWERED
    assert not contradicts(own, made.mission)
    assert messages.decode(messages.encode(own)) == own


def test_an_account_in_anothers_name_counts_for_nothing() -> None:
    made = robot(1, (0, 2))
    forged = structs.replace(account(2, made, claimed()), robot=0)
    judge, proofs = judged(forged)
    assert proofs == []
    assert judge.dropped == 1


def test_links_that_make_no_tree_are_followed_once_a_robot_and_catch_nobody() -> None:
    """By one account of a thousand links to itself and to a leaf behind it, a judge added up for minutes."""
    made = robot(1, (0, 2))
    packed = made.mission.codec.encode(NOTHING)
    loops = tuple((k, 0, packed) for k in (2, 3) for _ in range(500))
    combined, combine = list[int](), Coverage.combine

    def counted(self: Coverage, a: Float, b: Float) -> Float:
        combined.append(1)
        return combine(self, a, b)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Coverage, "combine", counted)
        judge, proofs = judged(
            account(0, made, claimed(k1=NOTHING)),
            account(2, made, claimed(k1=SOME), links=loops, told=()),
            account(3, made, claimed(heard={2: NOTHING})),
        )
    assert proofs == []
    assert len(combined) < 20
    assert judge.rounds.distrusted == frozenset()


class Promising(ToyMission):
    """Each point that is likely seen is promised, as so many cells that it is worth a complaint."""

    def promised(self, belief: Any, impact: Float) -> tuple[np.ndarray, np.ndarray]:
        """Return the cells of those points, for at once."""
        cells = (np.flatnonzero(impact < 0.5)[:, None] * LEAST + np.arange(LEAST)).ravel()
        return cells, np.zeros(len(cells))

    def unseen(self, belief: Any, cells: np.ndarray) -> np.ndarray:
        """All are seen in time."""
        return np.zeros(len(cells), np.bool_)

    def discounted(self, impact: Float, halvings: int) -> Float:
        """As it is."""
        return impact


@pytest.mark.parametrize("goes_back", [False, True])
def test_sums_of_a_round_that_ended_by_strategies_of_earlier_catch_nobody(goes_back: bool) -> None:
    """Of jacobi and multistart: the last sums are of strategies that nobody has, though all are honest."""
    made = robot(1, (0,))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    auditor.mission.__class__ = Promising
    auditor.standing.notary.admit(0, notary(0).certificate)
    for sequence in (7, 8):
        now = 10.0 * sequence
        auditor.want(now)
        auditor.decided(Claimed((1, sequence), WORTH, NOTHING, {0: ALL}, {}, {}, goes_back), (0,), now)
        own = Claimed((1, sequence), WORTH, SOME, {1: NOTHING}, {1: ALL}, {})
        hears(made, 0, account(0, made, own), now)
        auditor.tick(now + 2.0 * WAITS)
    assert (auditor.caught.keys() == {0}) != goes_back


def at(price: float, *seen: int) -> Float:
    """The last number in the place of the last point."""
    impact = misses(*seen)
    impact[-1] = price
    return impact


@pytest.mark.parametrize("told", [0.0, 0.25, 0.5])
def test_a_sum_with_another_price_than_what_is_signed_behind_it_names_its_teller(told: float) -> None:
    """It says to see what it signs to see, and for less, or for more."""
    made = robot(1, (0,))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    auditor.mission.__class__ = Promising
    mission: Any = auditor.mission
    mission.objective = PRICED
    auditor.standing.notary.admit(0, notary(0).certificate)
    for sequence in (7, 8):
        now = 10.0 * sequence
        auditor.want(now)
        nothing, heard = at(0.0), {0: at(told, 3, 4)}
        auditor.decided(Claimed((1, sequence), WORTH, nothing, heard, {}, {}), (0,), now)
        own = Claimed((1, sequence), WORTH, at(0.25, 3, 4), {1: nothing}, {1: heard[0]}, {})
        hears(made, 0, account(0, made, own), now)
        auditor.tick(now + 2.0 * WAITS)
    assert (auditor.caught.keys() == {0}) == (told != 0.25)


def test_who_signs_to_have_told_another_price_than_that_of_what_it_adds_up_is_convicted() -> None:
    made = robot(1, (0, 2))
    mission: Any = made.mission
    mission.objective = PRICED
    adds_up = Claimed(STAMP, WORTH, at(0.25, 3, 4), {3: at(0.5, 5)}, {}, {})
    whole, cheap = at(0.75, 3, 4, 5), at(0.5, 3, 4, 5)
    honest, liar = (
        account(2, made, adds_up, told=((1, print_of(mission.codec.encode(each))),))
        for each in (whole, cheap)
    )
    assert not contradicts(honest, mission)
    assert contradicts(liar, mission)


def test_an_account_in_a_robots_own_name_keeps_it_from_giving_none() -> None:
    """Who said it first kept the robot's own from the audit, and so all sums behind it from being checked."""
    made = robot(1, (0, 2))
    auditor = made.rounds.scrutiny.auditor
    assert auditor is not None
    auditor.decided(claimed(), (0, 2), 0.0)
    assert hears(made, 2, structs.replace(account(2, made, claimed(own=SOME)), robot=1)) == []
    answers = said(hears(made, 0, Audit(*STAMP)))
    assert [each.robot for each in answers if isinstance(each, Account)] == [1, 1]
    assert all(each.impact == made.mission.codec.encode(NOTHING) for each in answers[1:])
