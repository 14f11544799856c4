"""A reliable link to one neighbour: every message once and in order, over datagrams that promise neither."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from vedette.overlay import packet as wire
from vedette.overlay.packet import MOST_MESSAGES, REPORTED, WINDOW, Packet, session_of
from vedette.overlay.roundtrip import RoundTrip

ACK_DELAY = 0.02  # for which an acknowledgement waits for a message to ride on [s]
BUNDLE = 1200  # bytes of messages that share a packet; a longer message has one of its own
MOST_QUEUED = 4096  # messages not acknowledged
MOST_BYTES = 1 << 26  # of them, and of messages that wait for an earlier one


@dataclass
class _Sent:
    payload: bytes
    at: float  # last sent [s]
    due: float  # to be sent again [s]
    tries: int = 1


class ReliableLink:
    """One end of a link; no I/O, no clock. Call ``poll`` after every other call, and when ``wake`` has come.

    A link carries messages only between two lives of two robots on one tree: ``open`` voids all that went
    before. When the other end confirms nothing for ``patience`` seconds, or too much waits to be sent, the
    link is ``lost`` and stays so until it is opened again.
    """

    def __init__(self, boot: int, patience: float = 6.0) -> None:
        """``boot`` is our own; the link is closed."""
        self.boot, self.patience = boot, patience
        self.lost = False
        self.wake = float("inf")  # when ``poll`` next has something to do [s]
        self.resent = 0  # messages, since the link was made
        self.carried = 0  # bytes of messages, each counted when it is first sent, since the link was made
        self._round_trip = RoundTrip()
        self._is_open = False
        self._reset(0.0)

    def open(self, peer_boot: int, stamp: int, now: float) -> None:
        """Start empty with a neighbour's present life on the tree of this stamp."""
        self._ours = session_of(self.boot, peer_boot, stamp)
        self._theirs = session_of(peer_boot, self.boot, stamp)
        self._is_open, self.lost = True, False
        self._reset(now)
        self._ack_due = now  # so that the other end knows
        self._plan()

    def close(self) -> None:
        """Forget everything; nothing is sent or delivered until the link is opened again."""
        self._is_open = False
        self._reset(0.0)
        self.wake = float("inf")

    def _reset(self, now: float) -> None:
        self._queue: deque[bytes] = deque()
        self._flight: dict[int, _Sent] = {}  # by sequence number, ascending
        self._next = 0  # sequence number of the next new message
        self._bytes = 0  # queued and in flight
        self._expected = 0  # the other end's next message
        self._early: dict[int, bytes] = {}  # that came before an earlier one
        self._early_bytes = 0
        self._ack_due = float("inf")
        self._met = False  # anything was heard in this session
        self._moved = now  # when the other end last confirmed anything, or had nothing to confirm [s]
        self._now = now

    def _give_up(self) -> None:
        self._reset(self._now)
        self.lost, self.wake = True, float("inf")

    @property
    def is_idle(self) -> bool:
        """Tell whether everything sent has been confirmed."""
        return not self._queue and not self._flight

    def send(self, payload: bytes, now: float) -> None:
        """Take a message to be delivered; on a link that is closed or lost it is void."""
        if not self._is_open or self.lost:
            return
        if self.is_idle:
            self._moved = now
        self._queue.append(payload)
        self._bytes += len(payload)
        self.wake = now
        if len(self._queue) + len(self._flight) > MOST_QUEUED or self._bytes > MOST_BYTES:
            self._give_up()

    def hear(self, data: bytes, now: float) -> list[bytes]:
        """Take in a packet; return the messages that are next in order, now that it has come.

        Raises:
            ValueError: malformed; nothing changes.
        """
        packet = wire.decode(data)
        if not self._is_open or self.lost or packet.session != self._theirs:
            return []
        if packet.ack > self._next:
            raise ValueError(f"packet: message {packet.ack - 1} is confirmed, but was never sent")
        self._confirm(packet, now)
        messages = self._receive(packet, now)
        self._plan()
        return messages

    def poll(self, now: float) -> list[bytes]:
        """Return the packets to send now."""
        if now - self._now > self.patience / 2:  # we did not run: their silence proves nothing
            self._moved = min(self._moved + now - self._now, now)
        self._now = now
        if not self._is_open or self.lost:
            return []
        if self._flight and now >= self._moved + self.patience:
            self._give_up()
        if now < self.wake:
            return []
        runs = self._due(now)
        packets = [self._packet(first, messages) for first, messages in runs]
        if not packets and now >= self._ack_due:
            packets = [self._packet(0, ())]
        if packets:
            self._ack_due = float("inf")
        self._plan()
        return packets

    # -- sending -----------------------------------------------------------------------------------

    def _due(self, now: float) -> list[tuple[int, tuple[bytes, ...]]]:
        """Return runs of messages to send, each with its first sequence number."""
        due = [number for number, sent in self._flight.items() if sent.due <= now]
        for number in due:
            sent = self._flight[number]
            sent.tries += 1
            sent.at, sent.due = now, now + self._round_trip.timeout(sent.tries)
            self.resent += 1
        oldest = next(iter(self._flight), self._next)
        while self._queue and self._next < oldest + WINDOW:
            payload = self._queue.popleft()
            self.carried += len(payload)
            self._flight[self._next] = _Sent(payload, now, now + self._round_trip.timeout(1))
            due.append(self._next)
            self._next += 1
        return self._runs(due)

    def _runs(self, numbers: list[int]) -> list[tuple[int, tuple[bytes, ...]]]:
        runs: list[tuple[int, tuple[bytes, ...]]] = []
        run: list[bytes] = []
        for i, number in enumerate(numbers):
            run.append(self._flight[number].payload)
            follows = i + 1 < len(numbers) and numbers[i + 1] == number + 1 and len(run) < MOST_MESSAGES
            if follows and sum(map(len, run)) + len(self._flight[number + 1].payload) <= BUNDLE:
                continue
            runs.append((number + 1 - len(run), tuple(run)))
            run = []
        return runs

    def _packet(self, first: int, messages: tuple[bytes, ...]) -> bytes:
        more = sum(1 << k for k in range(REPORTED) if self._expected + 1 + k in self._early)
        return wire.encode(Packet(self._ours, self._expected, more, first, messages))

    def _confirm(self, packet: Packet, now: float) -> None:
        """Drop what has arrived at the other end; send again what was overtaken there."""
        arrived = [number for number in self._flight if _confirms(packet, number)]
        newest = -float("inf")
        for number in arrived:
            sent = self._flight.pop(number)
            self._bytes -= len(sent.payload)
            if sent.tries == 1:
                newest = max(newest, sent.at)
                self._round_trip.take(now - sent.at)
        if arrived:
            self._moved = now
        overtaken = newest - self._round_trip.reordering
        # The first that is heard in a session may tell that its other end has only just been opened.
        deaf = not self._met and packet.ack == 0
        self._met = True
        for sent in self._flight.values():
            if sent.at < overtaken or deaf:
                sent.due = min(sent.due, now)

    # -- receiving ---------------------------------------------------------------------------------

    def _receive(self, packet: Packet, now: float) -> list[bytes]:
        for number, payload in enumerate(packet.messages, packet.first):
            self._keep(number, payload)
        messages = []
        while self._expected in self._early:
            messages.append(self._early.pop(self._expected))
            self._expected += 1
        self._early_bytes -= sum(map(len, messages))
        if packet.messages:
            in_order = len(messages) == len(packet.messages) and not self._early
            self._ack_due = min(self._ack_due, now + (ACK_DELAY if in_order else 0.0))
        return messages

    def _keep(self, number: int, payload: bytes) -> None:
        is_new = self._expected <= number < self._expected + WINDOW and number not in self._early
        fits = number == self._expected or self._early_bytes + len(payload) <= MOST_BYTES
        if is_new and fits:
            self._early[number] = payload
            self._early_bytes += len(payload)

    def _plan(self) -> None:
        room = self._next < next(iter(self._flight), self._next) + WINDOW
        times = [self._ack_due, *(sent.due for sent in self._flight.values())]
        if self._flight:
            times += [self._moved + self.patience, self._now + self.patience / 4]
        self.wake = self._now if self._queue and room else min(times)


def _confirms(packet: Packet, number: int) -> bool:
    beyond = number - packet.ack - 1
    return beyond < -1 or (beyond >= 0 and packet.more >> beyond & 1 == 1)
