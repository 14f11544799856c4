"""Fusing Gaussian tracks: exact ways against the central filter, the others against the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.step_network import Edges, StepNetwork, chain, random_tree, ring
from vedette.errors import InputError
from vedette.fusion.gaussian import (
    WAYS,
    GaussianChannel,
    Information,
    Likelihoods,
    TrackFusion,
    TrackMotion,
    TrackPacking,
    intersect,
    track_fusion,
)
from vedette.fusion.gaussian.wire import TrackMessage
from vedette.fusion.gaussian.wire import encode as encode_tracks
from vedette.fusion.link import Payload
from vedette.fusion.steps import Sparse
from vedette.fusion.steps.wire import Entries, pack
from vedette.fusion.steps.wire import encode as encode_steps

Floats = NDArray[np.float64]
TARGETS = 150  # independent of each other: as many Monte-Carlo runs in one
MANY = 3.3 * np.sqrt(2.0 / TARGETS)  # half the 99.9 % band of a mean chi-square of one degree of freedom


@dataclass(frozen=True, eq=False)
class Scene:
    """Targets that move as the filter believes, seen by linear sensors with position noise."""

    motion: TrackMotion
    prior: Information
    noise: float = 2.0  # of a sensor, standard deviation [m]

    @property
    def dimension(self) -> int:
        return self.prior.vector.shape[1]

    def start(self, rng: np.random.Generator) -> Floats:
        mean, covariance = self.prior.moments()
        return mean + np.einsum("tij,tj->ti", np.linalg.cholesky(covariance), rng.normal(size=mean.shape))

    def move(self, truth: Floats, rng: np.random.Generator) -> Floats:
        values, vectors = np.linalg.eigh(self.motion.noise)
        root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        drift = np.einsum("tij,tj->ti", self.motion.transition, truth)
        return drift + np.einsum("tij,tj->ti", root, rng.normal(size=truth.shape))

    def look(self, truth: Floats, rng: np.random.Generator) -> Information:
        """A sensor's likelihood: it sees one or two axes of about half of the targets."""
        targets, d = truth.shape
        matrix, vector = np.zeros((targets, d, d)), np.zeros((targets, d))
        seen = rng.random((targets, 2)) < 0.5
        for axis in range(2):
            z = truth[:, axis] + rng.normal(0.0, self.noise, targets)
            matrix[:, axis, axis] = seen[:, axis] / self.noise**2
            vector[:, axis] = seen[:, axis] * z / self.noise**2
        return Information(matrix, vector)


def moving(targets: int = TARGETS, q: float = 0.5) -> Scene:
    """Near-constant velocity, white acceleration of rank 2."""
    transition = np.eye(4) + np.eye(4, k=2)
    gain = np.vstack([0.5 * np.eye(2), np.eye(2)])
    covariance = np.diag([100.0, 100.0, 4.0, 4.0])
    return scene(targets, transition, q * gain @ gain.T, covariance)


def static(targets: int = TARGETS) -> Scene:
    return scene(targets, np.eye(2), np.zeros((2, 2)), np.diag([100.0, 100.0]))


def scene(targets: int, transition: Floats, noise: Floats, covariance: Floats) -> Scene:
    def each(m: Floats) -> Floats:
        return np.repeat(m[None], targets, axis=0)

    mean = 50.0 * np.arange(len(covariance)) * np.ones((targets, 1))
    return Scene(TrackMotion(each(transition), each(noise)), Information.from_moments(mean, each(covariance)))


class Central:
    """The Kalman filter that sees everybody's measurements: moments, gain form."""

    def __init__(self, of: Scene) -> None:
        self.mean, self.covariance = of.prior.moments()
        self._motion = of.motion

    def predict(self) -> None:
        f, q = self._motion.transition, self._motion.noise
        self.mean = np.einsum("tij,tj->ti", f, self.mean)
        self.covariance = f @ self.covariance @ f.swapaxes(1, 2) + q

    def update(self, likelihood: Information) -> None:
        """``P' = (1 + P I)^-1 P``, ``x' = x + P' (i - I x)``."""
        one = np.eye(self.mean.shape[1])
        updated = np.linalg.solve(one + self.covariance @ likelihood.matrix, self.covariance)
        innovation = likelihood.vector - np.einsum("tij,tj->ti", likelihood.matrix, self.mean)
        self.mean = self.mean + np.einsum("tij,tj->ti", updated, innovation)
        self.covariance = updated

    def matches(self, robot: TrackFusion, tolerance: float = 1e-9) -> bool:
        mean, covariance = robot.estimate()[1].moments()
        return np.allclose(mean, self.mean, rtol=0.0, atol=100.0 * tolerance) and np.allclose(
            covariance, self.covariance, rtol=0.0, atol=100.0 * tolerance
        )


def team(
    way: str, of: Scene, n: int, edges: Edges, seed: int = 0, **links: float
) -> StepNetwork[TrackFusion]:
    def make(i: int) -> TrackFusion:
        return fusion(way, of, i)

    return StepNetwork(make, n, edges, np.random.default_rng(seed), **links)


def fusion(way: str, of: Scene, robot: int, boot: int = 3) -> TrackFusion:
    return track_fusion(way, robot, boot, of.prior, of.motion, 0, most_matrix=1.0, most_vector=1e4)


def nees(tracks: Information, truth: Floats) -> float:
    """Mean over targets and dimensions of ``(x - truth)' Y (x - truth)``: 1 if consistent."""
    error = tracks.moments()[0] - truth
    return float(np.einsum("ti,tij,tj->t", error, tracks.matrix, error).mean() / truth.shape[1])


@dataclass(frozen=True, eq=False)
class Run:
    """How a team's tracks compare with the truth and with the central filter, after some steps."""

    nees: float  # worst robot
    sharpness: float  # [nats] the sharpest robot's information over the central filter's, a dimension
    central: Central
    net: StepNetwork[TrackFusion]


def follow(of: Scene, net: StepNetwork[TrackFusion], *, steps: int, hops: int | None) -> Run:
    """Targets move, everybody looks and exchanges: news goes so many hops a step, or (None) in a round."""
    rng = np.random.default_rng(99)
    truth, central = of.start(rng), Central(of)
    net.meet()
    for step in range(steps):
        if step:
            truth = of.move(truth, rng)
            central.predict()
        for robot in net.robots.values():
            likelihood = of.look(truth, rng)
            robot.observe(step, likelihood)
            central.update(likelihood)
        if hops is None:
            net.round()
        else:
            net.run(hops)
    tracks = [robot.estimate()[1] for robot in net.robots.values()]
    best = max(float(np.linalg.slogdet(t.matrix)[1].mean()) for t in tracks)
    reference = float(-np.linalg.slogdet(central.covariance)[1].mean())
    sharpness = 0.5 * (best - reference) / of.dimension
    return Run(max(nees(t, truth) for t in tracks), sharpness, central, net)


# -- exact ways ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", ["replicated", "sums"])
@pytest.mark.parametrize("seed", range(3))
def test_refiltered_tracks_equal_the_central_filter_however_late_evidence_comes(way: str, seed: int) -> None:
    of, rng = moving(3), np.random.default_rng(seed)
    net = team(way, of, 5, random_tree(5, rng), seed, loss=0.3, repeat=0.3, most_delay=3.0)
    run = follow(of, net, steps=15, hops=1)
    assert not all(run.central.matches(robot) for robot in net.robots.values())
    net.run(40)
    assert all(run.central.matches(robot) for robot in net.robots.values())
    assert len({robot.digest for robot in net.robots.values()}) == 1
    first, *others = [robot.estimate()[1] for robot in net.robots.values()]
    assert all((other.matrix == first.matrix).all() for other in others)
    assert all((other.vector == first.vector).all() for other in others)


@pytest.mark.parametrize("seed", range(6))
def test_on_random_trees_channels_give_static_targets_the_central_filters_tracks(seed: int) -> None:
    of, rng = static(4), np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    net = team("channel", of, n, random_tree(n, rng), seed, loss=0.3, repeat=0.3, most_delay=4.0)
    run = follow(of, net, steps=25, hops=1)
    net.run(60)
    assert all(run.central.matches(robot) for robot in net.robots.values())
    assert len({robot.digest for robot in net.robots.values()}) == 1
    assert net.is_quiet()


@pytest.mark.parametrize("way", ["replicated", "sums", "channel"])
def test_with_a_round_each_step_all_exact_ways_equal_the_central_filter(way: str) -> None:
    of, rng = moving(4), np.random.default_rng(4)
    net = team(way, of, 7, random_tree(7, rng))
    run = follow(of, net, steps=30, hops=None)
    assert all(run.central.matches(robot) for robot in net.robots.values())
    assert len({robot.digest for robot in net.robots.values()}) == 1


def test_channels_with_delay_are_a_little_overconfident_about_moving_targets() -> None:
    of = moving()
    late, exact = (follow(of, team(w, of, 6, chain(6)), steps=25, hops=1) for w in ("channel", "sums"))
    assert 1e-4 < late.sharpness - exact.sharpness < 0.05
    assert exact.nees < late.nees < 1.0 + MANY / np.sqrt(of.dimension)


# -- consistency -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("way", WAYS)
def test_on_a_tree_no_way_is_overconfident_about_moving_targets(way: str) -> None:
    of = moving()
    run = follow(of, team(way, of, 4, [(0, 1), (1, 2), (1, 3)]), steps=25, hops=None)
    band = MANY / np.sqrt(of.dimension)
    if way == "intersection":
        assert run.nees < 1.0 + band
        assert run.sharpness < 0.0
    else:
        assert abs(run.nees - 1.0) < band
        assert abs(run.sharpness) < 1e-9


@pytest.mark.parametrize("way", ["replicated", "intersection", "channel"])
@pytest.mark.parametrize("of", [static(), moving()], ids=["static", "moving"])
def test_on_a_ring_channels_count_twice_and_the_others_do_not(way: str, of: Scene) -> None:
    run = follow(of, team(way, of, 4, ring(4)), steps=12, hops=4)
    band = MANY / np.sqrt(of.dimension)
    if way == "channel":
        assert run.nees > 1.0 + 5.0 * band
        assert run.sharpness > 0.2
    else:
        assert run.nees < 1.0 + band
    if way == "replicated":
        run.net.run(5)
        assert all(run.central.matches(robot) for robot in run.net.robots.values())


# -- what may happen to a channel ------------------------------------------------------------------------


def test_a_change_of_tree_costs_nothing_of_what_everybody_knew() -> None:
    of = static(5)
    run = follow(of, team("channel", of, 6, chain(6)), steps=5, hops=None)
    net = run.net
    net.connect([(5, 0), (0, 3), (3, 1), (1, 4), (4, 2)])
    net.run(15)
    assert all(run.central.matches(robot) for robot in net.robots.values())
    assert net.is_quiet()


@pytest.mark.parametrize("seed", range(5))
def test_after_partition_restart_and_rejoining_nothing_counts_twice_and_new_evidence_counts_in_full(
    seed: int,
) -> None:
    of, rng = static(), np.random.default_rng(seed)
    truth, n = of.start(rng), 6
    net = team("channel", of, n, random_tree(n, rng), seed, loss=0.2, repeat=0.2, most_delay=2.0)
    for epoch in range(4):
        for _ in range(6):
            for robot in net.robots.values():
                if rng.random() < 0.3:
                    robot.observe(0, of.look(truth, rng))
            net.run(1)
        if epoch == 1:
            net.robots[0] = fusion("channel", of, 0, boot=4)
        order = rng.permutation(n).tolist()
        tree = [(order[a], order[b]) for a, b in random_tree(n, rng)]
        net.connect(tree if epoch % 2 else tree[:3])
    net.run(60)
    tracks = [robot.estimate()[1] for robot in net.robots.values()]
    assert max(nees(t, truth) for t in tracks) < 1.0 + MANY / np.sqrt(2)
    assert len({robot.digest for robot in net.robots.values()}) == 1
    assert net.is_quiet()
    news = of.look(truth, rng)
    net.robots[2].observe(0, news)
    net.run(30)
    for robot, before in zip(net.robots.values(), tracks, strict=True):
        after = robot.estimate()[1]
        assert np.allclose(after.matrix, before.matrix + news.matrix, rtol=1e-9, atol=1e-12)
        assert np.allclose(after.vector, before.vector + news.vector, rtol=1e-9, atol=1e-12)


def test_two_that_share_a_secret_and_meet_through_others_do_not_count_it_twice() -> None:
    of, rng = static(), np.random.default_rng(0)
    truth = of.start(rng)
    net = team("channel", of, 4, [(0, 3), (1, 2)])
    for _ in range(10):
        net.robots[0].observe(0, of.look(truth, rng))
    net.run(10)
    secret = net.robots[3].estimate()[1]
    net.connect(chain(4))
    net.run(20)
    for robot in net.robots.values():
        assert np.allclose(robot.estimate()[1].matrix, secret.matrix, rtol=1e-6, atol=1e-12)


def test_a_robot_that_restarts_gets_its_own_old_evidence_back_and_counts_it_once() -> None:
    of = static(4)
    run = follow(of, team("channel", of, 3, chain(3)), steps=4, hops=None)
    net = run.net
    for old in (1, 2):
        net.robots[old] = fusion("channel", of, old, boot=4)
        near = [b if a == old else a for a, b in net.edges if old in (a, b)]
        net.robots[old].set_neighbours(near)
        net.robots[old].advance(3)
        net.run(15)
    assert all(run.central.matches(robot) for robot in net.robots.values())
    assert net.is_quiet()


def test_a_channel_keeps_few_common_tracks_however_long_a_neighbour_is_silent_and_recovers() -> None:
    of = static(3)
    net = team("channel", of, 2, chain(2), loss=1.0)
    run = follow(of, net, steps=3, hops=None)
    rng = np.random.default_rng(1)
    for _ in range(50):
        for robot in net.robots.values():
            likelihood = of.look(np.zeros((3, 2)), rng)
            robot.observe(2, likelihood)
            run.central.update(likelihood)
        net.run(1)
    assert all(len(edge.common) <= 9 for r in net.robots.values() for edge in r._edges.values())
    net.loss = 0.0
    net.run(15)
    assert all(run.central.matches(robot) for robot in net.robots.values())


@pytest.mark.parametrize("way", ["sums", "channel", "intersection"])
def test_messages_are_as_long_in_a_large_team_as_in_a_small_one(way: str) -> None:
    of = moving(6)
    sizes = {}
    for n in (8, 32):
        net = team(way, of, n, chain(n))
        follow(of, net, steps=3, hops=None)
        sizes[n] = max(net.sizes)
    assert sizes[32] <= 1.1 * sizes[8]


# -- covariance intersection -----------------------------------------------------------------------------


@given(st.integers(0, 10_000))
@settings(deadline=None, max_examples=40)
def test_the_weight_maximises_the_determinant(seed: int) -> None:
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(2, 5, 3, 3)) * np.exp(rng.normal(size=(2, 5, 1, 1)))
    a, b = roots @ roots.swapaxes(2, 3) + 0.1 * np.eye(3)
    merged = intersect(Information(a, np.ones((5, 3))), Information(b, np.zeros((5, 3))))
    best = np.linalg.slogdet(merged.matrix)[1]
    for w in np.linspace(0.0, 1.0, 101):
        assert (best >= np.linalg.slogdet(w * a + (1.0 - w) * b)[1] - 1e-9).all()
    weight = merged.vector[:, 0]
    expected = weight[:, None, None] * a + (1.0 - weight)[:, None, None] * b
    np.testing.assert_allclose(merged.matrix, expected, rtol=1e-9, atol=1e-12)


def test_the_larger_of_two_tracks_comes_out_unchanged() -> None:
    rng = np.random.default_rng(0)
    root = rng.normal(size=(4, 3, 3))
    small = Information(root @ root.swapaxes(1, 2) + np.eye(3), rng.normal(size=(4, 3)))
    large = small + Information(np.repeat(np.diag([1.0, 0.0, 3.0])[None], 4, axis=0), np.ones((4, 3)))
    for a, b in ((small, large), (large, small), (large, large)):
        merged = intersect(a, b)
        assert (merged.matrix == large.matrix).all()
        assert (merged.vector == large.vector).all()


@pytest.mark.parametrize(("gain", "passed_on"), [(1e-1, True), (1e-5, True), (1e-7, False), (0.0, False)])
def test_what_is_merged_is_passed_on_from_a_millionth_of_a_nat_on(gain: float, passed_on: bool) -> None:
    of = static(targets=1)
    net = team("intersection", of, 3, chain(3))
    net.meet()
    net.run(20)
    assert all(net.robots[i].outgoing(k, 1e3) is None for i, k in ((0, 1), (1, 0), (1, 2), (2, 1)))
    before = net.robots[2].estimate()[1].matrix.copy()
    more = np.exp(gain) - 1.0  # of both axes' information: log det grows by twice the gain
    prior = of.prior.matrix[0, 0, 0]
    net.robots[0].observe(0, Information(more * prior * np.eye(2)[None], np.zeros((1, 2))))
    net.run(20)
    after = net.robots[2].estimate()[1].matrix
    grown = float((np.linalg.slogdet(after)[1] - np.linalg.slogdet(before)[1])[0])
    assert grown == pytest.approx(2.0 * gain if passed_on else 0.0, rel=1e-6, abs=1e-12)


# -- bad input -------------------------------------------------------------------------------------------


def test_bad_input_is_told_in_one_line() -> None:
    of = moving(2)
    with pytest.raises(InputError, match="did you mean 'channel'"):
        fusion("chanel", of, 0)
    singular = of.prior.matrix.copy()
    singular[1, 0, 0] = 0.0
    improper = replace(of, prior=Information(singular, of.prior.vector))
    with pytest.raises(InputError, match=r"target 1 must be symmetric and positive definite"):
        fusion("channel", improper, 0)
    with pytest.raises(InputError, match=r"\(3, 4, 4\); the prior has \(2, 4, 4\)"):
        fusion("sums", replace(of, motion=moving(3).motion), 0)
    with pytest.raises(InputError, match="NaN"):
        Information(np.full((1, 2, 2), np.nan), np.zeros((1, 2)))
    with pytest.raises(InputError, match=r"\(T, d, d\)"):
        Information(np.zeros((1, 2, 3)), np.zeros((1, 2)))
    with pytest.raises(InputError, match="positive semidefinite"):
        TrackMotion(np.eye(2)[None], -np.eye(2)[None])
    with pytest.raises(InputError, match="F F' "):
        TrackMotion(np.zeros((1, 2, 2)), np.zeros((1, 2, 2)))
    for way in WAYS:
        robot = fusion(way, of, 0)
        with pytest.raises(InputError, match="likelihood has shape"):
            robot.observe(0, moving(3).look(np.zeros((3, 4)), np.random.default_rng(0)))
    late = fusion("channel", of, 0)
    late.advance(5)
    with pytest.raises(InputError, match="step 3 comes at step 5"):
        late.observe(3, of.look(np.zeros((2, 4)), np.random.default_rng(0)))


@pytest.mark.parametrize("way", WAYS)
def test_damaged_track_payloads_raise_value_error_and_change_nothing(way: str) -> None:
    of, rng = static(2), np.random.default_rng(0)
    net = team(way, of, 2, chain(2))
    follow(of, net, steps=2, hops=None)
    net.robots[0].observe(2, of.look(np.zeros((2, 2)), rng))
    payload = net.robots[0].outgoing(1, net.now)
    assert payload is not None
    receiver = net.robots[1]
    before = receiver.estimate()[1].matrix.copy()
    for cut in range(0, len(payload), 7):
        with pytest.raises(ValueError, match=r"payload|evidence"):
            receiver.receive(0, payload[:cut], net.now)
    assert (receiver.estimate()[1].matrix == before).all()


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10**6), robots=st.integers(1, 60), scale=st.floats(1e-6, 1.0))
def test_no_sum_of_real_likelihoods_is_refused(seed: int, robots: int, scale: float) -> None:
    """However near to singular: each sees a line or two through the targets' states."""
    rng, kinds = np.random.default_rng(seed), Likelihoods(TrackPacking(3, 4), 1.0, 1e4)
    total = kinds.elements.zero()
    for _ in range(robots):
        lines = rng.normal(size=(3, int(rng.integers(1, 3)), 4)) * (rng.random((3, 1, 1)) < 0.6)
        matrix = np.einsum("tki,tkj->tij", lines, lines)
        matrix *= scale / max(float(np.abs(matrix).max()), 1e-9)
        likelihood = Information(matrix, rng.normal(0.0, 100.0, (3, 4)))
        total = kinds.elements.add(total, kinds.quantise(likelihood))
    data = kinds.elements.encode(total)
    assert kinds.elements.encode(kinds.elements.decode(data)) == data


def evidence(*elements: Sparse, robot: int = 7, steps: int = 1) -> bytes:
    """What a robot tells that holds these elements, one after another, of the first steps."""
    encode = Likelihoods(TrackPacking(2, 4), 1.0, 1e4).elements.encode
    entries = b"".join(pack(k % steps, encode(element)) for k, element in enumerate(elements))
    return encode_steps(Payload(3, sections=[((robot, 3), Entries(0, len(elements), entries))]))


def of_first_entry(value: int) -> Sparse:
    """The first target's place along x, known so well."""
    return Sparse(np.array([0]), np.array([value]))


@pytest.mark.parametrize("way", ["replicated", "sums"])
def test_a_likelihood_below_zero_is_refused_and_changes_nothing(way: str) -> None:
    robot = fusion(way, moving(2), 1)
    robot.set_neighbours([7])
    for bad in (of_first_entry(-(1 << 40)), Sparse(np.array([1]), np.array([1 << 40]))):
        with pytest.raises(ValueError, match="not positive semidefinite"):
            robot.receive(7, evidence(bad), 0.0)
    robot.advance(3)
    assert (robot.estimate()[1].matrix == fusion_alone(way, 3).matrix).all()
    robot.receive(7, evidence(of_first_entry(1 << 40)), 0.0)
    assert robot.estimate()[1].matrix[0, 0, 0] > fusion_alone(way, 3).matrix[0, 0, 0]


def fusion_alone(way: str, step: int) -> Information:
    """The tracks of a robot that has heard nothing."""
    robot = fusion(way, moving(2), 0)
    robot.advance(step)
    return robot.estimate()[1]


def test_sums_that_run_over_leave_their_step_out_at_every_robot_and_in_any_order() -> None:
    elements = [of_first_entry(1 << 60)] * 9 + [of_first_entry(1 << 50)]
    tracks = []
    for order in (1, -1):
        robot = fusion("replicated", moving(2), 1)
        robot.set_neighbours([7])
        robot.receive(7, evidence(*elements[::order]), 0.0)
        robot.advance(2)
        tracks.append(robot.estimate()[1].matrix)
    assert (tracks[0] == tracks[1]).all()
    assert (tracks[0] == fusion_alone("replicated", 2).matrix).all()


EXTREME = {
    "vector": lambda y: replace(y, vector=y.vector + 1e300),
    "matrix": lambda y: replace(y, matrix=y.matrix * 1e300),
    "nothing": lambda y: replace(y, matrix=y.matrix * 1e-30),
    "negative": lambda y: replace(y, matrix=-y.matrix),
    "correlated": lambda y: replace(y, matrix=np.ones((2, 4, 4)) + 1e-15 * np.eye(4)),
    "fast": lambda y: replace(y, matrix=np.tile(np.diag([1e15, 1e15, 1e-17, 1e-17]), (2, 1, 1))),
}


@pytest.mark.parametrize("way", ["channel", "intersection"])
@pytest.mark.parametrize("kind", EXTREME)
def test_tracks_that_rounding_would_ruin_are_refused_and_change_nothing(way: str, kind: str) -> None:
    of = moving(2)
    robot = fusion(way, of, 1)
    robot.set_neighbours([0])
    nonce = 3 << 24 if way == "channel" else 3
    data = TrackPacking(2, 4).encode(EXTREME[kind](of.prior))
    for sent, step in enumerate((0, 5), start=1):
        with pytest.raises(ValueError, match="track payload"):
            robot.receive(0, encode_tracks(TrackMessage(nonce, -1, sent, 0, 0, step, data)), 0.0)
    robot.advance(9)
    assert (robot.estimate()[1].matrix == fusion_alone(way, 9).matrix).all()


@pytest.mark.parametrize("way", WAYS)
def test_a_prior_that_rounding_would_ruin_is_told(way: str) -> None:
    of = moving(2)
    with pytest.raises(InputError, match="choose another unit or prior"):
        fusion(way, replace(of, prior=EXTREME["nothing"](of.prior)), 0)


def test_generations_go_round_so_that_no_neighbour_can_use_them_up() -> None:
    of = moving(2)
    robots = [fusion("channel", of, i) for i in range(3)]
    robots[1].set_neighbours([0, 2])
    last = (1 << 24) - 1
    for generation in (last // 2, last - 1, last):
        robots[1].receive(0, encode_tracks(TrackMessage((3 << 24) + generation, -1, 0, 0, 0, 0, b"")), 0.0)
        assert generation_of(robots[1]) == generation
    robots[1].set_neighbours([2])
    robots[2].set_neighbours([1])
    assert generation_of(robots[1]) == 1
    robots[2].observe(0, of.look(np.zeros((2, 4)), np.random.default_rng(4)))
    for now in range(0, 12, 3):
        for a, b in ((1, 2), (2, 1)):
            payload = robots[a].outgoing(b, float(now))
            if payload is not None:
                robots[b].receive(a, payload, float(now))
    assert generation_of(robots[2]) == 1
    assert robots[1].digest == robots[2].digest
    robots[1].receive(2, encode_tracks(TrackMessage((3 << 24) + last, -1, 0, 0, 0, 0, b"")), 0.0)
    assert generation_of(robots[1]) == 1  # that was before


def generation_of(robot: TrackFusion) -> int:
    """The generation that a channel filter is in, from what it tells."""
    assert isinstance(robot, GaussianChannel)
    return robot.generation
