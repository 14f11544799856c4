"""The overlay case by case: joining, losing, healing, links of every quality, clocks, and lies."""

from __future__ import annotations

import dataclasses

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.overlay_network import DRIFT, Faults, Network, random_graph
from vedette.overlay import Overlay, Place, Stamp
from vedette.overlay import hello as wire
from vedette.overlay.stamp import HALF, STEP

CHAIN = [(0, 1), (1, 2), (2, 3)]
LEASE = 3.0


def whole(n: int, edges: list[tuple[int, int]], seed: int = 0, **options: bool | float) -> Network:
    """A network that has formed its trees."""
    net = Network(n, edges, seed, **options)  # type: ignore[arg-type]
    net.run_until_whole(5.0)
    net.run(3.0)
    return net


def without_size(net: Network) -> dict[int, Place]:
    return {i: dataclasses.replace(place, size=0) for i, place in net.places().items()}


def root(net: Network) -> int:
    return next(i for i, place in net.places().items() if place.parent is None)


@pytest.mark.parametrize("seed", range(20))
def test_a_random_graph_becomes_one_shallow_tree_within_a_second(seed: int) -> None:
    rng = np.random.default_rng(seed)
    net = Network(12, random_graph(12, rng, 1.0), seed)
    assert net.run_until_whole(5.0) < 1.0
    hops = {root(net): 0}
    for distance in range(1, 12):
        for i in [i for i, hop in hops.items() if hop == distance - 1]:
            hops |= {k: distance for k in net.near[i] if k not in hops}
    for i, node in net.nodes.items():
        assert node.overlay.status(net.now).distance <= hops[i] + 1


def test_a_robot_joins_as_a_leaf_without_a_new_epoch_and_others_see_only_the_size() -> None:
    net = whole(5, [*CHAIN, (1, 4)])
    net.crash(4)
    net.run(LEASE + 2.0)
    before = without_size(net)
    net.restart(4, boot=77)
    net.run_until_whole(5.0)
    after = without_size(net)
    assert after[4].parent == 1
    assert after.pop(4).epoch == after[1].epoch
    assert after.pop(1).neighbours == (*before.pop(1).neighbours, 4)
    assert after == before
    assert {place.size for place in net.places().values()} == {5}


def test_a_new_robot_with_the_highest_number_joins_a_team_as_a_leaf_too() -> None:
    net = Network(5, [*CHAIN, (0, 4)], 0)
    net.nodes[4].alive = False
    net.run(5.0)
    before = without_size(net)
    net.restart(4, boot=5)
    net.run_until_whole(5.0)
    assert net.places()[4].epoch == before[3].epoch
    assert without_size(net)[3] == before[3]


@pytest.mark.parametrize("seed", range(10))
def test_a_silent_cut_is_noticed_within_the_lease_and_both_parts_go_on(seed: int) -> None:
    net = whole(6, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)], seed)
    epochs = {place.epoch for place in net.places().values()}
    net.partition({0, 1, 2})
    assert net.run_until_whole(LEASE + 1.0) <= LEASE + 1.0
    parts = [{place.epoch for i, place in net.places().items() if (i < 3) == low} for low in (True, False)]
    assert all(len(part) == 1 for part in parts)
    assert len(parts[0] | parts[1] | epochs) == 3


def test_one_direction_cut_is_as_good_as_both() -> None:
    net = whole(4, CHAIN)
    net.cut.add((1, 2))
    net.run(LEASE + 1.0)
    assert net.places()[1].neighbours == (0,)
    assert net.places()[2].neighbours == (3,)


def test_a_crash_that_the_transport_reports_is_repaired_and_counted_within_half_a_second() -> None:
    net = whole(6, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)], notice=True)
    net.crash(3)
    assert net.run_until_whole(2.0) < 0.5


def role_of(net: Network, robot: int, mate: int) -> str:
    node = net.nodes[robot]
    return {link.robot: link.role for link in node.overlay.status(node.clock(net.now)).links}[mate]


def test_a_goodbye_is_believed_at_once() -> None:
    net = whole(4, CHAIN)
    net.leave(3)
    assert net.run_until_whole(2.0) < 0.5
    assert {place.size for place in net.places().values()} == {3}
    net.crash(0)
    net.run(2 * LEASE)
    assert (role_of(net, 2, 3), role_of(net, 1, 0)) == ("left", "down")


def test_after_a_partition_the_higher_stamp_wins_and_its_side_sees_no_new_epoch() -> None:
    net = whole(6, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)])
    net.partition({0, 1, 2})
    net.run_until_whole(LEASE + 1.0)
    higher = max(node.overlay._position.stamp for node in net.nodes.values()).name
    net.heal()
    net.run_until_whole(5.0)
    assert {place.epoch for place in net.places().values()} == {higher}


def test_a_frozen_leaf_costs_one_epoch_and_comes_back_for_free() -> None:
    net = whole(4, CHAIN)
    leaf = next(i for i in (0, 3) if i != root(net))
    net.freeze(leaf)
    net.run(LEASE + 1.0)
    epochs = {place.epoch for i, place in net.places().items() if i != leaf}
    net.run(20.0)
    net.thaw(leaf)
    net.run_until_whole(5.0)
    assert {place.epoch for place in net.places().values()} == epochs


@pytest.mark.parametrize("n", [3, 5, 8])
def test_a_root_that_all_have_shunned_comes_back_to_their_tree_and_not_they_to_its_own(n: int) -> None:
    net = whole(n, [(a, b) for b in range(n) for a in range(b)])
    bad = root(net)
    for i in net.nodes.keys() - {bad}:
        net.nodes[i].overlay.shun(bad, net.nodes[i].clock(net.now))
        net._act(i)
    net.run(5.0)
    assert {place.size for i, place in net.places().items() if i != bad} == {n - 1}
    net.run(15.0)
    assert net.is_whole()
    assert bad not in {place.parent for place in net.places().values()}
    assert net.places()[bad].parent is not None


@pytest.mark.parametrize("seed", range(6))
def test_of_two_ways_to_the_root_that_by_a_neighbour_which_was_shunned_is_the_last(seed: int) -> None:
    net = whole(4, [(0, 1), (0, 2), (1, 3), (2, 3)], seed)
    top, far, shunned = 3, 0, 1
    net.nodes[far].overlay.shun(shunned, net.nodes[far].clock(net.now))
    net._act(far)
    net.run(15.0)
    for starts in (far, top):
        overlay, now = net.nodes[starts].overlay, net.nodes[starts].clock(net.now)
        overlay._position._start(now)
        overlay._announce(now)
        net._act(starts)
        net.run(5.0)
    assert net.is_whole()
    assert net.places()[far].parent == 2


def test_a_short_freeze_is_not_noticed_at_all() -> None:
    net = whole(4, CHAIN)
    before = net.places()
    net.freeze(1)
    net.run(LEASE - 1.1)
    net.thaw(1)
    net.run(5.0)
    assert net.places() == before


def test_a_robot_frozen_for_long_does_not_take_its_neighbours_for_silent() -> None:
    net = whole(3, CHAIN[:2])
    for i in range(3):
        net.freeze(i)
    before = net.places()
    net.run(60.0)
    for i in range(3):
        net.thaw(i)
    net.run(5.0)
    assert net.places() == before


def test_a_flapping_link_does_not_re_form_the_tree_again_and_again() -> None:
    net = whole(4, CHAIN, notice=True)
    epochs = set()
    for _ in range(60):
        net.cut ^= {(2, 3), (3, 2)}
        if net.cut:
            net.nodes[2].overlay.lost(3, net.now)
            net.nodes[3].overlay.lost(2, net.now)
        net.run(1.0)
        epochs.add(net.places()[0].epoch)
    assert len(epochs) <= 10


def test_a_link_that_is_cut_for_seconds_comes_up_only_while_it_is_whole() -> None:
    net = whole(2, [(0, 1)])
    came_up = []
    for _ in range(40):
        net.cut ^= {(0, 1), (1, 0)}
        for _ in range(30):
            before = [node.overlay._peers[1 - i].up for i, node in net.nodes.items()]
            net.run(0.1)
            now = [node.overlay._peers[1 - i].up for i, node in net.nodes.items()]
            came_up += [bool(net.cut) for was, is_up in zip(before, now, strict=True) if is_up and not was]
    assert came_up.count(False) >= 10
    assert True not in came_up


def test_a_link_that_loses_hellos_is_used_only_where_there_is_no_better_way() -> None:
    class Patchy(Network):
        def _send(self, sender: int, to: int, payload: bytes) -> None:
            self.faults.loss = 0.5 if {sender, to} == {0, 3} else 0.0
            super()._send(sender, to, payload)

    net = Patchy(4, [*CHAIN, (0, 3)], 3)
    net.run(80.0)
    assert 3 not in net.places()[0].neighbours
    assert (
        0.3 < next(link.loss for link in net.nodes[0].overlay.status(net.now).links if link.robot == 3) < 0.7
    )


def test_a_much_better_way_to_the_root_is_taken_after_a_while_and_once() -> None:
    n = 9
    ring = [(i, i + 1) for i in range(n - 1)] + [(0, n - 1)]
    net = Network(n, ring, 0)
    net.cut |= {(0, n - 1), (n - 1, 0)}
    net.run_until_whole(5.0)
    net.run(5.0)
    net.cut.clear()
    before, stamp = net.places()[0], net.nodes[0].stamp
    net.run(25.0)
    assert net.places()[0] == before
    net.run(15.0)
    after = net.places()
    assert net.nodes[0].stamp > stamp
    assert net.is_whole()
    net.run(120.0)
    assert net.places() == after


def test_in_a_crowd_no_robot_gets_all_the_others_for_children() -> None:
    n = 30
    net = Network(n, [(i, k) for i in range(n) for k in range(i)], 0)
    net.run_until_whole(5.0)
    degrees = [len(place.neighbours) for place in net.places().values()]
    assert max(degrees) <= 12


def test_who_has_found_a_parent_tells_it_first_however_many_neighbours_it_has() -> None:
    child, parent = Overlay(0, 1, 0.0), Overlay(39, 1, 0.0)
    child.peers(range(40), 0.0)
    parent.peers([0], 0.0)
    for now in np.arange(0.0, 3.0, 0.01).tolist():
        for _, hello in parent.tick(now):
            child.hear(39, hello, now)
        hellos = dict(child.tick(now))
        if child.place.parent == 39:
            assert wire.decode(0, hellos[39]).flags & wire.PARENT
            return
        if 39 in hellos:
            parent.hear(0, hellos[39], now)
    pytest.fail("no parent found")


def test_steady_hellos_take_less_than_200_bytes_a_second_and_link() -> None:
    edges = random_graph(8, np.random.default_rng(4), 1.0)
    net = whole(8, edges, skew=1e6)
    net.bytes.clear()
    net.run(30.0)
    both_ways = [(net.bytes[a, b] + net.bytes[b, a]) / 30.0 for a, b in edges]
    assert max(both_ways) <= 150.0


def test_clocks_are_read_to_half_a_round_trip_and_the_roots_over_any_way() -> None:
    net = whole(4, CHAIN, skew=1000.0)
    net.run(5.0)
    for node in net.nodes.values():
        now = node.clock(net.now)
        for link in node.overlay.status(now).links:
            assert link.offset is not None
            assert link.round_trip is not None
            true = net.nodes[link.robot].clock(net.now) - now
            drifted = 2 * DRIFT * 8 * LEASE / 3  # since the oldest of eight samples
            assert abs(link.offset - true) <= link.round_trip / 2 + drifted
        true = net.nodes[root(net)].clock(net.now) - now
        assert node.overlay.status(now).to_root == pytest.approx(true, abs=0.1)


def test_a_robot_that_starts_again_under_the_same_boot_says_so_and_is_heard_once_it_takes_another() -> None:
    net = whole(4, CHAIN)
    boot = net.nodes[3].overlay.boot
    net.crash(3)
    net.restart(3, boot)
    with pytest.raises(ValueError, match="has heard more"):
        net.run(LEASE + 2.0)
    assert str(boot) in net.nodes[3].overlay.complaints[2]


def test_hellos_of_an_earlier_life_and_copies_change_nothing() -> None:
    a, b = Overlay(0, 5, 0.0), Overlay(1, 6, 0.0)
    a.peers([1], 0.0)
    b.peers([0], 0.0)
    old = b.tick(0.0)[0][1]
    a.hear(1, old, 0.0)
    a.tick(0.0)
    a.hear(1, old, 0.1)  # a copy
    assert a.status(0.1).links[0].silent == pytest.approx(0.1)
    b = Overlay(1, 7, 0.2)
    b.peers([0], 0.2)
    a.hear(1, b.tick(0.2)[0][1], 0.2)
    a.hear(1, old, 0.3)  # of the life before
    assert a.boot_of(1) == 7
    assert a.status(0.3).links[0].silent == pytest.approx(0.1)


def test_hellos_from_robots_that_are_no_peers_are_ignored() -> None:
    a, b = Overlay(0, 5, 0.0), Overlay(1, 6, 0.0)
    b.peers([0], 0.0)
    a.hear(1, b.tick(0.0)[0][1], 0.0)
    assert a.status(0.0).links == ()
    assert a.boot_of(1) == -1


def a_hello(**changes: object) -> bytes:
    """A hello of robot 1, who is the root."""
    fields: dict[str, object] = {
        "boot": 6,
        "sequence": 3,
        "time": 100,
        "epoch": 2,
        "root": 1,
        "root_boot": 6,
        "distance": 0,
        "flags": wire.UP,
        "size": 1,
        "loss": 0,
        "to_root": 0,
        "terms": 0,
        "echo": (5, 1, 0),
    }
    return msgspec.msgpack.encode([wire.VERSION, *(fields | changes).values()])


@pytest.mark.parametrize(
    "changes",
    [
        {"boot": -1},
        {"boot": 2**38},
        {"sequence": 0},
        {"epoch": 0},
        {"epoch": 2**63},
        {"root": 2**16},
        {"distance": 3},  # but it is the root
        {"root": 2},  # at distance 0
        {"root_boot": 7},  # its own, but of another life
        {"root": 2, "distance": 1, "epoch": 3},  # alone with another
        {"flags": 32},
        {"flags": wire.PARENT},  # the root's parent
        {"size": 0},
        {"loss": 101},
        {"time": 2**60},
        {"time": 0.5},
        {"echo": (5, 1)},
        {"echo": "x" * 200},
        {"echo": (5, 2, 0)},  # of a hello that was never said
        {"epoch": 2**63 - 2},  # for a robot that has been on a tree or not: none is left then
        {"terms": -1},
    ],
)
def test_a_malformed_hello_is_refused_and_changes_nothing(changes: dict[str, object]) -> None:
    overlay = Overlay(0, 5, 0.0)
    overlay.peers([1], 0.0)
    overlay.tick(0.0)
    before = overlay.status(0.0), overlay.wake
    with pytest.raises(ValueError, match=r"hello"):
        overlay.hear(1, a_hello(**changes), 0.5)
    assert (overlay.status(0.0), overlay.wake) == before
    overlay.hear(1, a_hello(), 0.5)
    assert overlay.boot_of(1) == 6


@settings(deadline=None, max_examples=100)
@given(st.lists(st.binary(max_size=80) | st.tuples(st.integers(0, 60), st.integers(0, 255)), max_size=8))
def test_no_bytes_can_do_worse_than_a_value_error(mutations: list[bytes | tuple[int, int]]) -> None:
    overlay = Overlay(0, 5, 0.0)
    overlay.peers([1], 0.0)
    for step, mutation in enumerate(mutations):
        payload = bytearray(a_hello(sequence=step + 1))
        if isinstance(mutation, bytes):
            payload = bytearray(mutation)
        else:
            payload[mutation[0] % len(payload)] = mutation[1]
        try:
            overlay.hear(1, bytes(payload), 0.1 * step)
        except ValueError:
            continue
        overlay.tick(0.1 * step)
        assert overlay.place.size >= 1


def test_an_epoch_that_is_said_raises_everybodys_but_leaves_room_for_as_many() -> None:
    tree = Stamp(40, 1, 6)
    assert tree.may_follow(HALF)
    assert not tree.may_follow(HALF + STEP + 2)
    assert Stamp(HALF, 1, 6).may_follow(HALF + STEP)
    assert Stamp(1, 1, 6).may_follow(HALF + 7 * STEP)
    assert not Stamp(1, 1, 6).may_follow(2 * HALF - 2)


@settings(deadline=None)
@given(
    st.lists(
        st.builds(Stamp, st.integers(0, 2**62), st.integers(0, 2**16 - 1), st.integers(0, 2**38 - 1)),
        min_size=2,
        max_size=2,
        unique=True,
    )
)
def test_stamps_have_names_of_their_own_that_fit_every_languages_numbers(stamps: list[Stamp]) -> None:
    a, b = sorted(stamps)
    assert 0 <= a.name < 2**53
    assert a.name != b.name
    assert a < a.next_alone(b.root, b.boot) < a.next_tree(0, 0) or a.is_alone


def test_bad_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="robot must lie"):
        Overlay(2**16, 1, 0.0)
    with pytest.raises(ValueError, match="boot must lie"):
        Overlay(1, 2**38, 0.0)
    with pytest.raises(ValueError, match="lease"):
        Overlay(1, 1, 0.0, lease=0.0)
    with pytest.raises(ValueError, match="1024 neighbours"):
        Overlay(1, 1, 0.0).peers(range(2000), 0.0)


@pytest.mark.slow
def test_a_thousand_robots_form_one_tree_in_one_process() -> None:
    net = Network(1000, random_graph(1000, np.random.default_rng(0), 1.5), 1, check=False)
    while not net.is_whole():
        assert net.now < 5.0
        net.run(0.1)


def test_delay_and_reordering_do_not_disturb_a_tree() -> None:
    net = whole(5, random_graph(5, np.random.default_rng(2), 0.6))
    before = net.places()
    net.faults = Faults(loss=0.1, repeat=0.3, delay=(0.0, 0.8))
    net.run(20.0)
    assert net.places() == before
