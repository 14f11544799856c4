"""Make a team's keys: an authority of its own, one certificate a robot, and one for the operator."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from tempfile import TemporaryDirectory

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from vedette.errors import InputError
from vedette.maps.atomic import atomic_path
from vedette.net.credentials import CA, CERT, KEY, common_name, load_certificate, load_key, read
from vedette.net.names import MOST_ROBOTS, OPERATOR, check_team, robot_name
from vedette.net.revoked import put_beside_keys
from vedette.number import many

CA_KEY, ISSUED = "ca-key.pem", "issued.txt"
DAYS, MOST_DAYS = 365, 36500
MOST_AT_ONCE = 1024
_AUTHORITY_DAYS = 3650  # or as long as its first certificates
_EARLY = timedelta(days=1)  # a robot's clock may be behind
_RECORD = re.compile(rf"(?:robot-([1-9]\d*)|{OPERATOR}) [0-9a-f]+ \d{{4}}-\d\d-\d\d")


@dataclass(frozen=True)
class Authority:
    """Who signs a team's certificates, and for how long from when."""

    key: ec.EllipticCurvePrivateKey
    certificate: x509.Certificate
    now: datetime
    days: int

    @property
    def team(self) -> str:
        """The name is in every certificate."""
        return common_name(self.certificate).rpartition("/")[0]


def issue_team(team: str, folder: Path | str, robots: int, now: datetime, days: int = DAYS) -> list[Path]:
    """Make an authority and certificates for ``robots`` robots and the operator; return their folders.

    ``folder`` gets ``ca.pem``, ``ca-key.pem``, ``issued.txt``, and a folder for each holder: ``robot-1`` ...,
    ``operator``. It appears whole or not at all. ``now`` has a time zone.

    Raises:
        InputError: bad team, number or days; ``folder`` exists or cannot be written.
    """
    folder = Path(folder)
    check_team(team)
    _check_numbers(robots, days)
    if folder.exists() or folder.is_symlink():
        raise InputError(
            f"{folder} exists; nothing was changed; give a new folder, or --add robots to this one"
        )
    names = [*(robot_name(robot) for robot in range(robots)), OPERATOR]
    authority = _new_authority(team, now, days)
    with _scratch(folder.parent) as scratch:
        part = scratch / "team"
        part.mkdir(mode=0o700)
        (part / CA).write_bytes(_pem(authority.certificate))
        _write_secret(part / CA_KEY, authority.key)
        (part / ISSUED).write_text(_issue(authority, part, names))
        part.rename(folder)
    return [folder / name for name in names]


def add_robots(team: str, folder: Path | str, robots: int, now: datetime, days: int = DAYS) -> list[Path]:
    """Make certificates for ``robots`` more robots of an authority; return their folders.

    Numbers go on after the highest ever issued, also where a robot's folder has been moved away.

    Raises:
        InputError: bad number or days; ``folder`` holds no authority of this team, one that expires before
            the certificates would, or cannot be written.
    """
    folder = Path(folder)
    check_team(team)
    _check_numbers(robots, days)
    authority = load_authority(folder, team, now, days)
    issued = _issued(folder)
    first = _last_number(issued, folder / ISSUED)
    if first + robots > MOST_ROBOTS:
        raise InputError(f"team {team!r} has {many(first, 'robot')} already; at most {MOST_ROBOTS} can be")
    names = [robot_name(robot) for robot in range(first, first + robots)]
    if there := next((folder / name for name in names if (folder / name).exists()), None):
        raise InputError(f"{there} exists, though never issued; nothing was changed; move it away")
    with _scratch(folder) as scratch:
        issued += _issue(authority, scratch, names)
        # Numbers are taken before folders appear: whatever happens between, no name is given twice.
        with atomic_path(folder / ISSUED) as part:
            part.write_text(issued)
        for name in names:
            (scratch / name).rename(folder / name)
    put_beside_keys(folder)
    return [folder / name for name in names]


def _check_numbers(robots: int, days: int) -> None:
    if not 1 <= robots <= MOST_AT_ONCE:
        raise InputError(f"robots must lie in 1..{MOST_AT_ONCE} at a time; got {robots}")
    if not 1 <= days <= MOST_DAYS:
        raise InputError(f"days must lie in 1..{MOST_DAYS}; got {days}")


def last_number(folder: Path) -> int:
    """Return the highest number of a robot that an authority has issued a certificate to.

    Raises:
        InputError: its records cannot be read.
    """
    return _last_number(_issued(folder), folder / ISSUED)


def _issued(folder: Path) -> str:
    return read(folder / ISSUED, most=MOST_ROBOTS * 128).decode(errors="replace")


def _last_number(issued: str, path: Path) -> int:
    last = 0
    for line in issued.splitlines():
        record = _RECORD.fullmatch(line)
        if record is None:
            raise InputError(f"{path}: {line[:40]!r} is not the record of a certificate; restore the file")
        last = max(last, int(record[1] or 0))
    return last


# -- certificates ----------------------------------------------------------------------------------------


def _new_authority(team: str, now: datetime, days: int) -> Authority:
    key = ec.generate_private_key(ec.SECP256R1())
    name = _name(f"{team}/authority")
    certificate = (
        _builder(name, name, key, now, max(days, _AUTHORITY_DAYS))
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(_usage(signs_certificates=True), critical=True)
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .sign(key, hashes.SHA256())
    )
    return Authority(key, certificate, now, days)


def load_authority(folder: Path, team: str, now: datetime, days: int = 0) -> Authority:
    """Return the authority of a team, which can sign what lasts so many days from now.

    Raises:
        InputError: ``folder`` holds none of this team, or one that expires before.
    """
    authority = Authority(load_key(folder / CA_KEY), load_certificate(folder / CA), now, days)
    if authority.certificate.public_key() != authority.key.public_key():
        raise InputError(f"{folder / CA_KEY} is not the key of {folder / CA}; restore both from one copy")
    if common_name(authority.certificate) != f"{team}/authority":
        raise InputError(f"{folder / CA} is the authority of {authority.team!r}, not of team {team!r}")
    last = authority.certificate.not_valid_after_utc
    if last < (now + timedelta(days=days)).replace(microsecond=0):
        raise InputError(f"{folder / CA} expires on {last:%Y-%m-%d}; give fewer --days, or make new keys")
    return authority


def _issue(authority: Authority, parent: Path, names: Sequence[str]) -> str:
    """Write a folder of three files for each name; return their records."""
    return "".join(f"{name} {_issue_one(authority, parent / name)}\n" for name in names)


def _issue_one(authority: Authority, folder: Path) -> str:
    key = ec.generate_private_key(ec.SECP256R1())
    roles = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
    issuer = x509.AuthorityKeyIdentifier.from_issuer_public_key(authority.key.public_key())
    subject = _name(f"{authority.team}/{folder.name}")
    certificate = (
        _builder(subject, authority.certificate.subject, key, authority.now, authority.days)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(_usage(signs_certificates=False), critical=True)
        .add_extension(x509.ExtendedKeyUsage(roles), critical=False)
        .add_extension(issuer, critical=False)
        .sign(authority.key, hashes.SHA256())
    )
    folder.mkdir(mode=0o700)
    (folder / CA).write_bytes(_pem(authority.certificate))
    (folder / CERT).write_bytes(_pem(certificate))
    _write_secret(folder / KEY, key)
    return f"{certificate.serial_number:040x} {certificate.not_valid_after_utc:%Y-%m-%d}"


def _builder(
    subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePrivateKey, now: datetime, days: int
) -> x509.CertificateBuilder:
    # No alternative names: sessions do not compare the names of hosts, a common name says who it is.
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _EARLY)
        .not_valid_after(now + timedelta(days=days))
    )


def _name(text: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, text)])


def _usage(signs_certificates: bool) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=not signs_certificates,
        key_cert_sign=signs_certificates,
        crl_sign=signs_certificates,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


# -- files -----------------------------------------------------------------------------------------------


@contextmanager
def _scratch(parent: Path) -> Iterator[Path]:
    """Yield a private folder beside what is to appear; it goes, with all that was not moved out of it."""
    try:
        parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=".part-", dir=parent) as scratch:
            yield Path(scratch)
    except OSError as error:
        raise InputError(
            f"cannot write in {parent}: {error.strerror or error}; choose another folder"
        ) from error


def _pem(certificate: x509.Certificate) -> bytes:
    return certificate.public_bytes(serialization.Encoding.PEM)


def _write_secret(path: Path, key: ec.EllipticCurvePrivateKey) -> None:
    pem = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(pem)
