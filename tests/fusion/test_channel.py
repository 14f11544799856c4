"""The channel filter: exact on a tree, over bad links and through changes of the tree; wrong on a ring."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.fusion_network import (
    COUNTS,
    SHAPE,
    Edges,
    Network,
    expected_classes,
    random_tree,
    ring,
    sparse_evidence,
)
from vedette.fusion import ChannelFilter
from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.link import Payload
from vedette.fusion.packing import WordPacking, join_word, split_word
from vedette.fusion.snapshots import Delta
from vedette.fusion.tiles import (
    LEVELS,
    MOST_ROBOTS,
    WORDS,
    classes_of,
    code_of_sums,
    contributors_of,
    saturated,
    sums_of,
)
from vedette.kernels.tiles import CELLS, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN

TILING = Tiling(*SHAPE)
CODEC = EvidenceCodec(TILING, COUNTS + 1, WordPacking())


def robot(index: int, boot: int = 7) -> ChannelFilter:
    return ChannelFilter(index, boot + index, SHAPE, COUNTS)


def assert_exact(net: Network, robots: int) -> None:
    """Living evidence decides wherever there is any; only elsewhere may inherited evidence show."""
    live = expected_classes(net.own[i] for i in net.robots)
    counts = sum(net.counts[i] for i in net.robots)
    for fusion in net.robots.values():
        np.testing.assert_array_equal(fusion.classes.window()[live != UNKNOWN], live[live != UNKNOWN])
        np.testing.assert_array_equal(fusion.counts, counts)
        assert fusion.contributors() == robots
    assert len({fusion.digest for fusion in net.robots.values()}) == 1


def explore(net: Network, rng: np.random.Generator, seconds: int) -> None:
    for _ in range(seconds):
        for i in net.robots:
            counts = rng.integers(0, 1000, COUNTS) if rng.random() < 0.3 else None
            own = np.where(rng.random(SHAPE) < 0.7, net.own[i], sparse_evidence(rng)).astype(np.int8)
            net.observe(i, own, counts)
        net.run(1)


@settings(deadline=None, max_examples=12)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 6))
def test_on_random_trees_with_bad_links_everybody_gets_the_brute_force_sum(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    net = Network(robot, n, random_tree(n, rng), rng, loss=0.3, repeat=0.3, most_delay=3.0)
    explore(net, rng, 4)
    net.run(80)
    assert_exact(net, n)
    np.testing.assert_array_equal(net.robots[0].classes.window(), expected_classes(net.own.values()))
    assert net.is_quiet()


@settings(deadline=None, max_examples=12)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 6))
def test_after_any_changes_of_the_tree_nobody_counts_twice(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    net = Network(robot, n, random_tree(n, rng), rng, loss=0.2, repeat=0.2, most_delay=3.0)
    for _ in range(3):
        explore(net, rng, 3)
        net.connect(random_tree(n, rng))
    net.run(80)
    assert_exact(net, n)
    assert net.is_quiet()


def test_a_link_dropped_and_taken_up_at_one_end_only_recovers() -> None:
    rng = np.random.default_rng(1)
    net = Network(robot, 3, [(0, 1), (1, 2)], rng)
    explore(net, rng, 3)
    net.run(5)
    net.robots[1].set_neighbours([0])
    net.robots[1].set_neighbours([0, 2])
    net.run(15)
    assert_exact(net, 3)


def test_payloads_from_before_a_link_was_taken_up_again_or_from_an_earlier_start_are_ignored() -> None:
    rng = np.random.default_rng(6)
    net = Network(robot, 2, [(0, 1)], rng)
    net.run(3)
    net.observe(0, sparse_evidence(rng), np.array([1, 2, 3]))
    earlier_session = net.robots[0].outgoing(1, net.now) or b""
    net.robots[0].set_neighbours([])
    net.robots[0].set_neighbours([1])
    net.observe(0, sparse_evidence(rng), np.array([7, 8, 9]))
    net.run(5)
    assert_exact(net, 1)
    net.robots[1].receive(0, earlier_session, net.now)
    assert_exact(net, 1)

    dead = net.robots[0]
    net.robots[0] = robot(0, boot=50)
    net.connect(net.edges)
    net.observe(0, sparse_evidence(rng), np.array([4, 5, 6]))
    net.run(6)
    assert_exact(net, 1)
    dead.set_neighbours([])
    dead.set_neighbours([1])
    net.robots[1].receive(0, dead.outgoing(1, net.now) or b"", net.now)
    assert_exact(net, 1)


def test_a_dead_robots_evidence_survives_where_nobody_else_has_any() -> None:
    rng = np.random.default_rng(2)
    net = Network(robot, 4, [(0, 1), (1, 2), (1, 3)], rng)
    alone = np.zeros(SHAPE, dtype=np.int8)
    alone[5, 5:9] = [9, -9, 9, -9]
    net.observe(1, alone)
    net.run(6)
    dead = net.own[1]
    del net.robots[1]
    net.connect([(0, 2), (2, 3)])
    contradicted = np.zeros(SHAPE, dtype=np.int8)
    contradicted[5, 7:9] = [-1, 1]  # weaker than the dead robot's, but of the living
    net.observe(3, contradicted)
    net.run(10)
    expected = expected_classes([np.where(contradicted != 0, contradicted, dead)])
    for fusion in net.robots.values():
        np.testing.assert_array_equal(fusion.classes.window(), expected)
        assert fusion.contributors() == 1
    assert net.is_quiet()


def test_a_robot_that_starts_again_counts_once_and_gets_its_old_map_back() -> None:
    rng = np.random.default_rng(3)
    net = Network(robot, 3, [(0, 1), (1, 2)], rng)
    explore(net, rng, 3)
    net.run(6)
    known = net.robots[0].classes.window() != UNKNOWN
    net.robots[2] = robot(2, boot=50)
    net.own[2] = np.zeros(SHAPE, dtype=np.int8)
    net.counts[2] = np.zeros(COUNTS, dtype=np.int64)
    net.connect(net.edges)
    net.observe(2, sparse_evidence(rng))
    net.run(15)
    live = expected_classes(net.own.values())
    for fusion in net.robots.values():
        np.testing.assert_array_equal(fusion.classes.window()[live != UNKNOWN], live[live != UNKNOWN])
        assert (fusion.classes.window()[known] != UNKNOWN).all()
    assert len({fusion.digest for fusion in net.robots.values()}) == 1


def test_on_a_ring_one_sighting_is_counted_again_and_again_for_ever() -> None:
    """Shows why the channel filter needs a tree; replicated evidence does not."""
    counted: dict[str, list[int]] = {}
    tree: Edges = [(0, 1), (1, 2), (2, 3)]
    for name, edges in (("tree", tree), ("ring", ring(4))):
        net = Network(robot, 4, edges, np.random.default_rng(4))
        net.run(2)
        net.observe(0, sparse_evidence(np.random.default_rng(4)))
        counted[name] = []
        for _ in range(3):
            net.run(10)
            counted[name].append(net.robots[2].contributors())
        assert net.is_quiet() == (name == "tree")
    assert counted["tree"] == [1, 1, 1]
    assert 1 < counted["ring"][0] < counted["ring"][1] < counted["ring"][2]


def test_packed_sums_add_up_as_levels_do() -> None:
    rng = np.random.default_rng(5)
    codes = rng.integers(0, 5, (40, 500))
    words = WORDS[codes].sum(axis=0).astype(np.int32)
    levels = LEVELS[codes]
    np.testing.assert_array_equal(sums_of(words), levels.sum(axis=0))
    np.testing.assert_array_equal(contributors_of(words), (levels != 0).sum(axis=0))
    np.testing.assert_array_equal(classes_of(WORDS), [UNKNOWN, FREE, OCCUPIED, FREE, OCCUPIED])
    np.testing.assert_array_equal(code_of_sums(WORDS), np.arange(5))
    over = saturated(WORDS[1:] * np.int32(3000))
    np.testing.assert_array_equal(contributors_of(over), MOST_ROBOTS)
    np.testing.assert_array_equal(np.sign(sums_of(over)), np.sign(LEVELS[1:]))
    assert saturated(words) is words


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10**6), robots=st.integers(1, 50))
def test_sums_survive_encoding(seed: int, robots: int) -> None:
    rng = np.random.default_rng(seed)
    tiles = np.flatnonzero(rng.random(TILING.count) < 0.7)
    mask = (rng.random((len(tiles), CELLS)) < rng.random()) & TILING.inside(tiles)
    size = int(mask.sum())
    live = WORDS[rng.integers(0, 5, (robots, size))].sum(axis=0).astype(np.int32)
    code = rng.integers(0, 5, size).astype(np.uint8)
    sent = Delta(3, 9, tiles, mask, join_word(code, live), rng.integers(0, 10**6, COUNTS + 1))
    ((key, got),) = CODEC.decode(CODEC.encode(Payload(4, sections=[((1, 4), sent)]))).sections
    assert key == (1, 4)
    np.testing.assert_array_equal(got.mask, mask)
    np.testing.assert_array_equal(split_word(got.values)[0], code)
    np.testing.assert_array_equal(split_word(got.values)[1], live)


@settings(deadline=None, max_examples=100)
@given(seed=st.integers(0, 10**6), data=st.data())
def test_damaged_payloads_raise_value_error_or_are_harmless(seed: int, data: st.DataObject) -> None:
    rng = np.random.default_rng(seed)
    tiles = np.array([0, 4])
    mask = (rng.random((2, CELLS)) < 0.1) & TILING.inside(tiles)
    words = rng.integers(-(2**31), 2**31, int(mask.sum())).astype(np.int32)
    wild = CODEC.encode(Payload(1, sections=[((1, 1), Delta(0, 2, tiles, mask, words))]))
    with pytest.raises(ValueError, match="out of range"):
        robot(0).receive(1, wild, 0.0)
    words = WORDS[rng.integers(0, 5, int(mask.sum()))]
    good = bytearray(CODEC.encode(Payload(1, sections=[((1, 1), Delta(0, 2, tiles, mask, words))])))
    cut = data.draw(st.integers(0, len(good) - 1))
    with pytest.raises(ValueError, match="fusion payload"):
        CODEC.decode(bytes(good[:cut]))
    good[cut] ^= data.draw(st.integers(1, 255))
    fusion = robot(0)
    fusion.set_neighbours([1])
    for bad in (bytes(good), data.draw(st.binary(max_size=80))):
        with contextlib.suppress(ValueError):
            fusion.receive(1, bad, 0.0)


def test_a_section_that_is_not_the_neighbours_own_is_refused() -> None:
    delta = Delta(0, 1, np.array([0]), np.zeros((1, CELLS), np.bool_), np.zeros(0, np.int32))
    fusion = robot(0)
    fusion.set_neighbours([1])
    with pytest.raises(ValueError, match="not the neighbour's own"):
        fusion.receive(1, CODEC.encode(Payload(4, sections=[((2, 4), delta)])), 0.0)
