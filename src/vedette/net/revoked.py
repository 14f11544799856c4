"""Whose certificates a team has revoked: a list that its authority signs, beside each robot's keys."""

from __future__ import annotations

from base64 import b64decode, b64encode
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from msgspec import Meta, Struct

from vedette.errors import InputError
from vedette.maps.atomic import atomic_path
from vedette.net.names import MOST_ROBOTS

REVOKED = "revoked.txt"
MOST_LIST = 1 << 20  # bytes
_SIGNED_WITH = ec.ECDSA(hashes.SHA256())


class _List(Struct, forbid_unknown_fields=True, frozen=True):
    """What is signed."""

    team: str
    number: Annotated[int, Meta(ge=1, lt=1 << 53)]
    robots: tuple[Annotated[int, Meta(ge=1, le=MOST_ROBOTS)], ...]  # counted from 1


@dataclass(frozen=True)
class Revoked:
    """A list of robots whose certificates count no more. Each is longer than the one before."""

    number: int = 0  # of the list; 0: none has been revoked yet
    robots: frozenset[int] = frozenset()
    text: bytes = b""  # as it was signed


NONE = Revoked()


def signed(team: str, number: int, robots: frozenset[int], key: ec.EllipticCurvePrivateKey) -> Revoked:
    """Return a list with its authority's signature: a line of JSON, and one of base 64."""
    told = msgspec.json.encode(_List(team, number, tuple(robot + 1 for robot in sorted(robots))))
    return Revoked(number, robots, told + b"\n" + b64encode(key.sign(told, _SIGNED_WITH)) + b"\n")


def number_of(text: bytes) -> int:
    """Return the number of a list, whoever has signed it.

    Raises:
        ValueError: it is no list.
    """
    return _told(text)[1].number


def checked(text: bytes, authority: x509.Certificate, team: str) -> Revoked:
    """Return the list that a text is.

    Raises:
        ValueError: it is none, or not signed by the team's authority.
    """
    line, told, signature = _told(text)
    key = authority.public_key()
    if not isinstance(key, ec.EllipticCurvePublicKey) or told.team != team:
        raise ValueError(f"a list of team {told.team[:40]!r}, not of {team!r}")
    try:
        key.verify(b64decode(signature), line, _SIGNED_WITH)
    except InvalidSignature:
        raise ValueError("a list that the team's authority has not signed") from None
    return Revoked(told.number, frozenset(robot - 1 for robot in told.robots), text)


def load_revoked(folder: Path, authority: x509.Certificate, team: str) -> Revoked:
    """Return the list in a folder of keys; an empty one if there is none.

    Raises:
        InputError: it cannot be read, or is not one of this authority.
    """
    path = folder / REVOKED
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        return NONE
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}; copy it again") from error
    try:
        return checked(text, authority, team)
    except ValueError as error:
        raise InputError(f"{path}: {error}; copy it again, as 'vedette keys revoke' has written it") from None


def put_beside_keys(folder: Path) -> None:
    """Copy an authority's list, if there is one, into the folder of every holder that is still there.

    Raises:
        InputError: one cannot be written.
    """
    listed = folder / REVOKED
    if listed.exists():
        for holder in (path for path in folder.iterdir() if path.is_dir()):
            with atomic_path(holder / REVOKED) as part:
                part.write_bytes(listed.read_bytes())


def _told(text: bytes) -> tuple[bytes, _List, bytes]:
    line, _, rest = text.partition(b"\n")
    if len(text) > MOST_LIST or not rest.endswith(b"\n"):
        raise ValueError("no list of revoked certificates")
    try:
        return line, msgspec.json.decode(line, type=_List), rest[:-1]
    except msgspec.DecodeError as error:
        raise ValueError(f"no list of revoked certificates: {error}") from None
