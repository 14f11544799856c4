"""Replicated evidence: any network that delivers now and then gives everybody the exact sum, once."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.fusion_network import (
    COUNTS,
    SHAPE,
    Network,
    expected_classes,
    random_tree,
    ring,
    sparse_evidence,
)
from vedette.fusion import FIRM, ReplicatedEvidence
from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.link import EvidenceLink, Greeting, Payload
from vedette.fusion.packing import CodePacking
from vedette.fusion.snapshots import Delta, Snapshot
from vedette.fusion.tiles import LEVELS, codes_of
from vedette.kernels.tiles import CELLS, SIDE, TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN

TILING = Tiling(*SHAPE)
CODEC = EvidenceCodec(TILING, COUNTS, CodePacking())


def robot(index: int, boot: int = 7, shape: tuple[int, int] = SHAPE) -> ReplicatedEvidence:
    return ReplicatedEvidence(index, boot + index, shape, COUNTS)


def full_exchange(a: ReplicatedEvidence, b: ReplicatedEvidence, names: tuple[int, int], now: float) -> None:
    """Link two robots and let them talk until both are silent."""
    a.set_neighbours([names[1]])
    b.set_neighbours([names[0]])
    for step in range(6):
        for sender, receiver, name, to in ((a, b, *names), (b, a, *names[::-1])):
            payload = sender.outgoing(to, now + step)
            if payload is not None:
                receiver.receive(name, payload, now + step)


def assert_all_agree(net: Network) -> None:
    expected = expected_classes(net.own.values())
    counts = sum(net.counts.values())
    for fusion in net.robots.values():
        np.testing.assert_array_equal(fusion.classes.window(), expected)
        np.testing.assert_array_equal(fusion.counts, counts)
        outside = expected.copy()
        outside[fusion.known] = UNKNOWN
        assert not outside.any()  # all that is known lies where it is said to lie
    assert len({fusion.digest for fusion in net.robots.values()}) == 1


def explore(net: Network, rng: np.random.Generator, seconds: int) -> None:
    for _ in range(seconds):
        for i in net.robots:
            if rng.random() < 0.6:
                counts = rng.integers(0, 1000, COUNTS) if rng.random() < 0.3 else None
                own = np.where(rng.random(SHAPE) < 0.7, net.own[i], sparse_evidence(rng)).astype(np.int8)
                net.observe(i, own, counts)
        net.run(1)


@settings(deadline=None, max_examples=12)
@example(seed=298598, n=3, tree=False)  # one comes to hold another's evidence by the third alone
@given(seed=st.integers(0, 10**6), n=st.integers(2, 5), tree=st.booleans())
def test_lossy_repeating_reordering_links_give_everybody_the_brute_force_sum(
    seed: int, n: int, tree: bool
) -> None:
    rng = np.random.default_rng(seed)
    edges = random_tree(n, rng) if tree else ring(n)
    net = Network(robot, n, edges, rng, loss=0.3, repeat=0.3, most_delay=3.0)
    explore(net, rng, 6)
    net.run(60)
    assert_all_agree(net)
    assert net.is_quiet()


def test_a_ring_counts_everybody_once_and_falls_silent() -> None:
    rng = np.random.default_rng(1)
    net = Network(robot, 5, ring(5), rng)
    explore(net, rng, 8)
    net.run(8)
    assert_all_agree(net)
    assert net.is_quiet()
    assert all(fusion.contributors() == 5 for fusion in net.robots.values())


def test_a_partition_that_heals_loses_nothing() -> None:
    rng = np.random.default_rng(2)
    net = Network(robot, 4, [(0, 1), (2, 3)], rng)
    explore(net, rng, 5)
    net.connect([(0, 1), (1, 2), (2, 3)])
    explore(net, rng, 3)
    net.run(8)
    assert_all_agree(net)


def test_a_dead_robots_evidence_lives_on_in_any_tree_and_its_next_start_gets_it_back() -> None:
    rng = np.random.default_rng(3)
    net = Network(robot, 4, [(0, 1), (1, 2), (2, 3)], rng)
    explore(net, rng, 5)
    net.run(8)
    del net.robots[1]
    net.connect([(0, 3), (3, 2)])
    explore(net, rng, 3)
    net.run(8)
    assert_all_agree(net)
    net.robots[1] = robot(1, boot=99)
    net.connect([(0, 3), (3, 2), (2, 1)])
    net.run(8)
    assert_all_agree(net)


@settings(deadline=None, max_examples=25)
@given(data=st.data())
def test_any_order_with_repeats_of_the_same_payloads_gives_the_same_map(data: st.DataObject) -> None:
    rng = np.random.default_rng(data.draw(st.integers(0, 10**6)))
    writers = [Snapshot(TILING, COUNTS, np.uint8) for _ in range(3)]
    payloads, latest = [], {}
    everywhere = np.arange(TILING.count)
    for step in range(8):
        who = step % 3
        latest[who] = sparse_evidence(rng)
        writers[who].write(everywhere, codes_of(TiledGrid.of(latest[who]).read(everywhere)))
        base = int(rng.integers(0, writers[who].version))
        payloads.append(Payload(who, sections=[((who, who), writers[who].since(base))]))
    stream = [CODEC.encode(payload) for payload in payloads]
    # A difference that does not connect yet is dropped, so each order is played until all have connected.
    order = data.draw(st.lists(st.integers(0, 7), max_size=12)) + data.draw(st.permutations(range(8))) * 8
    reader = robot(9)
    for index in order:
        reader.receive(0, stream[index], 0.0)
    np.testing.assert_array_equal(reader.classes.window(), expected_classes(latest.values()))


def test_a_neighbour_that_has_joined_again_is_sent_only_what_it_lacks() -> None:
    rng = np.random.default_rng(4)
    a, b = robot(0), robot(1)
    own = sparse_evidence(rng)
    a.publish(TiledGrid.of(own), None, None)
    full_exchange(a, b, (0, 1), 0.0)
    a.set_neighbours([])
    b.set_neighbours([])
    own = own.copy()
    own[0, 0] = 9 if own[0, 0] <= 0 else -9
    a.publish(TiledGrid.of(own), np.array([0]), None)
    a.set_neighbours([1])
    b.set_neighbours([0])
    a.receive(1, b.outgoing(0, 100.0) or b"", 100.0)
    payload = CODEC.decode(a.outgoing(1, 100.0) or b"")
    assert [int(delta.mask.sum()) for _, delta in payload.sections] == [1]


def test_what_a_neighbour_told_is_not_told_back() -> None:
    a, b = robot(0), robot(1)
    full_exchange(a, b, (0, 1), 0.0)
    a.publish(TiledGrid.of(sparse_evidence(np.random.default_rng(5))), None, None)
    b.receive(0, a.outgoing(1, 10.0) or b"", 10.0)
    answer = b.outgoing(0, 10.0)
    assert answer is not None
    assert len(answer) < 10
    assert not CODEC.decode(answer).sections
    a.receive(1, answer, 10.0)
    assert a.outgoing(1, 10.0) is None
    assert b.outgoing(0, 10.0) is None


def test_what_a_neighbour_relayed_is_not_sent_back_to_it() -> None:
    rng = np.random.default_rng(6)
    net = Network(robot, 3, [(0, 1), (1, 2)], rng)
    net.run(3)
    net.observe(0, sparse_evidence(rng))
    net.run(1)
    relayed = net.robots[1].outgoing(2, net.now) or b""
    assert len(CODEC.decode(relayed).sections) == 1
    net.robots[2].receive(1, relayed, net.now)
    assert not CODEC.decode(net.robots[2].outgoing(1, net.now) or b"").sections


def test_a_payload_of_a_neighbours_earlier_start_come_late_does_not_hide_what_the_new_start_lacks() -> None:
    a, old, new = robot(0), robot(1), robot(1, boot=50)
    a.publish(TiledGrid.of(sparse_evidence(np.random.default_rng(7))), None, None)
    full_exchange(a, old, (0, 1), 0.0)
    a.set_neighbours([])
    a.set_neighbours([1])
    old.set_neighbours([])
    old.set_neighbours([0])
    late = old.outgoing(0, 20.0) or b""  # tells that the old start holds everything
    new.set_neighbours([0])
    a.receive(1, new.outgoing(0, 20.0) or b"", 20.0)
    a.receive(1, late, 20.1)
    new.receive(0, a.outgoing(1, 21.0) or b"", 21.0)
    assert new.digest == a.digest


def test_a_greeting_is_repeated_until_it_is_answered() -> None:
    link: EvidenceLink[Delta[np.uint8]] = EvidenceLink(0, 5, resend_after=2.0)
    assert link.greeting(0.0) == Greeting(-1, True)
    assert link.greeting(1.0) is None
    link.hear(Payload(9, Greeting(-1, False)), 1.5)  # theirs, not an answer
    assert link.greeting(2.0) == Greeting(9, True)
    link.hear(Payload(9, Greeting(5, True)), 2.5)
    assert link.greeting(5.0) == Greeting(9, False)
    assert link.greeting(9.0) is None


def test_differences_stay_right_after_65535_versions() -> None:
    writer, reader = (Snapshot(Tiling(SIDE, SIDE), 0, np.uint8) for _ in range(2))
    tile = np.array([0])
    block = np.zeros((1, CELLS), dtype=np.uint8)
    block[0, 0] = 1
    writer.write(tile, block)
    reader.apply(writer.since(0))
    idle = np.zeros((0, CELLS), np.bool_), np.zeros(0, np.uint8)
    for snapshot in (writer, reader):
        snapshot.apply(Delta(1, 70_000, tile[:0], *idle))
    for cell in (1, 2):
        block[0, cell] = 2
        writer.write(tile, block)
        reader.apply(writer.since(reader.version))
        np.testing.assert_array_equal(reader.values.read(tile), block)
    assert writer.since(0).mask.sum() == 3
    assert writer.since(70_001).mask.sum() <= 2


def test_more_than_a_payload_takes_goes_in_several() -> None:
    shape = (1600, 1600)
    a, b = robot(0, shape=shape), robot(1, shape=shape)
    free = np.full(shape, -9, dtype=np.int8)
    a.publish(TiledGrid.of(free), None, None)
    b.publish(TiledGrid.of(free), None, None)
    full_exchange(a, b, (0, 1), 0.0)
    c = robot(2, shape=shape)
    full_exchange(a, c, (0, 2), 10.0)
    assert c.contributors() == 2
    assert c.digest == a.digest


@pytest.mark.parametrize("boot", [-1, 2**38])
def test_a_boot_that_does_not_fit_is_refused(boot: int) -> None:
    with pytest.raises(ValueError, match="boot must lie in"):
        ReplicatedEvidence(0, boot, SHAPE, COUNTS)


def test_cells_outside_the_map_are_refused() -> None:
    mask = ~TILING.inside(np.array([TILING.count - 1]))
    delta = Delta(0, 1, np.array([TILING.count - 1]), mask, np.ones(int(mask.sum()), np.uint8))
    with pytest.raises(ValueError, match="outside the map"):
        robot(0).receive(1, CODEC.encode(Payload(3, sections=[((5, 5), delta)])), 0.0)


def test_only_tiles_with_a_changed_class_are_shared_and_levels_are_firm_from_six() -> None:
    own = np.zeros(SHAPE, dtype=np.int8)
    own[0, 0], own[40, 40] = FIRM, -1
    a = robot(0)
    assert a.publish(TiledGrid.of(own), np.array([0, 40 * SHAPE[1] + 40]), None).tolist() == [0, 4]
    own[40, 41] = -1
    assert a.publish(TiledGrid.of(own), np.array([], dtype=np.int64), None).tolist() == []
    assert a.classes.window()[40, 41] == UNKNOWN
    assert a.publish(TiledGrid.of(own), None, None).tolist() == [4]
    classes = a.classes.window()
    assert (classes[0, 0], classes[40, 40], classes[40, 41]) == (OCCUPIED, FREE, FREE)
    np.testing.assert_array_equal(
        LEVELS[codes_of(np.array([-128, -6, -5, -1, 0, 1, 5, 6, 127], dtype=np.int8))],
        [-2, -2, -1, -1, 0, 1, 1, 2, 2],
    )


def test_a_tie_between_robots_is_occupied() -> None:
    a, b = robot(0), robot(1)
    own = np.zeros(SHAPE, dtype=np.int8)
    own[3, 3] = 8
    a.publish(TiledGrid.of(own), None, None)
    b.publish(TiledGrid.of(-own), None, None)
    full_exchange(a, b, (0, 1), 0.0)
    assert a.classes.window()[3, 3] == b.classes.window()[3, 3] == OCCUPIED


def test_digests_are_equal_iff_maps_and_counts_are() -> None:
    own = np.zeros(SHAPE, dtype=np.int8)
    a, b = robot(0), robot(1)
    assert a.digest == b.digest
    own[3, 3] = 1
    a.publish(TiledGrid.of(own), None, None)
    assert a.digest != b.digest
    own[3, 3] = 9  # firm where a's is weak: the same class
    b.publish(TiledGrid.of(own), None, None)
    assert a.digest == b.digest
    a.publish(TiledGrid.of(own), None, np.array([0, 0, 5]))
    assert a.digest != b.digest
    b.publish(TiledGrid.of(own), None, np.array([0, 5, 0]))
    assert a.digest != b.digest
    b.publish(TiledGrid.of(own), None, np.array([0, 0, 5]))
    assert a.digest == b.digest
    moved = np.roll(own, 32, axis=1)
    c = robot(2)
    c.publish(TiledGrid.of(moved), None, np.array([0, 0, 5]))
    assert c.digest != a.digest


@st.composite
def payloads(draw: st.DrawFn) -> Payload[Delta[np.uint8]]:
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    numbers = st.integers(0, 2**40)
    sections = []
    for key in draw(st.sets(st.tuples(st.integers(0, 200), numbers), max_size=3)):
        tiles = np.flatnonzero(rng.random(TILING.count) < 0.5)
        mask = (rng.random((len(tiles), CELLS)) < draw(st.floats(0, 1))) & TILING.inside(tiles)
        values = rng.integers(0, 5, int(mask.sum())).astype(np.uint8)
        counts = rng.integers(-(2**50), 2**50, COUNTS) if draw(st.booleans()) else None
        base = draw(numbers)
        sections.append((key, Delta(base, base + draw(st.integers(1, 99)), tiles, mask, values, counts)))
    have = draw(st.dictionaries(st.tuples(numbers, numbers), numbers, max_size=4))
    greeting = draw(st.none() | st.builds(Greeting, st.integers(-1, 2**40), st.booleans()))
    return Payload(draw(numbers), greeting, have, sections)


@settings(deadline=None, max_examples=60)
@given(payload=payloads())
def test_decoding_undoes_encoding(payload: Payload[Delta[np.uint8]]) -> None:
    back = CODEC.decode(CODEC.encode(payload))
    assert (back.nonce, back.greeting, back.have) == (payload.nonce, payload.greeting, payload.have)
    assert [key for key, _ in back.sections] == [key for key, _ in payload.sections]
    for (_, got), (_, sent) in zip(back.sections, payload.sections, strict=True):
        assert (got.base, got.version) == (sent.base, sent.version)
        for name in ("tiles", "mask", "values"):
            np.testing.assert_array_equal(getattr(got, name), getattr(sent, name))
        assert (got.counts is None) == (sent.counts is None)
        if got.counts is not None and sent.counts is not None:
            np.testing.assert_array_equal(got.counts, sent.counts)


@settings(deadline=None, max_examples=150)
@given(payload=payloads(), data=st.data())
def test_damaged_payloads_raise_value_error_or_decode_to_something_valid(
    payload: Payload[Delta[np.uint8]], data: st.DataObject
) -> None:
    good = CODEC.encode(payload)
    cut = data.draw(st.integers(0, len(good) - 1))
    with pytest.raises(ValueError, match="fusion payload"):
        CODEC.decode(good[:cut])
    flipped = bytearray(good)
    flipped[cut] ^= data.draw(st.integers(1, 255))
    for bad in (
        bytes(flipped),
        data.draw(st.binary(max_size=80)),
        b"\x41" + data.draw(st.binary(max_size=80)),
    ):
        fusion = robot(0)
        try:
            fusion.receive(1, bad, 0.0)
        except ValueError:
            assert fusion.digest == robot(0).digest


def forged(version: int) -> bytes:
    """All occupied, in the name of robot 0."""
    tiles = np.arange(TILING.count)
    mask = TILING.inside(tiles)
    delta = Delta(0, version, tiles, mask, np.full(mask.sum(), 4, dtype=np.uint8), np.full(COUNTS, 9))
    return CODEC.encode(Payload(3, sections=[((0, 7), delta)]))


@pytest.mark.parametrize("version", [30, 70_000, 1 << 32, 1 << 62])
def test_evidence_forged_in_a_robots_name_is_overtaken_by_its_own_everywhere(version: int) -> None:
    rng = np.random.default_rng(3)
    net = Network(robot, 4, [(0, 1), (1, 2), (2, 3)], rng)
    explore(net, rng, 6)
    net.run(10)
    for again in (0, 50):  # while they go on, and where the forger has had the last word
        net.robots[2].receive(3, forged(version + again), net.now)
        explore(net, rng, 6)
        net.run(30)
        assert_all_agree(net)


def test_versions_from_which_a_contributor_could_not_go_on_are_refused() -> None:
    fusion = robot(1)
    for version in ((1 << 62) + (1 << 33), (1 << 63) - 1):
        with pytest.raises(ValueError, match="far beyond"):
            fusion.receive(2, forged(version), 0.0)
    assert fusion.contributors() == 0


def test_two_sections_of_one_contributor_are_refused() -> None:
    delta = Delta(0, 1, np.array([0]), np.zeros((1, CELLS), np.bool_), np.zeros(0, np.uint8))
    twice = CODEC.encode(Payload(3, sections=[((2, 4), delta)] * 2))
    with pytest.raises(ValueError, match="two sections of one stream"):
        robot(0).receive(1, twice, 0.0)


def test_more_tiles_than_a_payload_may_hold_are_refused() -> None:
    tiles = np.arange(TILING.count)
    delta = Delta(0, 1, tiles, np.zeros((len(tiles), CELLS), np.bool_), np.zeros(0, np.uint8))
    with pytest.raises(ValueError, match="more than fit"):
        CODEC.decode(CODEC.encode(Payload(0, sections=[((i, 0), delta) for i in range(500)])))


def test_a_deflate_bomb_is_refused() -> None:
    huge = EvidenceCodec(Tiling(4000, 4000), COUNTS, CodePacking())
    tiles = np.arange(huge.tiling.count)
    delta = Delta(0, 1, tiles, np.ones((len(tiles), CELLS), np.bool_), np.zeros(len(tiles) * CELLS, np.uint8))
    with pytest.raises(ValueError, match="fusion payload"):
        CODEC.decode(huge.encode(Payload(0, sections=[((0, 0), delta)])))


def moving_disc(own: NDArray[np.int8], step: int) -> NDArray[np.int8]:
    """Add a free disc of 8 m at 0.1 m, 0.5 m further each step, inside an occupied circle."""
    y, x = np.ogrid[:200, :400]
    distance = np.hypot(y - 100, x - 100 - 5 * step)
    after = own.copy()
    window = after[1900:2100, 1800:2200]
    window[:] = np.where(distance < 78, -9, np.where(distance < 80, 9, window))
    return after


def test_a_second_of_exploring_costs_under_a_kilobyte_and_few_milliseconds_on_a_huge_map() -> None:
    shape = (4000, 4000)
    a, b = robot(0, shape=shape), robot(1, shape=shape)
    own = moving_disc(np.zeros(shape, dtype=np.int8), 0)
    a.publish(TiledGrid.of(own), np.flatnonzero(own), None)
    full_exchange(a, b, (0, 1), 0.0)
    sizes, times = [], []
    for step in range(1, 6):
        after = moving_disc(own, step)
        changed = np.flatnonzero(np.sign(after) != np.sign(own))
        own, tiles = after, TiledGrid.of(after)
        start = time.perf_counter()
        a.publish(tiles, changed, None)
        payload = a.outgoing(1, 100.0 + step)
        assert payload is not None
        b.receive(0, payload, 100.0 + step)
        times.append(time.perf_counter() - start)
        sizes.append(len(payload))
        a.receive(1, b.outgoing(0, 100.0 + step) or b"", 100.0 + step)
    assert np.array_equal(a.classes.window(), b.classes.window())
    assert max(sizes) < 1000
    assert min(times) < 0.02  # far above what it takes, far below anything O(map)
