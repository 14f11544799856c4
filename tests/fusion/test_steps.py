"""Evidence in time steps: exact sums on bad links, any graph or any tree, and the filter on top."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.notaries import PlainNotary
from tests.support.step_network import StepNetwork, chain, random_tree, ring
from vedette.errors import InputError
from vedette.fusion.steps import (
    FixedPoint,
    Refilter,
    ReplicatedSteps,
    SignedSteps,
    Sparse,
    SparseIntegers,
    StepSums,
)

SIZE = 40
ELEMENTS = SparseIntegers(SIZE)
WINDOW = 1000  # no step is closed unless a test says so
Replicated = ReplicatedSteps[Sparse]
Sums = StepSums[Sparse]
Signed = SignedSteps[Sparse]
Evidence = Replicated | Signed | Sums


def replicated(robot: int, boot: int = 5) -> Replicated:
    return ReplicatedSteps(robot, boot, ELEMENTS)


def signed(robot: int, boot: int = 5) -> Signed:
    return SignedSteps(robot, boot, ELEMENTS, notary=PlainNotary(robot, lambda: 100.0))


def sums(robot: int, boot: int = 5, window: int = WINDOW) -> Sums:
    return StepSums(robot, boot, ELEMENTS, window=window)


class Truth:
    """Brute force: dense sums of everything that was published."""

    def __init__(self) -> None:
        self.sums: dict[int, np.ndarray] = {}

    def publish(self, robot: Evidence, step: int, rng: np.random.Generator) -> None:
        index = rng.permutation(SIZE)[: rng.integers(1, 8)]
        value = rng.integers(-(2**50), 2**50, len(index))
        robot.publish(step, ELEMENTS.of(index, value))
        self.sums.setdefault(step, np.zeros(SIZE, dtype=np.int64))[index] += value

    def matches(self, robot: Evidence) -> bool:
        return all((ELEMENTS.dense(robot.total(k)) == total).all() for k, total in self.sums.items())


vectors = st.lists(st.integers(-(2**50), 2**50), min_size=SIZE, max_size=SIZE).map(np.array)
sparse = st.dictionaries(st.integers(0, SIZE - 1), st.integers(-(2**50), 2**50)).map(
    lambda d: ELEMENTS.of(np.array(list(d), dtype=np.int64), np.array(list(d.values()), dtype=np.int64))
)


@given(sparse, sparse, sparse)
@settings(deadline=None, max_examples=60)
def test_elements_add_like_dense_vectors_and_survive_their_encoding(a: Sparse, b: Sparse, c: Sparse) -> None:
    dense, add = ELEMENTS.dense, ELEMENTS.add
    assert (dense(add(add(a, b), c)) == dense(a) + dense(b) + dense(c)).all()
    assert ELEMENTS.encode(add(add(a, b), c)) == ELEMENTS.encode(add(add(c, b), a))
    assert ELEMENTS.is_zero(ELEMENTS.subtract(add(a, b), add(b, a)))
    assert (dense(ELEMENTS.decode(ELEMENTS.encode(a))) == dense(a)).all()
    assert len(ELEMENTS.encode(a)) <= ELEMENTS.most_bytes


@given(sparse, st.lists(st.tuples(st.integers(0, 60), st.integers(0, 255)), max_size=3))
@settings(deadline=None, max_examples=200)
def test_any_bytes_decode_to_a_canonical_element_or_are_refused(
    told: Sparse, changes: list[tuple[int, int]]
) -> None:
    data = bytearray(ELEMENTS.encode(told))
    for at, byte in changes:
        data[at % len(data)] = byte
    try:
        element = ELEMENTS.decode(bytes(data))
    except ValueError:
        return
    assert (np.diff(element.index) > 0).all()
    assert (element.value != 0).all()
    assert (ELEMENTS.dense(ELEMENTS.decode(ELEMENTS.encode(element))) == ELEMENTS.dense(element)).all()


def test_fixed_point_is_off_by_half_a_unit_and_sums_of_it_do_not_depend_on_the_order() -> None:
    rng = np.random.default_rng(0)
    scale = FixedPoint.holding(1e4)
    numbers = rng.uniform(-1e4, 1e4, (30, 5))
    whole = scale.quantise(numbers)
    assert np.abs(scale.numbers(whole) - numbers).max() <= 1e4 * 2.0**-50
    assert (scale.numbers(whole.sum(axis=0)) == scale.numbers(whole[::-1].sum(axis=0))).all()
    with pytest.raises(InputError, match="exceeds the largest"):
        scale.quantise(np.array([2e5]))
    with pytest.raises(InputError, match="exceeds the largest"):
        scale.quantise(np.array([np.nan]))
    with pytest.raises(InputError, match="largest"):
        FixedPoint.holding(0.0)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("make", [replicated, signed, sums])
def test_on_trees_with_bad_links_totals_equal_brute_force(make: Callable[[int], Evidence], seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 8))
    net = StepNetwork(make, n, random_tree(n, rng), rng, loss=0.3, repeat=0.3, most_delay=3.0)
    truth = Truth()
    for step in range(20):
        for i in rng.permutation(n)[: rng.integers(0, n + 1)].tolist():
            truth.publish(net.robots[i], step - int(rng.integers(0, min(step, 3) + 1)), rng)
        net.run(1)
    net.run(60)
    assert all(truth.matches(robot) for robot in net.robots.values())
    assert len({robot.digest for robot in net.robots.values()}) == 1
    assert {robot.contributors() for robot in net.robots.values()} == {n}
    assert net.is_quiet()


def test_replicated_totals_are_exact_on_a_ring_that_splits_and_heals_around_a_death_and_a_restart() -> None:
    rng = np.random.default_rng(7)
    net = StepNetwork(replicated, 6, ring(6), rng, loss=0.2, repeat=0.2, most_delay=2.0)
    truth = Truth()
    for step in range(30):
        if step == 8:
            net.connect([(0, 1), (1, 2), (3, 4), (4, 5)])
        if step == 12:
            net.run(20)
            net.kill(1)
        if step == 16:
            net.robots[4] = replicated(4, boot=6)
            net.connect(net.edges)
        if step == 20:
            net.connect([*ring(6)[2:], (0, 2)])
        for i in net.robots:
            truth.publish(net.robots[i], step, rng)
        net.run(8 if step == 15 else 1)
    net.run(60)
    assert all(truth.matches(robot) for robot in net.robots.values())
    assert {robot.contributors() for robot in net.robots.values()} == {7}
    assert net.is_quiet()


@pytest.mark.parametrize("seed", range(4))
def test_sums_are_exact_again_after_any_changes_of_the_tree(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 6
    net = StepNetwork(sums, n, random_tree(n, rng), rng, loss=0.2, repeat=0.2, most_delay=2.0)
    truth = Truth()
    for step in range(40):
        if step % 7 == 6:
            forest = random_tree(n, rng)
            net.connect(forest[: int(rng.integers(1, n))])
        truth.publish(net.robots[int(rng.integers(n))], step, rng)
        net.run(1)
    order = rng.permutation(n).tolist()
    net.connect([(order[a], order[b]) for a, b in random_tree(n, rng)])
    net.run(60)
    assert all(truth.matches(robot) for robot in net.robots.values())
    assert {robot.contributors() for robot in net.robots.values()} == {n}
    assert net.is_quiet()


@pytest.mark.parametrize("make", [replicated, signed, sums])
def test_one_round_without_loss_gives_everybody_everything(make: Callable[[int], Evidence]) -> None:
    rng = np.random.default_rng(1)
    net = StepNetwork(make, 9, random_tree(9, rng), rng)
    net.meet()
    truth = Truth()
    for step in range(5):
        for robot in net.robots.values():
            truth.publish(robot, step, rng)
        net.round(root=4)
        assert all(truth.matches(robot) for robot in net.robots.values())
        assert len({robot.digest for robot in net.robots.values()}) == 1


def test_a_message_of_sums_is_as_long_for_many_robots_as_for_few() -> None:
    def longest(n: int) -> int:
        rng = np.random.default_rng(3)
        net = StepNetwork(sums, n, chain(n), rng)
        element = ELEMENTS.of(np.arange(SIZE), rng.integers(2**40, 2**41, SIZE))
        net.meet()
        net.sizes.clear()
        for step in range(3):
            for robot in net.robots.values():
                robot.publish(step, element)
            net.round()
        return max(net.sizes)

    sizes = [longest(n) for n in (4, 16, 64)]
    assert max(sizes) <= sizes[0] + 2 * SIZE  # a 64 times larger number takes one byte more, up and down


def test_evidence_of_closed_steps_stays_in_the_belief_and_later_news_of_them_is_ignored() -> None:
    rng = np.random.default_rng(2)
    net = StepNetwork(lambda i: sums(i, window=5), 3, chain(3), rng)
    filters = {i: counting(robot) for i, robot in net.robots.items()}
    net.meet()
    one = ELEMENTS.of(np.array([0]), np.array([1]))
    for step in range(40):
        for i, robot in net.robots.items():
            robot.publish(step, one)
            filters[i].at(step)
        net.round()
        assert {int(f.at(step)) for f in filters.values()} == {3 * (step + 1)}
    assert net.robots[0].open_from == 34
    assert len(net.robots[0].steps()) < 25
    net.robots[1].publish(3, one)
    net.round()
    assert {int(f.at(39)) for f in filters.values()} == {120}
    assert len({robot.digest for robot in net.robots.values()}) == 1


def test_a_dead_robots_evidence_stays_where_steps_were_closed_and_goes_where_they_were_open() -> None:
    rng = np.random.default_rng(2)
    net = StepNetwork(lambda i: sums(i, window=5), 4, chain(4), rng)
    net.meet()
    one = ELEMENTS.of(np.array([0]), np.array([1]))
    filters = {i: counting(robot) for i, robot in net.robots.items()}
    for step in range(30):
        for robot in net.robots.values():
            robot.publish(step, one)
        net.round()
        assert {int(f.at(step)) for f in filters.values()} == {4 * (step + 1)}
    net.kill(1)
    net.connect([(0, 2), (2, 3)])
    del filters[1]
    for _ in range(4):
        net.round()
    closed = net.robots[0].open_from
    assert closed == 24
    assert {int(f.at(29)) for f in filters.values()} == {3 * 30 + closed}


def test_changes_of_tree_lose_and_repeat_nothing_although_steps_get_closed() -> None:
    rng = np.random.default_rng(4)
    n = 6
    net = StepNetwork(lambda i: sums(i, window=6), n, random_tree(n, rng), rng)
    filters = {i: counting(robot) for i, robot in net.robots.items()}
    one = ELEMENTS.of(np.array([0]), np.array([1]))
    for step in range(80):
        if step % 11 == 5:
            order = rng.permutation(n).tolist()
            net.connect([(order[a], order[b]) for a, b in random_tree(n, rng)])
        for i, robot in net.robots.items():
            robot.publish(step, one)
            filters[i].at(step)
        net.round()
    assert min(robot.open_from for robot in net.robots.values()) > 60
    assert {int(f.at(79)) for f in filters.values()} == {80 * n}
    assert len({robot.digest for robot in net.robots.values()}) == 1


def counting(robot: Evidence) -> Refilter[int, Sparse]:
    """A belief that counts the first entry's evidence."""
    return Refilter(
        robot,
        0,
        0,
        predict=lambda belief, _: belief,
        update=lambda belief, _, total: belief + int(ELEMENTS.dense(total)[0]),
    )


@pytest.mark.parametrize("seed", range(3))
def test_refiltering_late_evidence_equals_filtering_in_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot, calls = replicated(0), 0
    truth: dict[int, int] = {}

    def predict(belief: int, step: int) -> int:
        nonlocal calls
        calls += 1
        return (3 * belief + step) % 1_000_003

    def update(belief: int, step: int, total: Sparse) -> int:
        return (belief + int(ELEMENTS.dense(total)[1]) * (step + 1)) % 1_000_003

    def expected(step: int) -> int:
        belief = 17
        for k in range(4, step + 1):
            belief = belief if k == 4 else (3 * belief + k - 1) % 1_000_003
            belief = (belief + truth.get(k, 0) * (k + 1)) % 1_000_003
        return belief

    tracked: Refilter[int, Sparse] = Refilter(robot, 17, 4, predict=predict, update=update)
    for now in range(4, 300):
        late = int(rng.choice([0, 0, 0, 1, 5, 40]))
        step, value = max(4, now - late), int(rng.integers(1, 100))
        robot.publish(step, ELEMENTS.of(np.array([1]), np.array([value])))
        truth[step] = truth.get(step, 0) + value
        calls = 0
        assert tracked.at(now) == expected(now)
        assert calls <= 1.125 * late + 10
    assert len(tracked._kept) <= 60
    with pytest.raises(ValueError, match="before 4"):
        tracked.at(3)


def test_two_hours_of_sixteen_robots_fit_in_50_megabytes() -> None:
    rng = np.random.default_rng(0)
    robots, steps = 16, 24  # of 7200 in two hours at 1 Hz
    elements = SparseIntegers(6 * 14)  # six targets, states of four
    holder: Replicated = ReplicatedSteps(0, 1, elements)
    others = [ReplicatedSteps(i, 1, elements) for i in range(1, robots)]
    seen = (np.arange(6)[:, None] * 10 + [0, 1, 4]).ravel(), (60 + 4 * np.arange(6)[:, None] + [0, 1]).ravel()
    index = np.concatenate(seen)
    holder.set_neighbours(range(1, robots))
    for other in others:
        other.set_neighbours([0])
    for step in range(steps):
        for robot in (holder, *others):
            robot.publish(step, elements.of(index, rng.integers(-(2**50), 2**50, len(index))))
        for _ in range(2):
            for i, other in enumerate(others, start=1):
                for sender, name, receiver, to in ((other, i, holder, 0), (holder, 0, other, i)):
                    payload = sender.outgoing(to, float(step))
                    if payload is not None:
                        receiver.receive(name, payload, float(step))
    copies = holder._contributors.copies
    logs = sum(len(log._data) + 8 * len(log._ends) for log in copies.values())
    totals = sum(200 + 16 * len(holder.total(step).index) for step in holder.steps())
    assert len(copies) == robots
    assert 7200 / steps * (logs + totals) < 50e6


@given(st.binary(max_size=80), st.integers(0, 1))
@settings(deadline=None, max_examples=100)
def test_malformed_payloads_raise_value_error_and_change_nothing(data: bytes, way: int) -> None:
    robot: Evidence = [replicated, sums][way](0)
    robot.set_neighbours([1])
    robot.publish(3, ELEMENTS.of(np.array([2]), np.array([5])))
    digest = robot.digest
    try:
        robot.receive(1, data, 0.0)
    except ValueError:
        assert robot.digest == digest


@pytest.mark.parametrize("make", [replicated, signed, sums])
def test_damaged_payloads_do_no_more_than_raise_value_error(make: Callable[[int], Evidence]) -> None:
    rng = np.random.default_rng(5)
    a, b = make(0), make(1)
    a.set_neighbours([1]), b.set_neighbours([0])
    truth = Truth()
    for now in range(40):
        truth.publish(a, now, rng)
        payload = a.outgoing(1, float(now))
        back = b.outgoing(0, float(now))
        if back is not None:
            a.receive(1, back, float(now))
        if payload is None:
            continue
        damaged = bytearray(payload)
        for _ in range(int(rng.integers(1, 4))):
            damaged[rng.integers(len(damaged))] ^= 1 << int(rng.integers(8))
        for bad in (bytes(damaged), payload[: int(rng.integers(len(payload)))]):
            victim = make(1)
            victim.set_neighbours([0])
            try:
                victim.receive(0, bad, float(now))
            except ValueError:
                assert victim.steps() == []
        b.receive(0, payload, float(now))
    assert truth.matches(a)
    assert b.steps()
