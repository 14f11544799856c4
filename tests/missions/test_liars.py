"""One member lies, or misbehaves in any other way: the others finish, on a right map, and name it."""

from __future__ import annotations

import pytest

from tests.support import lies
from tests.support.liars import Ending, play, without
from tests.support.lies import MODES, PRICES, FewerCounts, Mode
from vedette.agent.account import Claimed
from vedette.agent.audit import Auditor
from vedette.agent.effects import Effect
from vedette.domains.mapping.planners import DEFAULT

BAD = sorted(MODES.keys() - PRICES.keys() - {"dead", "dead between", "honest", "misdated", "in the way"})
SCHEMES = ("fork", "async", "jacobi")
NAMED_WITHIN = 30.0  # [s]
LATER = 10.0  # with two rounds of the token in one, which take twice as long [s]


def check(
    mode: str,
    robots: int,
    seed: int,
    scheme: str | None = None,
    planner: str = DEFAULT,
    *,
    named: bool = True,
) -> Ending:
    """What must hold whatever one member does."""
    team = robots, seed, scheme, planner
    ending, dead = play(mode, *team), without(mode, *team)
    about = mode, team, ending
    assert ending.outcome.value == "complete", about
    assert ending.known >= 0.99 * dead.known, about
    assert ending.time <= 1.5 * dead.time, about
    assert ending.wrong <= 0.005, about
    assert is_named(ending) or not named, about
    return ending


def is_named(ending: Ending) -> bool:
    return ending.named.get(ending.liar, float("inf")) <= NAMED_WITHIN


@pytest.mark.parametrize("mode", ["claim", "counts", "double", "free", "mute", "notes", "poison", "slow"])
def test_a_team_of_three_finishes_and_names_who_misbehaves(mode: str) -> None:
    check(mode, 3, 0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("robots", [3, 5])
@pytest.mark.parametrize("mode", BAD)
def test_teams_finish_and_name_who_misbehaves(mode: str, robots: int, seed: int) -> None:
    check(mode, robots, seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("mode", ["claim", "free", "inflate", "notes"])
def test_teams_name_who_lies_whatever_the_scheme(mode: str, scheme: str, seed: int) -> None:
    check(mode, 3, seed, scheme)


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["claim", "free", "inflate", "notes", "sum"])
def test_two_rounds_of_the_token_in_one_name_who_lies_little_later(mode: str) -> None:
    ending = check(mode, 3, 0, "multistart", named=False)
    assert ending.named.get(ending.liar, float("inf")) <= NAMED_WITHIN + LATER
    assert ending.named.keys() == {ending.liar}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("robots", [3, 5])
def test_a_false_sum_that_its_teller_signs_convicts_it_before_all(robots: int, seed: int) -> None:
    ending = check("sum", robots, seed)
    assert ending.out == {ending.liar}


def test_no_robots_counts_make_others_expect_nothing_of_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    """By counts that nobody could refuse a team once ended after 2.4 s, with a third of its office known."""
    monkeypatch.setitem(lies.MODES, "counts", Mode(FewerCounts))  # type: ignore[arg-type]
    ending, dead = play("counts", 3, 0), without("dead", 3, 0)
    assert ending.known >= 0.99 * dead.known
    assert ending.time <= 1.5 * dead.time


def test_who_dates_what_it_sees_an_hour_off_is_named() -> None:
    ending = play("misdated", 3, 0)
    assert ending.outcome.value == "complete"
    assert is_named(ending)
    assert ending.named.keys() == {ending.liar}


def test_of_the_honest_nobody_is_named_and_all_are_believed() -> None:
    ending = play("honest", 3, 0)
    assert not ending.named
    assert not ending.out


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_a_robot_in_whose_way_a_liar_says_to_stand_is_not_named(seed: int) -> None:
    ending = play("in the way", 3, seed)
    assert ending.outcome.value == "complete"
    assert ending.named.keys() <= {ending.liar}


# -- prices --------------------------------------------------------------------------------------------------


@pytest.fixture
def audited(monkeypatch: pytest.MonkeyPatch) -> None:
    """Audits are held all the time, as if something were wrong."""
    decided = Auditor.decided

    def always(self: Auditor, claimed: Claimed, neighbours: tuple[int, ...], now: float) -> list[Effect]:
        self.want(now)
        return decided(self, claimed, neighbours, now)

    monkeypatch.setattr(Auditor, "decided", always)


@pytest.mark.usefixtures("audited")
@pytest.mark.parametrize("mode", ["overcharge", "undersell"])
def test_who_tells_another_price_than_those_behind_it_sign_is_named_by_an_audit(mode: str) -> None:
    ending = play(mode, 3, 0, planner="long")
    assert ending.outcome.value == "complete"
    assert is_named(ending)
    assert ending.named.keys() == {ending.liar}


@pytest.mark.usefixtures("audited")
@pytest.mark.parametrize(
    "scheme",
    ["token", *(pytest.param(scheme, marks=pytest.mark.slow) for scheme in (*SCHEMES, "multistart"))],
)
def test_audits_name_nobody_who_tells_prices_as_they_are(scheme: str) -> None:
    ending = play("honest", 3, 0, scheme, "long")
    assert ending.outcome.value == "complete"
    assert not ending.named


@pytest.mark.parametrize("mode", ["priceless", "unpriced"])
def test_a_false_price_that_is_told_and_signed_alike_keeps_nobody_from_work(mode: str) -> None:
    ending = check(mode, 3, 0, planner="long", named=False)
    assert not ending.named


@pytest.mark.slow
@pytest.mark.parametrize("mode", [mode for mode in BAD if mode != "inflate"])  # docs/trust.md
def test_teams_whose_tours_have_a_price_finish_whoever_misbehaves(mode: str) -> None:
    check(mode, 3, 0, planner="long", named=False)
