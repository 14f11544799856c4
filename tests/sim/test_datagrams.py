"""The simulated datagram network does to datagrams what it is set to do, in the shares it is set to."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from vedette.sim.datagrams import Datagrams, Weather, linked

Arrival = tuple[float, int, int, bytes]
MANY = 20_000


def network(robots: int = 3, delay: tuple[float, float] = (0.02, 0.02), seed: int = 0) -> Datagrams:
    return Datagrams(robots, np.random.default_rng(seed), delay)


def arrivals(net: Datagrams) -> list[Arrival]:
    found = []
    while net.next_arrival() < float("inf"):
        due = net.next_arrival()
        found.append(net.arrive())
        assert found[-1][0] == due
    return found


def share_arriving(net: Datagrams, sender: int, to: int) -> float:
    for _ in range(MANY):
        net.send(sender, to, b"x", 0.0)
    return len(arrivals(net)) / MANY


def test_a_datagram_arrives_after_the_delay_as_it_was_sent() -> None:
    net = network()
    net.send(2, 0, b"hello", 1.0)
    net.send(0, 1, b"there", 1.01)
    assert arrivals(net) == [(1.02, 2, 0, b"hello"), (pytest.approx(1.03), 0, 1, b"there")]
    assert net.next_arrival() == float("inf")


def test_with_one_delay_datagrams_arrive_in_order_and_with_unequal_ones_they_overtake() -> None:
    orders = []
    for delay in ((0.02, 0.02), (0.0, 0.5)):
        net = network(2, delay)
        for k in range(100):
            net.send(0, 1, bytes([k]), 0.001 * k)
        orders.append([payload[0] for _, _, _, payload in arrivals(net)])
    assert orders[0] == sorted(orders[0])
    assert orders[1] != sorted(orders[1])
    assert sorted(orders[1]) == list(range(100))


def test_delays_are_uniform_between_the_shortest_and_the_longest() -> None:
    net = network(2, (0.1, 0.3))
    for _ in range(MANY):
        net.send(0, 1, b"", 5.0)
    delays = np.array([time for time, *_ in arrivals(net)]) - 5.0
    assert 0.1 <= delays.min() < 0.101
    assert 0.299 < delays.max() <= 0.3
    assert np.histogram(delays, 4, (0.1, 0.3))[0] / MANY == pytest.approx([0.25] * 4, abs=0.02)


def test_each_direction_loses_its_own_share_and_weather_comes_on_top() -> None:
    net = network()
    loss = linked(3, [(0, 1), (1, 2)])
    loss[0, 1], loss[1, 0] = 0.3, 0.1
    net.set_links(loss)
    assert share_arriving(net, 0, 1) == pytest.approx(0.7, abs=0.02)
    assert share_arriving(net, 1, 0) == pytest.approx(0.9, abs=0.02)
    assert share_arriving(net, 1, 2) == 1.0
    assert share_arriving(net, 0, 2) == 0.0
    net.set_weather(Weather(loss=0.5))
    assert share_arriving(net, 0, 1) == pytest.approx(0.35, abs=0.02)
    assert share_arriving(net, 1, 2) == pytest.approx(0.5, abs=0.02)
    net.set_weather(Weather())
    assert share_arriving(net, 1, 2) == 1.0


def test_the_share_to_repeat_arrives_twice_and_no_more() -> None:
    net = network(2, (0.0, 0.1))
    net.set_weather(Weather(repeat=0.2))
    for k in range(MANY):
        net.send(0, 1, k.to_bytes(4, "big"), 0.0)
    copies = Counter(Counter(payload for *_, payload in arrivals(net)).values())
    assert set(copies) == {1, 2}
    assert copies[2] / MANY == pytest.approx(0.2, abs=0.02)


def test_weather_replaces_the_delay_while_it_lasts() -> None:
    net = network()
    net.set_weather(Weather(delay=(1.0, 1.0)))
    net.send(0, 1, b"", 0.0)
    net.set_weather(Weather())
    net.send(0, 1, b"", 0.0)
    assert [time for time, *_ in arrivals(net)] == [0.02, 1.0]


def test_a_blocked_direction_lets_nothing_through_and_the_other_does() -> None:
    net = network()
    blocked = np.zeros((3, 3), dtype=bool)
    blocked[0, 1] = True
    net.set_weather(Weather(blocked=blocked))
    assert (share_arriving(net, 0, 1), share_arriving(net, 1, 0)) == (0.0, 1.0)
    assert net.reachable(0) == (1, 2), "faults are not known to the transport"


def test_peers_are_those_that_links_lead_to() -> None:
    net = network(4)
    assert [net.reachable(i) for i in range(4)] == [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)]
    net.set_links(linked(4, [(2, 0), (2, 1)]))
    assert [net.reachable(i) for i in range(4)] == [(2,), (2,), (0, 1), ()]


def test_everybodys_datagrams_and_bytes_are_counted_lost_ones_included() -> None:
    net = network()
    net.set_links(linked(3, [(0, 1)]))
    net.send(0, 1, b"four", 0.0)
    net.send(0, 2, b"sixsix", 0.0)
    net.send(1, 0, b"", 0.0)
    assert (net.datagrams_sent, net.bytes_sent, net.lost) == ([2, 1, 0], [10, 0, 0], 1)


def test_the_same_seed_gives_the_same_arrivals_and_another_does_not() -> None:
    def played(seed: int) -> list[Arrival]:
        net = network(5, (0.0, 0.2), seed)
        net.set_weather(Weather(loss=0.3, repeat=0.3))
        for k in range(3000):
            net.send(k % 5, (k + 1) % 5, bytes([k % 256]), 0.01 * k)
        return arrivals(net)

    assert played(1) == played(1)
    assert played(1) != played(2)


def test_links_of_another_team_size_are_refused() -> None:
    with pytest.raises(ValueError, match=r"shape \(3, 3\); got \(2, 2\)"):
        network(3).set_links(linked(2, [(0, 1)]))
