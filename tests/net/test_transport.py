"""Sessions over the loopback: what arrives, what does not, and who is noticed to come and go."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
import zenoh

from tests.support.net_team import TEAM, Ports, issue, issue_for, real_time, wait_until
from vedette.errors import InputError, InputWarning
from vedette.net import (
    Access,
    Inbox,
    Operator,
    PeerGone,
    PeerSeen,
    Published,
    ReceivedDatagram,
    Topic,
    Transport,
)
from vedette.net.access import MOST_PAYLOAD, settings
from vedette.net.credentials import credentials
from vedette.net.endpoints import Endpoint, check_connecting, check_listening, free_port, parse_endpoint
from vedette.net.keys import issue_team
from vedette.net.names import Names

pytestmark = real_time

QUIET = 0.3  # after which nothing more is expected [s]
PROCESS = """
import sys, time
from vedette.net import Access, Transport
Transport(Access("office", ({!r},), insecure=True, lease={}), 1).send(0, b"")
print("open", flush=True)
time.sleep(60)
"""


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return issue(tmp_path_factory.mktemp("net") / "keys")


@pytest.fixture(params=["tcp", "tls"])
def ports(request: pytest.FixtureRequest, keys: Path) -> Ports:
    return Ports(keys if request.param == "tls" else None)


def datagrams(inbox: Inbox, wait: float = QUIET) -> list[tuple[int, bytes]]:
    """Take everything that comes until nothing has come for a while."""
    found = []
    while (event := inbox.get(wait)) is not None:
        if isinstance(event, ReceivedDatagram):
            found.append((event.robot, event.payload))
    return found


def assert_delivered(sender: Transport, receiver: Transport, payloads: Sequence[bytes]) -> None:
    """Check that all payloads arrive whole, in order and once.

    A busy host may lose some of a volley, so volleys are sent until nothing is missing.
    """
    missing = set(payloads)
    for _ in range(20):
        for payload in payloads:
            sender.send(receiver.robot, payload)
        volley = datagrams(receiver.inbox)
        expected = iter([(sender.robot, payload) for payload in payloads])
        assert all(datagram in expected for datagram in volley)
        missing -= {payload for _, payload in volley}
        if not missing:
            return
    raise AssertionError(f"{len(missing)} of {len(payloads)} payloads never arrived")


# -- datagrams -------------------------------------------------------------------------------------------


def test_datagrams_go_both_ways_whole_and_in_order_with_their_sender_and_time(ports: Ports) -> None:
    with (
        Transport(ports.access(0), 0, clock=lambda: 7.0) as a,
        Transport(ports.access(1, [0]), 1) as b,
    ):
        wait_until(lambda: a.peers == {1} and b.peers == {0})
        assert a.inbox.get(1.0) == PeerSeen(1, 7.0)
        sent = [bytes([k]) * size for k, size in enumerate((0, 1, 1000, 60_000, 300_000))]
        assert_delivered(b, a, sent)
        assert_delivered(a, b, sent)
        wait_until(lambda: b.send(0, b"now") or a.inbox.get(0.1) == ReceivedDatagram(1, b"now", 7.0))


def test_the_neighbour_of_a_neighbour_hears_and_sees_nothing(ports: Ports) -> None:
    with (
        Transport(ports.access(0), 0) as a,
        Transport(ports.access(1, [0]), 1) as b,
        Transport(ports.access(2, [1]), 2) as c,
    ):
        bodies: list[Published] = []
        c.subscribe(Topic.BODY, bodies.append)
        wait_until(lambda: a.peers == {1} and b.peers == {0, 2} and c.peers == {1})
        time.sleep(0.1)  # for the subscription to be known
        for sender in (a, b):
            sender.send(2, b"to robot 3")
            sender.publish(Topic.BODY, b"here")
        assert datagrams(c.inbox) == [(1, b"to robot 3")]
        assert [(body.robot, body.payload) for body in bodies] == [(1, b"here")]
        assert a.peers == c.peers == {1}


def test_both_may_connect_to_each_other_and_hear_everything_once(keys: Path) -> None:
    ports = Ports(keys)
    with Transport(ports.access(0, [1]), 0) as a, Transport(ports.access(1, [0]), 1) as b:
        wait_until(lambda: a.peers == {1} and b.peers == {0})
        time.sleep(0.5)  # for the second link to be tried
        assert_delivered(a, b, [bytes([k]) for k in range(20)])


def test_a_payload_that_is_too_large_is_refused() -> None:
    with Transport(Ports().access(0), 0) as a, pytest.raises(ValueError, match="at most"):
        a.send(1, bytes(MOST_PAYLOAD + 1))


def test_what_is_sent_after_closing_is_lost(ports: Ports) -> None:
    with Transport(ports.access(0), 0) as a, Transport(ports.access(1, [0]), 1) as b:
        wait_until(lambda: a.peers == {1} and b.peers == {0})
        reports: list[Published] = []
        b.subscribe(Topic.REPORT, reports.append)
        assert_delivered(a, b, [b"before"])
        a.close()
        a.send(1, b"after")
        a.publish(Topic.REPORT, b"after")
        assert (datagrams(b.inbox), reports) == ([], [])


def test_sending_to_a_frozen_peer_does_not_wait() -> None:
    ports = Ports()
    with Transport(ports.access(0, [1]), 0) as a, other_process(ports, lease=3.0) as other:
        wait_until(lambda: a.peers == {1})
        other.send_signal(signal.SIGSTOP)
        slowest = 0.0
        for _ in range(2000):
            begin = time.monotonic()
            a.send(1, bytes(10_000))
            slowest = max(slowest, time.monotonic() - begin)
            if a.peers != {1}:
                break
        assert slowest < 0.2


# -- who is there ----------------------------------------------------------------------------------------


@contextmanager
def other_process(ports: Ports, lease: float) -> Iterator[subprocess.Popen[str]]:
    """Run robot 1 in a process of its own."""
    code = PROCESS.format(ports.endpoint(1), lease)
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "open\n"
            yield process
        finally:
            os.kill(process.pid, signal.SIGKILL)


def test_a_session_that_is_closed_is_noticed_at_once(ports: Ports) -> None:
    with Transport(ports.access(0), 0) as a:
        b = Transport(ports.access(1, [0]), 1)
        wait_until(lambda: a.peers == {1})
        b.close()
        b.close()
        assert wait_until(lambda: not a.peers) < 0.5
        assert [type(a.inbox.get(1.0)) for _ in range(2)] == [PeerSeen, PeerGone]


def test_a_process_that_is_killed_is_noticed_within_a_second_and_again_when_it_is_back() -> None:
    ports = Ports()
    with Transport(ports.access(0, [1]), 0) as a:
        for _ in range(2):
            with other_process(ports, lease=10.0) as other:
                wait_until(lambda: a.peers == {1})  # although this robot was there first
                other.kill()
                assert wait_until(lambda: not a.peers) < 1.0


def test_a_process_that_is_frozen_is_noticed_after_its_lease() -> None:
    ports = Ports()
    with Transport(ports.access(0, [1], lease=0.6), 0) as a, other_process(ports, lease=0.6) as other:
        wait_until(lambda: a.peers == {1})
        other.send_signal(signal.SIGSTOP)
        assert 0.2 < wait_until(lambda: not a.peers) < 1.6
        other.send_signal(signal.SIGCONT)
        wait_until(lambda: a.peers == {1})


def test_a_robot_is_there_as_long_as_one_of_its_sessions_is() -> None:
    ports = Ports()
    with Transport(ports.access(0), 0) as a, ExitStack() as later:
        old = later.enter_context(Transport(Access(TEAM, (), (ports.endpoint(0),), insecure=True), 1))
        wait_until(lambda: a.peers == {1})
        new = later.enter_context(Transport(Access(TEAM, (), (ports.endpoint(0),), insecure=True), 1))
        wait_until(lambda: len(a._lives[1]) == 2)
        old.close()
        wait_until(lambda: len(a._lives[1]) == 1)
        new.close()
        wait_until(lambda: not a.peers)
        events = [type(a.inbox.get(0.1)) for _ in range(3)]
        assert events == [PeerSeen, PeerGone, type(None)]


# -- the operator ----------------------------------------------------------------------------------------


def test_the_operator_sees_everybody_hears_reports_and_asks_for_statuses(ports: Ports) -> None:
    with (
        Transport(ports.access(0), 0) as a,
        Transport(ports.access(1), 1) as b,
        Operator(ports.access(None, [0, 1])) as operator,
    ):
        operator.subscribe(Topic.REPORT, operator.inbox.put)
        a.answer_status(lambda: b"well")
        b.answer_status(lambda: b"tired")
        wait_until(lambda: operator.peers == {0, 1})
        wait_until(lambda: operator.statuses() == {0: b"well", 1: b"tired"})
        a.publish(Topic.REPORT, b"news")
        events = [operator.inbox.get(1.0) for _ in range(3)]
        told = [event for event in events if isinstance(event, Published)]
        assert [(event.topic, event.robot, event.payload) for event in told] == [(Topic.REPORT, 0, b"news")]
        assert a.peers == b.peers == set()


# -- the inbox -------------------------------------------------------------------------------------------


def test_a_full_inbox_drops_datagrams_and_keeps_the_latest_news_of_peers() -> None:
    inbox = Inbox(most_events=3, most_bytes=100)
    for k in range(5):
        inbox.put(ReceivedDatagram(k, b"", 0.0))
    inbox.put(PeerGone(0, 1.0))
    assert inbox.dropped == 3
    assert [inbox.get(0) for _ in range(4)] == [
        ReceivedDatagram(1, b"", 0.0),
        ReceivedDatagram(2, b"", 0.0),
        PeerGone(0, 1.0),
        None,
    ]


def test_an_inbox_holds_no_more_bytes_than_it_may() -> None:
    inbox = Inbox(most_events=100, most_bytes=100)
    for _ in range(3):
        inbox.put(ReceivedDatagram(0, bytes(60), 0.0))
    assert inbox.dropped == 2
    assert inbox.get(0) is not None
    inbox.put(ReceivedDatagram(0, bytes(100), 0.0))
    assert inbox.dropped == 2


# -- security --------------------------------------------------------------------------------------------


@contextmanager
def rogue(access: Access, robot: int | None, **changes: object) -> Iterator[zenoh.Session]:
    """Open a session as a robot's keys allow, that keeps no rules of its own."""
    config = zenoh.Config()
    chosen = {**settings(access, robot), "access_control": {"enabled": False}, **changes}
    for path, value in chosen.items():
        config.insert_json5(path, json.dumps(value))
    with zenoh.open(config) as session:
        yield session


def spy(session: zenoh.Session) -> list[str]:
    """Listen to everything that a session can hear, tokens included; return the keys as they come."""
    heard: list[str] = []
    known = [Names(TEAM).link(None, k) for k in range(3)] + [
        Names(TEAM).topic(topic, None) for topic in Topic
    ]

    def note(sample: zenoh.Sample) -> None:
        heard.append(str(sample.key_expr))

    for key in ("**", "vedette/**", f"vedette/{TEAM}/**", *known):
        session.declare_subscriber(key, note, allowed_origin=zenoh.Locality.REMOTE)
    session.liveliness().declare_subscriber("vedette/**", note, history=True)
    return heard


def test_without_a_valid_certificate_of_the_team_nothing_is_read_or_written(
    keys: Path, tmp_path: Path
) -> None:
    ports, yesterday = Ports(keys), datetime.now(UTC) - timedelta(days=2)
    issue(tmp_path / "foreign")
    issue_team(TEAM, tmp_path / "expired", 3, yesterday, days=1)
    # Expired keys of the team's own authority: its old leaf certificates under the same root.
    expired = issue_for(keys, tmp_path / "old" / "robot-2", -timedelta(days=1))
    tls = settings(ports.access(1), 1)["transport/link/tls"]
    own = {name: value for name, value in tls.items() if name.startswith("root")}
    attempts: dict[str, object] = {
        "no certificate": {**own, "verify_name_on_connect": False},
        "foreign certificate": with_keys(tls, tmp_path / "foreign" / "robot-2", own),
        "foreign team": with_keys(tls, tmp_path / "foreign" / "robot-2", {}),
        "expired certificate": with_keys(tls, expired, own),
        "expired team": with_keys(tls, tmp_path / "expired" / "robot-2", {}),
    }
    with Transport(ports.access(0), 0) as a, ExitStack() as stack:
        a.answer_status(lambda: b"secret")
        sessions = [
            stack.enter_context(
                rogue(ports.access(1, [0]), 1, **{"transport/link/tls": attempt, "listen/endpoints": []})
            )
            for attempt in attempts.values()
        ]
        plain = Access(TEAM, (), (ports.endpoint(0).replace("tls", "tcp"),), insecure=True)
        sessions.append(stack.enter_context(rogue(plain, 1)))
        heard = [spy(session) for session in sessions]
        with Transport(ports.access(2, [0]), 2):  # one who may is let in at the same time
            wait_until(lambda: a.peers == {2})
        time.sleep(0.5)
        for session in sessions:
            session.put(f"vedette/{TEAM}/link/2/1", b"lie")
        a.send(1, b"secret")
        a.publish(Topic.REPORT, b"secret")
        assert datagrams(a.inbox) == []
        assert heard == [[] for _ in sessions]
        assert [session.info.peers_zid() for session in sessions] == [[] for _ in sessions]
        assert [list(session.get("vedette/**", timeout=0.1)) for session in sessions] == [
            [] for _ in sessions
        ]


def with_keys(tls: dict[str, object], folder: Path, change: dict[str, object]) -> dict[str, object]:
    files = {"certificate": "cert.pem", "private_key": "key.pem"}
    its = {
        f"{end}_{what}": str(folder / file) for end in ("listen", "connect") for what, file in files.items()
    }
    return {**tls, **its, "root_ca_certificate": str(folder / "ca.pem"), **change}


def test_a_robot_speaks_for_itself_alone_and_hears_what_is_meant_for_it(keys: Path) -> None:
    ports = Ports(keys)
    with (
        Transport(ports.access(0), 0) as a,
        rogue(ports.access(1, [0]), 1) as session,
    ):
        heard = spy(session)
        a.answer_status(lambda: b"secret")
        tokens = [session.liveliness().declare_token(f"vedette/{TEAM}/alive/{k}/x") for k in (2, 3)]
        wait_until(lambda: a.peers and heard)
        wait_until(lambda: matches(session, f"vedette/{TEAM}/link/2/1"))
        for key in ("link/3/1", "link/*/1", "link/1/1", "link/**", "link/operator/1", "link/2/1"):
            session.put(f"vedette/{TEAM}/{key}", key.encode())
        session.delete(f"vedette/{TEAM}/link/2/1")
        for peer in (1, 2):
            a.send(peer, b"to you alone")
        a.publish(Topic.REPORT, b"for the operator")
        assert datagrams(a.inbox) == [(1, b"link/2/1")]
        assert a.peers == {1}
        assert messages(heard) == {f"vedette/{TEAM}/link/1/2"}
        assert list(session.get(f"vedette/{TEAM}/status/*", timeout=0.2)) == []
        del tokens


def messages(keys: list[str]) -> set[str]:
    return {key for key in keys if "/alive/" not in key}


def matches(session: zenoh.Session, key: str) -> bool:
    status = session.declare_publisher(key).matching_status  # the stubs take it for a bool
    return bool(status.matching)  # type: ignore[attr-defined]


def test_the_operator_hears_everything_and_says_nothing(keys: Path) -> None:
    ports = Ports(keys)
    with (
        Transport(ports.access(0), 0) as a,
        Transport(ports.access(1, [0]), 1) as b,
        rogue(ports.access(None, [0, 1]), None) as session,
    ):
        heard = spy(session)
        wait_until(lambda: len(heard) == 2 and a.peers == {1} and b.peers == {0})
        time.sleep(0.1)
        for key in ("link/2/1", "link/operator/1", "report/1", "body/2", "alive/2/x"):
            session.put(f"vedette/{TEAM}/{key}", b"lie")
        token = session.liveliness().declare_token(f"vedette/{TEAM}/alive/3/x")
        b.send(0, b"truth")
        a.publish(Topic.REPORT, b"news")
        assert datagrams(a.inbox) == [(1, b"truth")]
        assert a.peers == {1}
        assert messages(heard) == {f"vedette/{TEAM}/link/2/1", f"vedette/{TEAM}/report/1"}
        del token


def test_no_robot_can_report_or_answer_to_the_operator_as_another(keys: Path) -> None:
    ports = Ports(keys)
    with rogue(ports.access(1), 1) as session, Operator(ports.access(None, [1])) as operator:
        told: list[Published] = []
        operator.subscribe(Topic.REPORT, told.append)

        def reply(query: zenoh.Query) -> None:
            with query:
                for robot in (2, 3):
                    query.reply(f"vedette/{TEAM}/status/{robot}", b"fine")

        token = session.liveliness().declare_token(f"vedette/{TEAM}/alive/2/x")
        queryables = [session.declare_queryable(f"vedette/{TEAM}/status/{k}", reply) for k in (2, 3)]
        wait_until(lambda: operator.peers == {1} and operator.statuses(0.5))
        assert operator.statuses(0.5) == {1: b"fine"}
        wait_until(lambda: matches(session, f"vedette/{TEAM}/report/2"))
        for robot in (3, 2):
            session.put(f"vedette/{TEAM}/report/{robot}", b"fine")
        wait_until(lambda: told)
        time.sleep(QUIET)
        assert [(one.robot, one.payload) for one in told] == [(1, b"fine")]
        del queryables, token


def test_a_link_ends_when_a_certificate_does(tmp_path: Path) -> None:
    now = datetime.now(UTC)
    issue_team(TEAM, tmp_path / "keys", 2, now - timedelta(days=1, seconds=-3), days=1)
    ports = Ports(tmp_path / "keys")
    with Transport(ports.access(0), 0) as a, Transport(ports.access(1, [0]), 1):
        wait_until(lambda: a.peers == {1}, 2.0)
        wait_until(lambda: not a.peers)
        time.sleep(QUIET)  # in which it is tried again
        assert not a.peers


def test_plain_tcp_comes_only_when_asked_for_by_name() -> None:
    with pytest.raises(InputError, match="insecure"):
        Access(TEAM)
    with pytest.raises(InputError, match="insecure"):
        Access(TEAM, ("tcp/127.0.0.1:7447",), insecure=False, credentials=None)


# -- bad input -------------------------------------------------------------------------------------------


def test_a_port_in_use_a_foreign_address_and_an_unknown_host_are_told_in_one_line() -> None:
    ports = Ports()
    with Transport(ports.access(0), 0):
        for access, reason in [
            (ports.access(0), "in use"),
            (Access(TEAM, ("tcp/203.0.113.7:7447",), insecure=True), "no such address"),
            (Access(TEAM, (), ("tcp/0.0.0.0:7447",), insecure=True), "name the other robot"),
            (Access(TEAM, ("tcp/no-such-host.invalid:7447",), insecure=True), "cannot listen"),
        ]:
            with pytest.raises(InputError, match=reason) as caught:
                Transport(access, 0)
            assert "\n" not in str(caught.value)
            assert ".rs" not in str(caught.value)


def test_credentials_of_somebody_else_are_refused(keys: Path) -> None:
    mine = credentials(keys / "robot-2", datetime.now(UTC))
    with pytest.raises(InputError, match="robot-2, not for"):
        Transport(Access(TEAM, credentials=mine), 0)
    with pytest.raises(InputError, match="is of team"):
        Access("other", credentials=mine)
    with pytest.raises(InputError, match="leave out one"):
        Access(TEAM, credentials=mine, insecure=True)
    with pytest.raises(InputError, match="beyond the team's size"):
        Transport(Access(TEAM, credentials=mine, robots=1), 1)


@pytest.mark.parametrize("robot", [-1, 65536])
def test_a_robot_that_cannot_be_is_refused(robot: int) -> None:
    with pytest.raises(InputError, match=r"1\.\.65536"):
        Transport(Access(TEAM, insecure=True), robot)


@pytest.mark.parametrize(
    ("text", "endpoint"),
    [
        ("tls/192.168.1.7:7447", Endpoint("tls", "192.168.1.7", 7447)),
        ("tls/robot-2.local:1", Endpoint("tls", "robot-2.local", 1)),
        ("tls/[::1]:65535", Endpoint("tls", "::1", 65535)),
    ],
)
def test_an_endpoint_is_read_and_written_alike(text: str, endpoint: Endpoint) -> None:
    assert parse_endpoint(text) == endpoint
    assert str(endpoint) == text


@pytest.mark.parametrize(
    "text",
    [
        "", "tls", "tls/", "tls/host", "tls/host:", "host:7447", "tls/host:0", "tls/host:65536", "tls/:7447",
        "tls/a b:7447", "tls/1.2.3:7447", "tls/1.2.3.999:7447", "tls/[zz]:7447", "tls/-x:7447",
        "udp/host:7447", "tcp/host:7447", "tls/host:7447#iface=lo", "tls/host:7447?rel=0",
        "tls/host:７447", "tls/h\nx:7447",
    ],
)  # fmt: skip
def test_a_bad_endpoint_is_told_in_one_line(text: str) -> None:
    with pytest.raises(InputError, match="endpoint") as caught:
        parse_endpoint(text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        *(({"team": team}, "team must be 1 to 32 letters") for team in ("a/b", "", "x" * 33, "**")),
        *(({"lease": lease}, "lease must lie in 0.2..60 s") for lease in (0.0, float("nan"))),
        ({"robots": 0}, "robots must lie in 1..65536; got 0"),
        ({"listen": ("tls/127.0.0.1:7447",)}, "cannot use 'tls'"),
        ({"connect": ("x",)}, "endpoint must be tcp/HOST:PORT"),
    ],
)
def test_bad_access_is_refused(bad: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        Access(**{"team": TEAM, "insecure": True, **bad})  # type: ignore[arg-type]


@pytest.mark.parametrize("host", ["robot-2.local", "no-such-host.invalid", "robot-2"])
def test_a_name_that_does_not_resolve_yet_is_told_and_keeps_nobody_from_starting(
    monkeypatch: pytest.MonkeyPatch, host: str
) -> None:
    def nobody(*_: object, **__: object) -> None:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    listen = f"tcp/127.0.0.1:{free_port()}"
    monkeypatch.setattr(socket, "getaddrinfo", nobody)
    with pytest.warns(InputWarning, match=f"tcp/{host}:7447: there is no host of that name yet; it is tried"):
        check_connecting([parse_endpoint(f"tcp/{host}:7447", insecure=True)])
    with pytest.raises(InputError, match=r"cannot listen on .*: there is no host of that name; correct it"):
        check_listening([parse_endpoint(listen, insecure=True)])


def test_a_robot_whose_mate_has_no_address_yet_starts_and_listens() -> None:
    access = Access(
        TEAM, (f"tcp/127.0.0.1:{free_port()}",), ("tcp/no-such-host.invalid:7447",), insecure=True
    )
    other = Access(TEAM, connect=access.listen, insecure=True)
    with pytest.warns(InputWarning, match="no host of that name yet"):
        a = Transport(access, 0)
    with a, Transport(other, 1) as b:
        wait_until(lambda: a.peers == {1} and b.peers == {0})


def test_a_free_port_can_be_listened_on() -> None:
    with Transport(Access(TEAM, (f"tcp/127.0.0.1:{free_port()}",), insecure=True), 0) as a:
        assert not a.peers
