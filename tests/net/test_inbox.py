"""The queue before a robot's one thread: bounded, and each neighbour has its share."""

from __future__ import annotations

from vedette.agent.networked import BEACON, PACKET
from vedette.net.inbox import MOST_BEACONS, MOST_OF_ONE, MUCH, Inbox, PeerGone, ReceivedDatagram


def test_a_flood_of_one_neighbours_beacons_keeps_nobody_elses_datagrams_out() -> None:
    inbox = Inbox()
    for number in range(60_000):
        inbox.put(ReceivedDatagram(1, BEACON + bytes(1000), float(number)))
    for kind in (PACKET, BEACON):
        inbox.put(ReceivedDatagram(2, kind, 0.0))
    inbox.put(ReceivedDatagram(1, PACKET, 0.0))  # its own evidence is not lost for its beacons
    assert inbox.dropped == 60_000 - MOST_BEACONS
    events = [inbox.get(0.0) for _ in range(MOST_BEACONS + 3)]
    assert [each.robot for each in events[-3:] if isinstance(each, ReceivedDatagram)] == [2, 2, 1]
    assert inbox.get(0.0) is None
    inbox.put(ReceivedDatagram(1, BEACON, 1.0))  # once it is heard again
    assert inbox.get(0.0) is not None


def test_a_flood_of_packets_leaves_room_for_others_and_for_what_the_transport_tells() -> None:
    inbox = Inbox()
    for _ in range(10_000):
        inbox.put(ReceivedDatagram(1, PACKET, 0.0))
    inbox.put(ReceivedDatagram(2, PACKET, 0.0))
    inbox.put(PeerGone(1, 0.0))
    assert inbox.dropped == 10_000 - MOST_OF_ONE
    events = [inbox.get(0.0) for _ in range(MOST_OF_ONE + 2)]
    assert events[-2:] == [ReceivedDatagram(2, PACKET, 0.0), PeerGone(1, 0.0)]


def test_one_neighbour_gets_half_of_the_memory_at_most() -> None:
    inbox = Inbox(most_bytes=1000)
    for _ in range(20):
        inbox.put(ReceivedDatagram(1, PACKET + bytes(99), 0.0))
    inbox.put(ReceivedDatagram(2, PACKET + bytes(99), 0.0))
    assert inbox.dropped == 15


def test_who_floods_is_known_and_nobody_else() -> None:
    inbox = Inbox()
    for k in range(MOST_BEACONS + MUCH):
        assert inbox.drowning == frozenset()
        inbox.put(ReceivedDatagram(1, BEACON + b"x", float(k)))
        inbox.put(ReceivedDatagram(2, b"x", float(k)))
    assert inbox.drowning == {1}
