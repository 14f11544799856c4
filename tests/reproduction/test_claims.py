"""The reproduction's claims against formulas and computations of their own."""

from __future__ import annotations

import ast
import dataclasses
import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.support.reproductions import named, silent
from vedette import Tree
from vedette.problem import Coverage, LogDet, exhaustive
from vedette_reproduction import claims, teams
from vedette_reproduction.claims.asynchrony import c9, leave_one_out_is_exact
from vedette_reproduction.claims.convergence import c3, two_robots
from vedette_reproduction.claims.cost import c4, c4_to_c7, c5, c6
from vedette_reproduction.claims.definition import c1, c2, expected_entropy, miss_of, outcomes
from vedette_reproduction.claims.fusion import Look, c10, central_update
from vedette_reproduction.claims.iterations import COUPLING, c8
from vedette_reproduction.claims.search import c13
from vedette_reproduction.content import Section, Table, Verdict
from vedette_reproduction.costs import FIXED, GROWING, SCHEMES, TREES, Cost
from vedette_reproduction.links import sweep, team_on
from vedette_reproduction.missions import Missions
from vedette_reproduction.post import SparseCodec, record
from vedette_reproduction.quadratic import (
    jacobi_step,
    random_hessian,
    spectral_radius,
    steps_to_optimum,
    token_step,
)
from vedette_reproduction.run import QUICK, ReproductionRun


@pytest.fixture
def run(tmp_path: Path) -> ReproductionRun:
    """A very small reproduction."""
    scale = dataclasses.replace(QUICK, teams=(2, 4, 8), largest_dense=8, trials=3, targets=4000)
    return ReproductionRun(scale, 7, tmp_path, Missions(silent), silent)


def numbers(table: Table, column: str) -> list[float]:
    """Return a column of numbers."""
    place = table.columns.index(column)
    return [float(row[place] or 0.0) for row in table.rows]


def test_two_teams_of_equal_impacts_miss_as_often_as_counting_maps_says() -> None:
    assert miss_of([[0, 1, 2, 6]], 6) == 1 - 0.5**3
    assert miss_of([[0, 1, 2, 6], [0, 1, 2, 6]], 6) == 1 - 0.5**3
    assert miss_of([[0, 1, 2, 6], [5, 4, 3, 6]], 6) == (1 - 0.5**3) ** 2


def test_expected_entropy_is_that_of_the_cells_that_stay_unobserved() -> None:
    rays = [[0, 1, 2, 6], [5, 4, 3, 6]]
    unobserved = 0
    for one in itertools.product((False, True), repeat=7):
        seen = {c for ray in rays for k, c in enumerate(ray) if not any(one[b] for b in ray[:k])}
        unobserved += 7 - len(seen)
    assert expected_entropy(rays, 7) == pytest.approx(unobserved / 2**7 * np.log(2.0))


def test_joint_observations_multiply_with_the_platforms() -> None:
    assert [outcomes([range(4 * i, 4 * i + 4) for i in range(n)]) for n in (1, 2, 3)] == [5, 25, 125]


def test_definition_claims_hold(run: ReproductionRun) -> None:
    assert c1(run).verdict is Verdict.HOLDS
    section = c2(run)
    assert section.verdict is Verdict.HOLDS
    assert section.tables[0].rows == ((15, 15, 15),)


def test_two_robots_cycle_between_the_values_of_the_two_frontiers() -> None:
    duel = two_robots()
    assert (duel.cycle, duel.converged) == (2, False)
    assert [step.value for step in duel.history] == [0.0, 1.0, 0.8, 1.0]
    misses = [np.array([0.0, 1.0]), np.array([1.0, 0.0])]
    assert exhaustive(Coverage(), np.array([1.0, 0.8]), [misses, misses]).value == pytest.approx(1.8)
    assert two_robots("token").value == pytest.approx(1.8)


def test_all_that_begin_at_the_same_of_equal_lists_cycle_and_get_the_best_place_only(
    run: ReproductionRun,
) -> None:
    section = c3(run)
    assert section.verdict is Verdict.IN_PART
    cycles = named(section, "c3_cycles")
    same = [row for row in cycles.rows if str(row[0]).startswith("one list")]
    assert [row[2] for row in same] == [1.0, 1.0, 1.0]
    dominant = named(section, "c3_quadratic").rows[0]
    assert dominant[1] == dominant[2] == dominant[3]


def test_replies_at_once_shrink_errors_by_the_coupling_times_the_others() -> None:
    for n in (3, 9, 12):
        q = np.eye(n) + COUPLING * (np.ones((n, n)) - np.eye(n))
        assert spectral_radius(q) == pytest.approx(COUPLING * (n - 1))
        reached = steps_to_optimum(q, np.arange(n, dtype=float), jacobi_step)
        assert (reached is not None) == (COUPLING * (n - 1) < 1.0)
        assert steps_to_optimum(q, np.arange(n, dtype=float), token_step) is not None


def test_random_hessians_are_dominant_where_they_are_meant_to_be() -> None:
    rng = np.random.default_rng(1)
    for span in ((0.3, 0.99), (1.01, 3.0)):
        q = random_hessian(rng, span)
        beside = (np.abs(q) - np.eye(len(q))).sum(axis=1).max()
        assert span[0] <= beside <= span[1]
        assert np.linalg.eigvalsh(q)[0] > 0.0


def test_a_separable_problem_takes_one_sweep_and_dense_coupling_diverges(run: ReproductionRun) -> None:
    section = c8(run)
    sweeps = named(section, "c8_sweeps")
    assert {row[3] for row in sweeps.rows if row[0] == "separable"} == {1.0}
    assert section.verdict is Verdict.IN_PART


@pytest.mark.parametrize("scheme", ["jacobi", "token"])
def test_messages_are_twice_the_links_a_sweep(scheme: str) -> None:
    rng = np.random.default_rng(2)
    for n in (2, 5, 9):
        team = teams.fixed_area(n, rng)
        tree = Tree.random(n, seed=rng)
        recording = record(Coverage(), [team.weights], team.candidates, tree, scheme, max_sweeps=4)
        whole = 2 * (n - 1) * (recording.outcome.sweeps + 1)
        if scheme == "jacobi":
            assert len(recording.letters) == whole
        assert len(recording.letters) <= whole
        assert recording.sent(n).sum() == len(recording.letters)


def test_cost_claims_have_their_verdicts_and_their_counts(run: ReproductionRun) -> None:
    sections = c4_to_c7(run)
    assert [section.verdict for section in sections] == [
        Verdict.IN_PART, Verdict.IN_PART, Verdict.IN_PART, Verdict.HOLDS,
    ]  # fmt: skip
    assert sections[0].judgement == "holds in part: on a chain, not at a star's hub"
    messages = named(sections[1], "c5_messages")
    papers = [row for row in messages.rows if row[0] == SCHEMES["jacobi"]]
    assert [row[4] for row in papers] == pytest.approx([row[6] for row in papers])
    assert max(float(row[5] or 0) for row in papers if row[2] == "chain") == 2.0
    assert [row[5] for row in papers if row[2] == "star"] == [1.0, 3.0, 7.0]
    sizes = named(sections[2], "c6_bytes")
    fixed = [row[5] for row in sizes.rows if row[1] == "fixed" and row[0] == SCHEMES["jacobi"]]
    assert max(map(float, fixed)) - min(map(float, fixed)) < 8  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("judged", "field", "few", "many"),
    [(c4, "most_combinations", 2.0, 99.0), (c5, "most_messages", 2.0, 99.0), (c6, "longest", 500, 900)],
)
def test_a_cost_claim_is_judged_by_what_was_measured_on_a_chain_and_elsewhere(
    judged: Callable[[list[Cost]], Section], field: str, few: float, many: float
) -> None:
    """What grows: nothing, at a star's hub or over a growing area only, or everywhere."""

    def verdict(everywhere: bool, elsewhere: bool) -> Verdict | None:
        costs = []
        for area, tree, n in itertools.product((FIXED, GROWING), TREES, (2, 8)):
            usual = area == FIXED and tree == "chain"
            grown = n == 8 and (everywhere if usual else everywhere or elsewhere)
            blank = Cost(SCHEMES["jacobi"], area, tree, n, 3, 1.0, 2.0, 2.0, 1.5, 2.0, 12, 500, 400.0, 0.0)
            costs.append(dataclasses.replace(blank, **{field: many if grown else few}))
        return judged(costs).verdict

    assert verdict(everywhere=False, elsewhere=False) is Verdict.HOLDS
    assert verdict(everywhere=False, elsewhere=True) is Verdict.IN_PART
    assert verdict(everywhere=True, elsewhere=True) is Verdict.FAILS


def test_no_verdict_is_a_constant() -> None:
    """Every one is computed: none stands in a source file as it is."""
    judged = 0
    for file in Path(claims.__path__[0]).glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Section":
                verdict = node.args[4]
                assert isinstance(verdict, ast.IfExp | ast.Call), f"{file.name}: {ast.unparse(verdict)}"
                judged += 1
    assert judged == 13  # C1 to C13


def test_only_touched_cells_travel_and_come_back_as_they_were() -> None:
    impact = np.array([1.0, 0.25, 1.0, 0.0])
    codec = SparseCodec(4)
    assert len(codec.encode(impact)) == 2 * 12
    np.testing.assert_array_equal(codec.decode(codec.encode(impact)), impact)


def test_asynchronous_delivery_changes_nothing_and_a_ring_counts_again_and_again(
    run: ReproductionRun,
) -> None:
    section = c9(run)
    order, (loose, confirmed) = named(section, "c9_order").rows[0], named(section, "c9_stale").rows
    assert order[1] == order[2] == order[3]
    assert section.verdict is Verdict.IN_PART
    assert loose[2] > 0.0 == confirmed[2]
    assert confirmed[3] == confirmed[4]
    assert "async" in section.judgement
    assert f"{confirmed[5]:.3f} of the token's value" in section.judgement
    ring = numbers(named(section, "c9_ring"), "held by another")
    assert ring == sorted(ring, reverse=True)
    assert ring[-1] < 1e-12
    assert leave_one_out_is_exact(9, Tree.random(9, seed=3), np.random.default_rng(3))


def test_a_sweep_of_news_takes_one_message_each_way_on_every_link() -> None:
    rng = np.random.default_rng(4)
    tree = Tree.random(7, seed=rng)
    team = teams.fixed_area(7, rng)
    members = team_on(tree, Coverage(), team.weights, team.candidates, [0] * 7)
    assert sweep(members, tree) == 2 * 6
    assert sweep(members, tree) == 0
    rest = np.prod([own[0] for own in team.candidates[1:]], axis=0)
    np.testing.assert_allclose(members[0].links.others(), rest)


def test_fusion_by_the_code_of_control_equals_the_central_filter(run: ReproductionRun) -> None:
    section = c10(run)
    assert section.verdict is Verdict.HOLDS
    assert {row[2] for row in named(section, "c10_form").rows} == {2 * 5}


def test_the_central_filter_is_the_conditional_of_the_joint_gaussian() -> None:
    rng = np.random.default_rng(5)
    root = rng.standard_normal((4, 4))
    covariance, mean = root @ root.T + np.eye(4), rng.standard_normal(4)
    look = Look(np.array([2.0]), rng.standard_normal((1, 4)), np.array([[0.3]]))
    z = np.array([1.5])
    joint = look.jacobian @ covariance @ look.jacobian.T + look.noise
    cross = covariance @ look.jacobian.T
    expected = mean + (cross / joint) @ (z - look.offset - look.jacobian @ mean)
    state, posterior = central_update(mean, covariance, [look], [z])
    np.testing.assert_allclose(state, expected)
    np.testing.assert_allclose(posterior, covariance - cross @ cross.T / joint)
    gain = LogDet().value(np.asarray(np.linalg.inv(covariance), np.float64), look.information)
    assert gain == pytest.approx(0.5 * np.log(joint[0, 0] / look.noise[0, 0]))


def test_search_value_is_the_share_of_drawn_targets_detected(run: ReproductionRun) -> None:
    section = c13(run)
    assert section.verdict is Verdict.HOLDS
    for value, drawn in zip(
        numbers(section.tables[0], "value"), numbers(section.tables[0], "drawn"), strict=True
    ):
        assert value == pytest.approx(drawn, abs=0.03)


def test_teams_of_constant_density_bring_their_own_area() -> None:
    rng = np.random.default_rng(6)
    assert len(teams.constant_density(16, rng).weights) == 4 * len(teams.constant_density(4, rng).weights)
    assert len(teams.fixed_area(16, rng).weights) == len(teams.fixed_area(4, rng).weights)
