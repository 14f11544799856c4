"""Endpoints, as Zenoh writes them: ``tls/robot-2.local:7447``."""

from __future__ import annotations

import errno
import ipaddress
import re
import socket
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from vedette.errors import InputError, InputWarning

SECURE, INSECURE = "tls", "tcp"
_FORM = re.compile(r"(?P<protocol>[a-z0-9-]+)/(?P<host>\[[0-9A-Fa-f:.]+\]|[^\s/:\[\]#?]+):(?P<port>[0-9]+)")
_NAME = re.compile(r"(?!-)[A-Za-z0-9_-]{1,63}(?:\.[A-Za-z0-9_-]{1,63})*\.?")


@dataclass(frozen=True)
class Endpoint:
    """Where a session listens or connects to."""

    protocol: str  # "tls" or "tcp"
    host: str  # name or address; without the brackets of IPv6
    port: int

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.protocol}/{host}:{self.port}"


def is_loopback(text: str) -> bool:
    """Tell whether an endpoint, as it is written, is on this computer alone."""
    found = _FORM.fullmatch(text.strip())
    host = "" if found is None else found["host"].strip("[]")
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def parse_endpoint(text: str, insecure: bool = False) -> Endpoint:
    """Return the endpoint that ``text`` writes, ``tls/HOST:PORT``, or ``tcp/HOST:PORT`` where ``insecure``.

    Zenoh's ``?`` and ``#`` suffixes are refused: they could switch off what the rest of the configuration
    switches on. So is port 0: nobody could be told where to connect.

    Raises:
        InputError: not of that form, or the other protocol.
    """
    wanted = INSECURE if insecure else SECURE
    found = _FORM.fullmatch(text.strip())
    if found is None:
        raise InputError(
            f"endpoint must be {wanted}/HOST:PORT, such as {wanted}/192.168.1.7:7447; got {text!r}"
        )
    protocol, host, port = found["protocol"], found["host"].strip("[]"), int(found["port"])
    if protocol != wanted:
        reason = "plain TCP needs 'insecure: true'" if protocol == INSECURE else "known: tls, tcp"
        reason = "'insecure: true' means tcp/" if protocol == SECURE else reason
        raise InputError(f"endpoint {text!r}: cannot use {protocol!r}; {reason}")
    if not 1 <= port <= 65535:
        raise InputError(f"endpoint {text!r}: the port must lie in 1..65535")
    if not _is_host(host):
        raise InputError(f"endpoint {text!r}: {host!r} is neither an address nor the name of a host")
    return Endpoint(protocol, host, port)


def check_listening(endpoints: Iterable[Endpoint]) -> None:
    """Make sure that each can be listened on.

    Raises:
        InputError: in use, not an address of this machine, not allowed, or a name that does not resolve.
    """
    for endpoint in endpoints:
        try:
            family, address = _resolve(endpoint)
            with socket.socket(family, socket.SOCK_STREAM) as trial:
                trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                trial.bind(address)
                trial.listen(1)
        except OSError as error:
            raise InputError(f"cannot listen on {endpoint}: {_reason(error)}") from error


def check_connecting(endpoints: Iterable[Endpoint]) -> None:
    """Look whether each host is known; one that is not, or cannot be reached, is tried again for ever.

    Raises:
        InputError: a host is the address to listen on everywhere.

    Warns:
        InputWarning: there is no host of that name now; it may be misspelt, or not up yet.
    """
    for endpoint in endpoints:
        if endpoint.host in ("0.0.0.0", "::"):
            raise InputError(f"cannot connect to {endpoint}: name the other robot's host")
        try:
            _resolve(endpoint)
        except socket.gaierror:
            text = f"{endpoint}: there is no host of that name yet; it is tried again until there is"
            warnings.warn(text, InputWarning, stacklevel=4)


def free_port() -> int:
    """Return a TCP port of the loopback interface that nobody listens on at the moment."""
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return int(trial.getsockname()[1])


def _is_host(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        looks_numeric = re.fullmatch(r"[0-9.]+", host)
        return looks_numeric is None and len(host) <= 253 and _NAME.fullmatch(host) is not None
    return True


def _resolve(endpoint: Endpoint) -> tuple[socket.AddressFamily, Any]:
    family, *_, address = socket.getaddrinfo(endpoint.host, endpoint.port, type=socket.SOCK_STREAM)[0]
    return family, address


def _reason(error: OSError) -> str:
    if isinstance(error, socket.gaierror):
        return "there is no host of that name; correct it, or write its address"
    return {
        errno.EADDRINUSE: "the port is in use; choose another, or stop the process that has it",
        errno.EADDRNOTAVAIL: "this machine has no such address; 0.0.0.0 listens on all that it has",
        errno.EACCES: "not allowed; choose a port above 1023",
    }.get(error.errno or 0, error.strerror or str(error))
