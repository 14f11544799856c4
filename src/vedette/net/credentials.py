"""What admits one robot, or the operator, to a team: a certificate, its key, and the team's authority."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.net.names import OPERATOR, Names, check_team, robot_of
from vedette.net.revoked import NONE, Revoked, load_revoked

CA, CERT, KEY = "ca.pem", "cert.pem", "key.pem"
MOST_FILE = 100_000  # [bytes]
_HOLDER = re.compile(rf"robot-(\d+)|{OPERATOR}")


@dataclass(frozen=True)
class Credentials:
    """A folder whose files admit one robot, or the operator, to a team."""

    folder: Path
    team: str
    robot: int | None  # None: the operator
    expires: datetime
    revoked: Revoked = NONE  # whose certificates of this team count no more

    @property
    def name(self) -> str:
        """Common name of the certificate."""
        return Names(self.team).certificate(self.robot)


def credentials(folder: Path | str, now: datetime) -> Credentials:
    """Return whom the files in ``folder`` admit, and to which team; ``now`` has a time zone.

    Raises:
        InputError: a file is missing, unreadable or not what it should be, the certificate is not valid now
            or revoked, or not of this authority, or the key is another's; the line says which.
    """
    folder = Path(folder)
    authority, certificate = load_certificate(folder / CA), load_certificate(folder / CERT)
    key = load_key(folder / KEY)
    try:
        certificate.verify_directly_issued_by(authority)
    except (ValueError, TypeError, InvalidSignature):
        raise InputError(
            f"{folder / CERT} was not issued by {folder / CA}; take both from one team"
        ) from None
    if certificate.public_key() != key.public_key():
        raise InputError(f"{folder / KEY} is not the key of {folder / CERT}; copy the folder whole")
    _check_time(folder / CA, authority, now)
    _check_time(folder / CERT, certificate, now)
    team, _, holder = common_name(certificate).rpartition("/")
    found = _HOLDER.fullmatch(holder)
    robot = robot_of(found[1]) if found and found[1] else None
    if found is None or (robot is None and holder != OPERATOR):
        raise InputError(f"{folder / CERT} names neither a robot nor the operator; use 'vedette keys'")
    revoked = load_revoked(folder, authority, team)
    if robot in revoked.robots:
        raise InputError(f"{folder / CERT} has been revoked; ask whoever keeps the team's keys for new ones")
    expires = min(certificate.not_valid_after_utc, authority.not_valid_after_utc)
    return Credentials(folder, check_team(team), robot, expires, revoked)


def _check_time(path: Path, certificate: x509.Certificate, now: datetime) -> None:
    first, last = certificate.not_valid_before_utc, certificate.not_valid_after_utc
    if now > last:
        raise InputError(f"{path} expired on {last:%Y-%m-%d}; issue new ones with 'vedette keys'")
    if now < first:
        raise InputError(f"{path} is valid from {first:%Y-%m-%d}, but the clock says {now:%Y-%m-%d}; set it")


def load_certificate(path: Path) -> x509.Certificate:
    """Read a PEM certificate.

    Raises:
        InputError: missing, unreadable, or not one.
    """
    pem = read(path)
    try:
        return x509.load_pem_x509_certificate(pem)
    except (ValueError, UnsupportedAlgorithm):
        raise InputError(f"{path} is not a PEM certificate; copy it again") from None


def load_key(path: Path) -> ec.EllipticCurvePrivateKey:
    """Read a private key.

    Raises:
        InputError: missing, unreadable, encrypted, or of another kind.
    """
    pem = read(path)
    try:
        key = serialization.load_pem_private_key(pem, password=None)
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise InputError(f"{path} is not an unencrypted PEM private key; copy it again") from None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise InputError(f"{path} is not an elliptic-curve key; make keys with 'vedette keys'")
    return key


def common_name(certificate: x509.Certificate) -> str:
    """Return the holder's common name; empty if it has none."""
    names = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    return str(names[0].value) if names else ""


def read(path: Path, most: int = MOST_FILE) -> bytes:
    """Return the first ``most`` bytes of a file.

    Raises:
        InputError: it cannot be read.
    """
    try:
        with open_input(path) as file:
            return file.read(most)
    except InputError as error:
        raise InputError(f"{error}; copy the folder whole") from error
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}; copy the folder whole") from error
