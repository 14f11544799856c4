"""How a session is configured: where it connects, and who may send what to whom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

from vedette.errors import InputError
from vedette.net.credentials import Credentials
from vedette.net.endpoints import INSECURE, SECURE, Endpoint, parse_endpoint
from vedette.net.names import MOST_ROBOTS, Names, Topic, check_team

MOST_PAYLOAD = (1 << 24) + 1024  # [bytes]
RETRY = {"period_init_ms": 250, "period_max_ms": 1000, "period_increase_factor": 1.5}
PENDING_TIMEOUT = 10_000  # for a link to be opened, or a stranger to show its certificate [ms]

Settings: TypeAlias = dict[str, Any]
Rule: TypeAlias = tuple[str, list[str], list[str]]  # flow, messages, key expressions

_ANY_WATCH = ["declare_liveliness_subscriber", "liveliness_query"]


@dataclass(frozen=True)
class Access:
    """What one session needs to take part in a team."""

    team: str
    listen: tuple[str, ...] = ()  # endpoints
    connect: tuple[str, ...] = ()  # endpoints, tried again for ever
    credentials: Credentials | None = None
    insecure: bool = False  # plain TCP, open to everybody who reaches the port
    robots: int = 64  # those numbered higher are not let in; each costs 1.3 ms and 0.1 MB when opening
    lease: float = 3.0  # silence after which a peer counts as gone [s]
    scouting: bool = False  # find peers by multicast as well

    def __post_init__(self) -> None:
        """Refuse what cannot work.

        Raises:
            InputError: bad team, endpoint, lease or number of robots; no credentials, or another team's.
        """
        check_team(self.team)
        if not 0.2 <= self.lease <= 60:
            raise InputError(f"lease must lie in 0.2..60 s; got {self.lease}")
        if not 1 <= self.robots <= MOST_ROBOTS:
            raise InputError(f"robots must lie in 1..{MOST_ROBOTS}; got {self.robots}")
        if self.credentials is None and not self.insecure:
            raise InputError("no credentials; make them with 'vedette keys', or say 'insecure: true'")
        if self.credentials is not None and self.insecure:
            raise InputError("'insecure: true' would not use the credentials; leave out one of them")
        if self.credentials is not None and self.credentials.team != self.team:
            raise InputError(
                f"{self.credentials.folder} is of team {self.credentials.team!r}, not {self.team!r}"
            )
        _ = self.listening, self.connecting

    @cached_property
    def listening(self) -> tuple[Endpoint, ...]:
        """``listen``, parsed."""
        return tuple(parse_endpoint(text, self.insecure) for text in self.listen)

    @cached_property
    def connecting(self) -> tuple[Endpoint, ...]:
        """``connect``, parsed."""
        return tuple(parse_endpoint(text, self.insecure) for text in self.connect)

    @property
    def names(self) -> Names:
        """The team's keys."""
        return Names(self.team)


def settings(access: Access, robot: int | None) -> Settings:
    """Return the Zenoh configuration of a robot's session, or of the operator's if None, by path.

    Raises:
        InputError: the credentials are somebody else's, or the robot is beyond the team's size.
    """
    who = access.names.certificate(robot)
    if robot is not None and not 0 <= robot < access.robots:
        raise InputError(f"{who} is beyond the team's size, {access.robots}; set 'robots' higher")
    result: Settings = {
        "mode": "peer",
        "listen/endpoints": [str(endpoint) for endpoint in access.listening],
        "listen/timeout_ms": 0,
        "listen/exit_on_failure": True,
        "connect/endpoints": [str(endpoint) for endpoint in access.connecting],
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": RETRY,
        "scouting/multicast/enabled": access.scouting,
        "scouting/gossip/enabled": False,
        "open/return_conditions": {"connect_scouted": False, "declares": False},
        "timestamping/enabled": False,
        "adminspace/enabled": False,
        "transport/shared_memory/enabled": False,
        "transport/unicast/accept_timeout": PENDING_TIMEOUT,
        "transport/unicast/open_timeout": PENDING_TIMEOUT,
        "transport/link/protocols": [INSECURE if access.insecure else SECURE],
        "transport/link/rx/max_message_size": MOST_PAYLOAD,
        "transport/link/tx/lease": round(1000 * access.lease),
        "transport/link/tx/keep_alive": 4,
    }
    if access.credentials is not None:
        if access.credentials.robot != robot:
            raise InputError(f"{access.credentials.folder} is for {access.credentials.name}, not for {who}")
        result["transport/link/tls"] = _tls(access.credentials)
        result["access_control"] = access_control(
            access.names, robot, access.robots, access.credentials.revoked.robots
        )
    return result


def _tls(credentials: Credentials) -> Settings:
    """Both ends show a certificate of the team's own authority.

    Names of hosts are not compared: robots change addresses, the authority signs nobody but the team, and
    what a session may do hangs on its certificate's common name, not on where it is.
    """
    return {
        "root_ca_certificate": str(credentials.folder / "ca.pem"),
        "listen_certificate": str(credentials.folder / "cert.pem"),
        "listen_private_key": str(credentials.folder / "key.pem"),
        "connect_certificate": str(credentials.folder / "cert.pem"),
        "connect_private_key": str(credentials.folder / "key.pem"),
        "enable_mtls": True,
        "verify_name_on_connect": False,
        "close_link_on_expiration": True,
    }


def access_control(
    names: Names, robot: int | None, robots: int, revoked: frozenset[int] = frozenset()
) -> Settings:
    """Return the rules by which a session judges the others: deny all but what each needs.

    A robot's own rules protect it from everybody else, whatever rules those have: robot j takes from robot i
    only what i may say in its own name and to j, and nothing from one whose certificate is ``revoked``.
    """
    others = [i for i in range(robots) if i != robot and i not in revoked]
    if robot is None:
        return _as_policy(names, [(i, _robot_to_operator(names, i)) for i in others])
    mates = [(i, _robot_to_robot(names, robot, i)) for i in others]
    return _as_policy(names, [*mates, (None, _operator_to_robot(names, robot))])


def _robot_to_robot(names: Names, me: int, peer: int) -> list[Rule]:
    """What ``me`` takes from a robot, and lets it have."""
    subscriptions = [names.link(None, peer), names.topic(Topic.BODY, None)]
    own_subscriptions = [names.link(None, me), names.topic(Topic.BODY, None)]
    return [
        ("ingress", ["put"], [names.link(peer, me), names.topic(Topic.BODY, peer)]),
        ("ingress", ["liveliness_token"], [names.alive(peer)]),
        ("ingress", ["declare_subscriber"], subscriptions),
        ("ingress", _ANY_WATCH, [names.alive(None)]),
        ("egress", ["put"], [names.link(me, peer), names.topic(Topic.BODY, me)]),
        ("egress", ["liveliness_token"], [names.alive(me)]),
        ("egress", ["declare_subscriber"], own_subscriptions),
        ("egress", _ANY_WATCH, [names.alive(None)]),
    ]


def _operator_to_robot(names: Names, me: int) -> list[Rule]:
    """What ``me`` takes from the operator, who may hear everything, and say nothing but orders."""
    heard = [names.link(me, None), *(names.topic(topic, me) for topic in Topic)]
    return [
        ("ingress", ["declare_subscriber"], [names.everything()]),
        ("ingress", ["query"], [names.status(None), names.order(None)]),
        ("ingress", _ANY_WATCH, [names.alive(None)]),
        ("egress", ["put"], heard),
        ("egress", ["liveliness_token"], [names.alive(me)]),
        ("egress", ["declare_queryable", "reply"], [names.status(me), names.order(me)]),
    ]


def _robot_to_operator(names: Names, peer: int) -> list[Rule]:
    """What the operator takes from a robot."""
    heard = [names.link(peer, None), *(names.topic(topic, peer) for topic in Topic)]
    return [
        ("ingress", ["put"], heard),
        ("ingress", ["liveliness_token"], [names.alive(peer)]),
        ("ingress", ["declare_queryable", "reply"], [names.status(peer), names.order(peer)]),
        ("egress", ["declare_subscriber"], [names.everything()]),
        ("egress", ["query"], [names.status(None), names.order(None)]),
        ("egress", _ANY_WATCH, [names.alive(None)]),
    ]


def _as_policy(names: Names, rules: Sequence[tuple[int | None, list[Rule]]]) -> Settings:
    """Write each peer's rules, None for the operator, as Zenoh wants them."""
    listed, subjects, policies = [], [], []
    for peer, its in rules:
        subject = names.certificate(peer)
        subjects.append({"id": subject, "cert_common_names": [subject]})
        labels = [f"{subject} {number}" for number in range(len(its))]
        policies.append({"subjects": [subject], "rules": labels})
        for label, (flow, messages, keys) in zip(labels, its, strict=True):
            listed.append(
                {"id": label, "permission": "allow", "flows": [flow], "messages": messages, "key_exprs": keys}
            )
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": listed,
        "subjects": subjects,
        "policies": policies,
    }
