"""Sessions over Eclipse Zenoh: a robot's datagrams to its neighbours, and the operator's view of the team."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Self

import zenoh

from vedette.errors import InputError
from vedette.net.access import MOST_PAYLOAD, Access, settings
from vedette.net.endpoints import check_connecting, check_listening
from vedette.net.inbox import Inbox, PeerGone, PeerSeen, ReceivedDatagram
from vedette.net.names import Topic, check_robot, robot_of

MOST_STATUS = 1 << 20  # bytes taken of an answer, or of an order
MOST_WORDS = 500  # characters of what is said to an order


@dataclass(frozen=True)
class Published:
    """What a robot has told whoever wants to know."""

    topic: Topic
    robot: int
    payload: bytes
    time: float  # of arrival [s]


@dataclass(frozen=True, eq=False)
class ToldOrder:
    """An order that the operator has told a robot; it waits for an answer, a line."""

    payload: bytes
    answer: Callable[[str], None]


class _Session:
    """An open Zenoh session that watches who else is there."""

    def __init__(self, access: Access, robot: int | None, inbox: Inbox, clock: Callable[[], float]) -> None:
        self.access, self.inbox, self.clock = access, inbox, clock
        self.names = access.names
        self.refused = 0  # messages of no known robot, or too large
        self._robot = robot
        self._lives: dict[int, set[str]] = {}  # sessions by robot
        self._lock = threading.Lock()
        self._session = _open(access, robot)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def peers(self) -> frozenset[int]:
        """Robots that a link is open to; ``PeerSeen`` and ``PeerGone`` in the inbox tell of changes."""
        with self._lock:
            return frozenset(robot for robot, lives in self._lives.items() if lives)

    def subscribe(self, topic: Topic, callback: Callable[[Published], None]) -> None:
        """Call back, in a thread of the session, with what each peer publishes on a topic.

        ``callback`` must be quick and not raise; an ``Inbox.put`` is.
        """

        def take(sample: zenoh.Sample) -> None:
            robot, payload = robot_of(str(sample.key_expr).rpartition("/")[2]), sample.payload
            if robot is None or len(payload) > MOST_PAYLOAD:
                self.refused += 1
                return
            callback(Published(topic, robot, payload.to_bytes(), self.clock()))

        self._listen(self.names.topic(topic, None), take)

    def close(self) -> None:
        """End the session; peers notice at once. Closing again does nothing."""
        if not self._session.is_closed():
            self._session.close()  # type: ignore[no-untyped-call]

    def _listen(self, key: str, take: Callable[[zenoh.Sample], None]) -> None:
        # Called in the thread that reads the link: what came first is put into the inbox first.
        handler = zenoh.handlers.Callback(take, indirect=False)
        self._session.declare_subscriber(key, handler, allowed_origin=zenoh.Locality.REMOTE)

    def _watch(self) -> None:
        handler = zenoh.handlers.Callback(self._note, indirect=False)
        self._session.liveliness().declare_subscriber(self.names.alive(None), handler, history=True)

    def _note(self, sample: zenoh.Sample) -> None:
        """Keep each robot's sessions: one that restarts may be seen anew before its old self goes."""
        *_, number, session = str(sample.key_expr).split("/")
        robot = robot_of(number)
        if robot is None or robot == self._robot:
            return
        with self._lock:  # every link has a thread of its own
            lives = self._lives.setdefault(robot, set())
            was_there = bool(lives)
            if sample.kind == zenoh.SampleKind.PUT:
                lives.add(session)
            else:
                lives.discard(session)
            if bool(lives) != was_there:
                self.inbox.put((PeerSeen if lives else PeerGone)(robot, self.clock()))


class Transport(_Session):
    """One robot's session: unreliable datagrams to and from its neighbours.

    What arrives waits in ``inbox`` as ``ReceivedDatagram``, ``PeerSeen`` and ``PeerGone``. Datagrams may be
    lost, not doubled, and come in the order in which they were sent while one link lasts. Neighbours are
    those that this robot connects to or that connect to it; nobody passes anything on.
    """

    def __init__(
        self,
        access: Access,
        robot: int,
        inbox: Inbox | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open the session; connecting goes on in the background, for ever.

        Raises:
            InputError: the robot's number, its credentials, an endpoint or its port are not usable.
        """
        super().__init__(access, check_robot(robot), Inbox() if inbox is None else inbox, clock)
        self.robot = robot
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._listen(self.names.link(None, robot), self._take)
        self._watch()
        # Last, so that whoever sees this robot can send to it.
        self._token = self._session.liveliness().declare_token(
            self.names.alive(robot, str(self._session.zid()))
        )

    def send(self, peer: int, payload: bytes) -> None:
        """Send a datagram to a neighbour; it is lost if there is no link, or too much waits on it already.

        Waits 1 ms at most where a link does not keep up, or 50 ms for a payload above 48 kB.

        Raises:
            ValueError: the payload is too large.
        """
        self._put(self.names.link(self.robot, peer), payload, zenoh.Priority.INTERACTIVE_HIGH)

    def publish(self, topic: Topic, payload: bytes) -> None:
        """Tell whoever wants to know; lost as datagrams are, and after them in the queue.

        Raises:
            ValueError: the payload is too large.
        """
        self._put(self.names.topic(topic, self.robot), payload, zenoh.Priority.DATA)

    def answer_status(self, answer: Callable[[], bytes]) -> None:
        """Let ``answer`` tell the operator this robot's status; called in another thread, not to raise."""
        key = self.names.status(self.robot)

        def reply(query: zenoh.Query) -> None:
            with query:
                query.reply(key, answer())

        self._session.declare_queryable(key, reply)

    def answer_orders(self, take: Callable[[ToldOrder], None]) -> None:
        """Hand the operator's orders to ``take``, quick and in another thread; each is to be answered."""
        key = self.names.order(self.robot)

        def told(query: zenoh.Query) -> None:
            payload = query.payload
            if payload is None or len(payload) > MOST_STATUS:
                self.refused += 1
                return
            take(ToldOrder(payload.to_bytes(), partial(_reply, query, key)))

        self._session.declare_queryable(key, told)

    def _take(self, sample: zenoh.Sample) -> None:
        sender, payload = robot_of(str(sample.key_expr).split("/")[-2]), sample.payload
        if sender is None or len(payload) > MOST_PAYLOAD:
            self.refused += 1
            return
        self.inbox.put(ReceivedDatagram(sender, payload.to_bytes(), self.clock()))

    def _put(self, key: str, payload: bytes, priority: zenoh.Priority) -> None:
        if len(payload) > MOST_PAYLOAD:
            raise ValueError(f"payload of {len(payload)} bytes; at most {MOST_PAYLOAD} can be sent")
        try:
            self._publisher(key, priority).put(payload)
        except zenoh.ZError:  # closed, perhaps by another thread: lost like all that has no link
            if not self._session.is_closed():
                raise

    def _publisher(self, key: str, priority: zenoh.Priority) -> zenoh.Publisher:
        """Return the key's publisher: the key then travels once, not with every payload."""
        publisher = self._publishers.get(key)
        if publisher is None:
            publisher = self._publishers[key] = self._session.declare_publisher(
                key,
                congestion_control=zenoh.CongestionControl.DROP,
                priority=priority,
                express=True,
                allowed_destination=zenoh.Locality.REMOTE,
            )
        return publisher


class Operator(_Session):
    """The operator's session: sees who is there, hears what they publish, asks for their status."""

    def __init__(
        self, access: Access, inbox: Inbox | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Open the session; connecting goes on in the background, for ever.

        Raises:
            InputError: the credentials, an endpoint or its port are not usable.
        """
        super().__init__(access, None, Inbox() if inbox is None else inbox, clock)
        self._watch()

    def statuses(self, timeout: float = 1.0) -> dict[int, bytes]:
        """Ask all robots that a link is open to; return what those say that answer within ``timeout`` [s]."""
        return self._ask(self.names.status(None), None, timeout)

    def order(self, order: bytes, timeout: float = 2.0) -> dict[int, str]:
        """Give all robots that a link is open to an order; return what those say that answer in time."""
        answers = self._ask(self.names.order(None), order, timeout)
        return {robot: answer.decode(errors="replace")[:MOST_WORDS] for robot, answer in answers.items()}

    def _ask(self, key: str, payload: bytes | None, timeout: float) -> dict[int, bytes]:
        answers: dict[int, bytes] = {}
        for reply in self._session.get(key, payload=payload, target=zenoh.QueryTarget.ALL, timeout=timeout):
            if reply.ok is None:
                continue
            robot = robot_of(str(reply.ok.key_expr).rpartition("/")[2])
            if robot is None or len(reply.ok.payload) > MOST_STATUS:
                self.refused += 1
            else:
                answers[robot] = reply.ok.payload.to_bytes()
        return answers


def _reply(query: zenoh.Query, key: str, line: str) -> None:
    with query:
        query.reply(key, line.encode())


def _open(access: Access, robot: int | None) -> zenoh.Session:
    config = zenoh.Config()
    for path, value in settings(access, robot).items():
        config.insert_json5(path, json.dumps(value))
    check_listening(access.listening)
    check_connecting(access.connecting)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        reason = str(error).partition(" at /")[0]
        raise InputError(f"cannot open a session of team {access.team!r}: {reason}") from error
