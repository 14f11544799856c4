"""Continuous controls: what replies by optimising come to, against closed forms, and when Jacobi must."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette import InputError, LogDet, Objective, Tree, negotiate
from vedette.problem.controls import Controls
from vedette.problem.dominance import diagonally_dominant

Float = NDArray[np.float64]


class Quadratic(Objective[tuple[Float, Float], Float]):
    """``b x - 1/2 x' Q x`` of everybody's controls, which impacts hold each in its place."""

    def nothing(self, belief: tuple[Float, Float]) -> Float:
        return np.zeros(len(belief[1]))

    def combine(self, a: Float, b: Float) -> Float:
        return a + b

    def value(self, belief: tuple[Float, Float], impact: Float) -> float:
        q, b = belief
        return float(b @ impact - 0.5 * impact @ q @ impact)


def platforms(sizes: list[int], wide: float = 50.0, threshold: float = 1e-6) -> list[Controls[Float]]:
    """Platforms with so many numbers to choose each, in a box that holds the optimum."""
    total, made = sum(sizes), []
    for i, size in enumerate(sizes):
        place = np.eye(total)[:, sum(sizes[:i]) : sum(sizes[: i + 1])]
        box = np.full(size, wide)
        made.append(Controls(lambda u, place=place: place @ u, -box, box, np.zeros(size), threshold))  # type: ignore[misc]
    return made


def equally_coupled(n: int, c: float) -> Float:
    return np.asarray((1.0 - c) * np.eye(n) + c)


def controls(result: Any) -> Float:
    return np.concatenate(result.controls)


def test_where_the_diagonal_dominates_both_schemes_end_at_the_closed_form_optimum() -> None:
    rng = np.random.default_rng(1)
    for sizes in ([1] * 5, [2, 1, 3]):
        n = sum(sizes)
        off = rng.normal(size=(n, n))
        off = np.triu(off, 1) + np.triu(off, 1).T
        q = np.eye(n) + off * (0.6 / np.abs(off).sum(axis=1).max())
        b = rng.normal(size=n)
        team = platforms(sizes)
        found = diagonally_dominant(Quadratic(), (q, b), team)
        assert found.holds
        assert found.share == pytest.approx(0.6, abs=1e-6)  # the largest row beside its diagonal of 1
        for scheme in ("token", "jacobi"):
            tree = Tree.random(len(sizes), seed=2)
            result = negotiate(Quadratic(), (q, b), team, tree, scheme, max_sweeps=200)
            assert result.converged
            np.testing.assert_allclose(controls(result), np.linalg.solve(q, b), atol=2e-5)
            assert result.choice == (-1,) * len(sizes)


def test_where_it_does_not_jacobi_need_not_converge_though_the_problem_is_concave_and_the_token_does() -> (
    None
):
    n, c = 6, 0.5  # eigenvalues 1 - c and 1 + (n - 1) c: concave; Jacobi's radius (n - 1) c = 2.5
    q, b = equally_coupled(n, c), np.arange(1.0, n + 1.0)
    team = platforms([1] * n)
    found = diagonally_dominant(Quadratic(), (q, b), team)
    assert not found.holds
    assert found.share == pytest.approx((n - 1) * c, abs=1e-6)
    jacobi = negotiate(Quadratic(), (q, b), team, Tree.chain(n), "jacobi", max_sweeps=60)
    token = negotiate(Quadratic(), (q, b), team, Tree.chain(n), max_sweeps=200)
    assert not jacobi.converged
    assert token.converged
    np.testing.assert_allclose(controls(token), np.linalg.solve(q, b), atol=1e-4)
    assert jacobi.value < token.value


def test_without_dominance_jacobi_may_converge_all_the_same() -> None:
    q = np.array([[1.0, 0.6, 0.6], [0.6, 1.0, 0.0], [0.6, 0.0, 1.0]])
    assert np.abs(np.linalg.eigvals(np.eye(3) - q)).max() < 1.0 < 1.2  # what its iterates shrink by
    found = diagonally_dominant(Quadratic(), (q, np.ones(3)), platforms([1, 1, 1]))
    assert (found.holds, found.platform) == (False, 0)
    assert found.share == pytest.approx(1.2, abs=1e-6)
    result = negotiate(
        Quadratic(), (q, np.ones(3)), platforms([1, 1, 1]), Tree.star(3), "jacobi", max_sweeps=500
    )
    assert result.converged
    np.testing.assert_allclose(controls(result), np.linalg.solve(q, np.ones(3)), atol=1e-4)


def test_a_value_that_is_not_concave_is_never_dominated_by_its_diagonal() -> None:
    found = diagonally_dominant(Quadratic(), (-np.eye(2), np.ones(2)), platforms([1, 1]))
    assert (found.holds, found.share) == (False, math.inf)


def test_a_platform_stops_when_its_control_changes_by_less_than_its_threshold() -> None:
    q, b = equally_coupled(3, 0.45), np.ones(3)
    run = Quadratic(), (q, b)
    sweeps = [
        negotiate(*run, platforms([1] * 3, threshold=most), Tree.chain(3), scheme, max_sweeps=300).sweeps
        for most in (0.1, 1e-3, 1e-6)
        for scheme in ("token", "jacobi")
    ]
    assert sweeps[0] < sweeps[2] < sweeps[4]
    assert sweeps[1] < sweeps[3] < sweeps[5]


def test_controls_end_at_the_edge_of_their_box_where_the_best_is_outside() -> None:
    team = platforms([1, 1], wide=0.5)
    result = negotiate(Quadratic(), (np.eye(2), np.array([2.0, -3.0])), team, Tree.chain(2))
    np.testing.assert_array_equal(controls(result), [0.5, -0.5])


@pytest.mark.parametrize("scheme", ["token", "jacobi", "fork", "async"])
def test_a_control_at_the_bottom_between_two_tops_leaves_it(scheme: str) -> None:
    """Along the line that is known best, turning either way gains, though the slope is 0."""
    prior, edge = np.diag([5.0, 1.0]), np.array([1.5])
    team = [Controls(line_of_sight, -edge, edge, np.zeros(1))]
    result = negotiate(LogDet(), prior, team, Tree.chain(1), scheme)
    assert result.controls[0] is not None
    assert abs(result.controls[0][0]) == 1.5
    assert result.value == pytest.approx(LogDet().value(prior, line_of_sight(edge)))
    assert result.converged


def test_controls_have_a_start_of_their_own_and_no_other() -> None:
    run = Quadratic(), (np.eye(2), np.ones(2)), platforms([1, 1]), Tree.chain(2)
    np.testing.assert_allclose(controls(negotiate(*run, start=[0, 0])), 1.0, rtol=1e-6)
    with pytest.raises(InputError, match=r"^start\[1\] = 2, but platform 1 has candidates 0 to 0$"):
        negotiate(*run, start=[0, 2])


def line_of_sight(u: Float) -> Float:
    """Information of a bearing along the direction ``u``."""
    h = np.array([math.cos(u[0]), math.sin(u[0])])
    return np.outer(h, h)


def test_bearings_turn_until_nobody_gains_by_turning_and_the_value_never_falls() -> None:
    prior = np.array([[1.0, 0.3], [0.3, 0.5]])
    team = [
        Controls(line_of_sight, np.array([-1.5]), np.array([1.5]), np.array([start]))
        for start in (0.2, 0.9, -0.7)
    ]
    result = negotiate(LogDet(), prior, team, Tree.chain(3), max_sweeps=200)
    values = [step.value for step in result.history]
    assert result.converged
    assert np.all(np.diff(values) >= -1e-12)
    chosen = [line_of_sight(u) for u in result.controls if u is not None]
    for i in range(3):
        rest = sum((chosen[j] for j in range(3) if j != i), start=np.zeros((2, 2)))
        own = [rest + line_of_sight(np.array([angle])) for angle in np.linspace(-1.5, 1.5, 2001)]
        assert max(LogDet().value(prior, each) for each in own) <= result.value + 1e-7
    assert result.bound is None  # nobody has looked at all controls


def test_platforms_with_controls_and_with_lists_negotiate_together() -> None:
    q, b = equally_coupled(2, 0.2), np.array([1.0, 1.0])
    listed = [np.array([0.0, u]) for u in np.linspace(-1.0, 1.0, 201)]
    result = negotiate(Quadratic(), (q, b), [platforms([1, 1])[0], listed], Tree.chain(2))
    assert result.controls[1] is None
    assert result.controls[0] is not None
    u, v = float(result.controls[0][0]), float(listed[result.choice[1]][1])
    assert (u, v) == (pytest.approx(1.0 - 0.2 * v, abs=1e-6), pytest.approx(1.0 - 0.2 * u, abs=0.005))


@pytest.mark.parametrize(
    ("low", "high", "start", "threshold", "told"),
    [
        ([0.0], [0.0], [0.0], 1e-6, "low must be below high"),
        ([0.0], [1.0], [2.0], 1e-6, "start must be from low to high"),
        ([0.0], [math.inf], [0.0], 1e-6, "high must be finite"),
        ([0.0], [1.0], [0.0, 0.0], 1e-6, "start must have shape"),
        ([0.0], [1.0], [0.0], 0.0, "threshold must be a number > 0"),
    ],
)
def test_what_is_no_box_is_refused_in_one_line(
    low: list[float], high: list[float], start: list[float], threshold: float, told: str
) -> None:
    with pytest.raises(InputError, match=told):
        Controls(lambda u: u, np.array(low), np.array(high), np.array(start), threshold)


def test_dominance_asks_for_controls() -> None:
    with pytest.raises(InputError, match="a Controls for each platform"):
        diagonally_dominant(LogDet(), np.eye(2), [[np.eye(2)]])  # type: ignore[list-item]


@pytest.mark.parametrize("seed", [-1, 1.5, "one", None, True])
def test_dominance_asks_for_a_seed(seed: Any) -> None:
    with pytest.raises(InputError, match=r"^seed must be a whole number >= 0; got "):
        diagonally_dominant(Quadratic(), (np.eye(1), np.ones(1)), platforms([1]), seed=seed)


@pytest.mark.parametrize("start", [-50.0, 0.0, 50.0])
def test_dominance_asks_nothing_of_controls_outside_their_limits(start: float) -> None:
    asked: list[float] = []

    def impact(u: Float) -> Float:
        asked.extend(u.tolist())
        return u

    own = Controls(impact, np.array([-50.0]), np.array([50.0]), np.array([start]))
    diagonally_dominant(Quadratic(), (np.eye(1), np.ones(1)), [own])
    assert -50.0 <= min(asked) < max(asked) <= 50.0
