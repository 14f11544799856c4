"""Reliable links: every message once and in order over links that lose, repeat and reorder."""

from __future__ import annotations

import heapq
import itertools

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.overlay import ReliableLink
from vedette.overlay import reliable as link_module

STAMP = 99
PAYLOAD = b"x" * 100


class Pair:
    """Two ends, datagrams between them, and what each end has been handed."""

    def __init__(self, loss: float = 0.0, seed: int = 0, delay: tuple[float, float] = (0.01, 0.01)) -> None:
        """Open both ends at once."""
        self.ends = [ReliableLink(1), ReliableLink(2)]
        self.got: list[list[bytes]] = [[], []]
        self.at: list[list[float]] = [[], []]  # when
        self.datagrams, self.bytes = 0, 0
        self.loss, self.repeat, self.delay = loss, 0.1 if loss else 0.0, delay
        self.now = 0.0
        self._rng = np.random.default_rng(seed)
        self._air: list[tuple[float, int, int, bytes]] = []
        self._count = itertools.count()
        for end in (0, 1):
            self.open(end, STAMP)

    def open(self, end: int, stamp: int) -> None:
        self.ends[end].open(2 - end, stamp, self.now)

    def send(self, end: int, payload: bytes) -> None:
        self.ends[end].send(payload, self.now)
        self.flush()

    def flush(self) -> None:
        for end in (0, 1):
            for data in self.ends[end].poll(self.now):
                self.datagrams += 1
                self.bytes += len(data)
                if self._rng.random() >= self.loss:
                    for _ in range(1 + (self._rng.random() < self.repeat)):
                        at = self.now + self._rng.uniform(*self.delay)
                        heapq.heappush(self._air, (at, next(self._count), 1 - end, data))

    def run(self, seconds: float) -> None:
        until = self.now + seconds
        while True:
            wake = min(self.ends[0].wake, self.ends[1].wake)
            arrival = self._air[0][0] if self._air else float("inf")
            if min(wake, arrival) > until:
                break
            self.now = max(min(wake, arrival), self.now)
            if arrival <= self.now:
                _, _, end, data = heapq.heappop(self._air)
                for message in self.ends[end].hear(data, self.now):
                    self.got[end].append(message)
                    self.at[end].append(self.now)
            self.flush()
        self.now = until


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("longest", [0.01, 0.3])
def test_every_message_arrives_once_and_in_order_at_30_percent_loss(seed: int, longest: float) -> None:
    pair = Pair(loss=0.3, seed=seed, delay=(0.001, longest))
    sent: list[list[bytes]] = [[], []]
    rng = np.random.default_rng(seed)
    for number in range(150):
        end = int(rng.integers(2))
        sent[1 - end].append(f"{number} ".encode() * int(rng.choice([1, 10, 500])))
        pair.send(end, sent[1 - end][-1])
        pair.run(float(rng.exponential(0.02)))
    pair.run(6.0)
    assert pair.got == sent
    assert all(end.is_idle and not end.lost for end in pair.ends)


def test_without_loss_a_message_costs_26_bytes_with_its_confirmation_and_nothing_is_sent_twice() -> None:
    pair = Pair()
    pair.run(0.1)
    pair.bytes = pair.datagrams = 0
    for _ in range(200):
        for end in (0, 1):
            pair.send(end, PAYLOAD)
        pair.run(0.05)
    pair.run(1.0)
    assert len(pair.got[0]) == len(pair.got[1]) == 200
    assert sum(end.resent for end in pair.ends) == 0
    assert pair.bytes / 400 <= len(PAYLOAD) + 26


def test_one_way_traffic_is_acknowledged_late_and_together() -> None:
    pair = Pair()
    pair.run(0.1)
    pair.bytes = pair.datagrams = 0
    for _ in range(200):
        pair.send(0, PAYLOAD)
        pair.run(0.01)
    pair.run(1.0)
    assert len(pair.got[1]) == 200
    assert pair.ends[0].resent == 0
    assert pair.datagrams - 200 <= 100


def test_an_answer_carries_the_acknowledgement() -> None:
    pair = Pair()
    pair.run(0.1)
    pair.datagrams = 0
    for _ in range(50):
        pair.send(0, b"question")
        pair.run(0.0101)
        pair.send(1, b"answer")
        pair.run(0.0101)
    assert pair.datagrams == 100


def test_small_messages_share_a_datagram_and_large_ones_go_alone() -> None:
    pair = Pair()
    pair.run(0.1)
    pair.datagrams = 0
    for payload in (b"a" * 400, b"b" * 400, b"c" * 400, b"d" * 5000, b"e"):
        pair.ends[0].send(payload, pair.now)
    pair.flush()
    assert pair.datagrams == 3
    pair.run(0.1)
    assert [payload[:1] for payload in pair.got[1]] == [b"a", b"b", b"c", b"d", b"e"]


def test_at_20_percent_loss_95_in_100_messages_arrive_within_a_quarter_of_a_second() -> None:
    late: list[float] = []
    for seed in range(5):
        pair = Pair(loss=0.2, seed=seed, delay=(0.001, 0.005))
        sent = []
        for _ in range(100):
            sent.append(pair.now)
            pair.send(0, b"token")
            pair.run(0.05)
        pair.run(3.0)
        late += [at - then for at, then in zip(pair.at[1], sent, strict=True)]
    assert np.percentile(late, 95) <= 0.25


def test_what_was_sent_under_another_stamp_or_boot_is_void() -> None:
    pair = Pair()
    pair.ends[0].send(b"of the old tree", pair.now)
    old = pair.ends[0].poll(pair.now)
    assert len(old) == 1
    for end in (0, 1):
        pair.open(end, STAMP + 1)
    assert pair.ends[1].hear(old[0], pair.now) == []
    pair.send(0, b"of the new tree")
    pair.run(1.0)
    assert pair.got[1] == [b"of the new tree"]
    pair.ends[1].open(77, STAMP + 1, pair.now)  # the neighbour has started again
    pair.send(0, b"of its earlier life")
    pair.run(1.0)
    assert pair.got[1] == [b"of the new tree"]


def test_an_end_that_opens_late_gets_what_it_missed_within_a_round_trip() -> None:
    pair = Pair()
    pair.ends[1].close()
    for number in range(3):
        pair.send(0, str(number).encode())
        pair.run(0.02)
    pair.run(0.1)
    assert pair.got[1] == []
    pair.open(1, STAMP)
    pair.flush()
    pair.run(0.021)
    assert pair.got[1] == [b"0", b"1", b"2"]


def test_a_neighbour_that_confirms_nothing_is_reported_lost_and_nothing_is_kept() -> None:
    pair = Pair()
    pair.run(10.0)
    pair.loss = 1.0
    pair.send(0, PAYLOAD)
    pair.run(5.9)
    assert not pair.ends[0].lost
    pair.run(0.2)
    assert pair.ends[0].lost
    assert pair.ends[0].is_idle
    assert pair.ends[0].wake == float("inf")
    assert not pair.ends[1].lost  # it has nothing to confirm
    pair.loss = 0.0
    for end in (0, 1):
        pair.open(end, STAMP + 1)
    pair.send(0, b"again")
    pair.run(0.1)
    assert pair.got[1] == [b"again"]


def test_an_idle_link_is_never_lost_and_sends_nothing() -> None:
    pair = Pair()
    pair.run(0.1)
    pair.datagrams = 0
    pair.run(1000.0)
    assert pair.datagrams == 0
    assert not pair.ends[0].lost


def test_an_end_that_was_frozen_gives_its_neighbour_time_to_answer() -> None:
    link = ReliableLink(1)
    link.open(2, STAMP, 0.0)
    link.send(b"x", 0.0)
    link.poll(0.0)
    link.poll(60.0)
    assert not link.lost
    for step in range(130):
        link.poll(60.0 + 0.05 * step)
    assert link.lost


def test_memory_is_bounded_at_either_end() -> None:
    link = ReliableLink(1)
    link.open(2, STAMP, 0.0)
    for _ in range(link_module.MOST_QUEUED + 1):
        link.send(b"x", 0.0)
    assert link.lost
    link.open(2, STAMP + 1, 0.0)
    assert not link.lost
    for _ in range(5):
        link.send(bytes(1 << 24), 0.0)
    assert link.lost
    receiver = ReliableLink(2)
    receiver.open(1, STAMP, 0.0)
    for number, is_kept in ((link_module.WINDOW, False), (1, True)):
        early = msgspec.msgpack.encode([1, wire_session(), 0, 0, number, [b"early"]])
        assert receiver.hear(early, 0.0) == []
        _, _, ack, more, *_ = msgspec.msgpack.decode(receiver.poll(0.0)[0])
        assert (ack, more) == (0, int(is_kept))


def test_no_more_messages_are_under_way_than_the_other_end_keeps() -> None:
    link = ReliableLink(1)
    link.open(2, STAMP, 0.0)
    for _ in range(link_module.WINDOW + 40):
        link.send(PAYLOAD, 0.0)
    for now in (0.0, 0.5, 3.0):
        link.poll(now)
    assert link.carried == link_module.WINDOW * len(PAYLOAD)


def wire_session() -> int:
    """The session of packets from robot life 1 to 2 on the stamp."""
    link = ReliableLink(1)
    link.open(2, STAMP, 0.0)
    return int(msgspec.msgpack.decode(link.poll(0.0)[0])[1])


def test_a_link_that_is_not_open_takes_and_gives_nothing() -> None:
    link = ReliableLink(1)
    link.send(b"x", 0.0)
    assert link.poll(0.0) == []
    assert link.is_idle
    link.open(2, STAMP, 0.0)
    link.send(b"x", 0.0)
    link.close()
    assert link.poll(1.0) == []


@pytest.mark.parametrize(
    "fields",
    [
        [2, 0, 0],
        [1, -1, 0],
        [1, 2**32, 0],
        [1, 0, -1],
        [1, 0, 0, 2**62],
        [1, 0, 0, 0, 0, [b"x"] * 65],
        [1, 0, 0, 0, 0, ["text"]],
        [1, 0, 0, 0, 0, b"x"],
        "nonsense",
    ],
)
def test_malformed_packets_are_refused_and_change_nothing(fields: object) -> None:
    pair = Pair()
    pair.run(0.1)
    with pytest.raises(ValueError, match="packet"):
        pair.ends[1].hear(msgspec.msgpack.encode(fields), pair.now)
    pair.send(0, b"fine")
    pair.run(0.1)
    assert pair.got[1] == [b"fine"]


def test_a_confirmation_of_what_was_never_sent_is_refused() -> None:
    link = ReliableLink(2)
    link.open(1, STAMP, 0.0)
    with pytest.raises(ValueError, match="never sent"):
        link.hear(msgspec.msgpack.encode([1, wire_session(), 1]), 0.0)


@settings(deadline=None, max_examples=100)
@given(st.lists(st.binary(max_size=60) | st.tuples(st.integers(0, 60), st.integers(0, 255)), max_size=8))
def test_no_bytes_can_do_worse_than_a_value_error(mutations: list[bytes | tuple[int, int]]) -> None:
    link = ReliableLink(2)
    link.open(1, STAMP, 0.0)
    for step, mutation in enumerate(mutations):
        data = bytearray(msgspec.msgpack.encode([1, wire_session(), 0, 0, step, [b"a", b"b"]]))
        if isinstance(mutation, bytes):
            data = bytearray(mutation)
        else:
            data[mutation[0] % len(data)] = mutation[1]
        try:
            link.hear(bytes(data), 0.1 * step)
        except ValueError:
            continue
        link.poll(0.1 * step)
