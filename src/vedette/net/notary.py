"""A robot's notary: signatures by the key of its certificate, and others' checked by theirs."""

from __future__ import annotations

import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import msgspec
from cryptography import x509
from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.asymmetric.utils import decode_dss_signature, encode_dss_signature

from vedette.agent.terms import Terms, fingerprint_of
from vedette.fusion.seals import SIGNATURE_BYTES
from vedette.net.config import AgentConfig
from vedette.net.credentials import (
    CA,
    CERT,
    KEY,
    Credentials,
    common_name,
    credentials,
    load_certificate,
    load_key,
)
from vedette.net.names import Names

_HALF = SIGNATURE_BYTES // 2
_HOW = ec.ECDSA(hashes.SHA256())
MOST_CERTIFICATES = 4  # of one robot, that are taken: it may be given another


class CertifiedNotary:
    """``vedette.fusion.seals.Notary`` by P-256 certificates of one authority."""

    def __init__(self, credentials: Credentials, mission: str, clock: Callable[[], float]) -> None:
        """Sign in the name of these credentials.

        Args:
            credentials: of the robot.
            mission: in everything that is signed, so that it is good for no other.
            clock: time of day, as fast as the mission goes; it never goes back [s].

        Raises:
            InputError: the files cannot be read.
        """
        self._mission, self._clock = mission, clock
        self._names = Names(credentials.team)
        self._key = load_key(credentials.folder / KEY)
        self._authority = load_certificate(credentials.folder / CA)
        own = load_certificate(credentials.folder / CERT)
        self._certificate = own.public_bytes(serialization.Encoding.DER)
        self._admitted: dict[int, dict[bytes, ec.EllipticCurvePublicKey]] = {}
        self._operators: dict[bytes, ec.EllipticCurvePublicKey] = {}

    @property
    def mission(self) -> str:
        """What is in everything that is signed."""
        return self._mission

    @property
    def certificate(self) -> bytes:
        """DER."""
        return self._certificate

    def now(self) -> int:
        """Return what the clock shows [0.1 s]."""
        return max(int(10.0 * self._clock()), 0)

    def sign(self, *what: int | bytes | str) -> bytes:
        """Return r and s of an ECDSA signature, 32 bytes each."""
        r, s = decode_dss_signature(self._key.sign(self._message(what), _HOW))
        return r.to_bytes(_HALF, "big") + s.to_bytes(_HALF, "big")

    def admit(self, robot: int, certificate: bytes) -> None:
        """Take a robot's certificate, which is checked once; ValueError if it is not one of this team's."""
        known = self._admitted.setdefault(robot, {})
        if certificate in known:
            return
        if len(known) >= MOST_CERTIFICATES:
            raise ValueError(f"more than {MOST_CERTIFICATES} certificates")
        known[certificate] = self._key_of(robot, certificate)

    def certificate_of(self, robot: int) -> bytes:
        """Return the last one of a robot's that has come; KeyError if none has."""
        return list(self._admitted[robot])[-1]

    def knows(self, robot: int) -> bool:
        """Tell whether a certificate of a robot has come."""
        return bool(self._admitted.get(robot))

    def check(self, robot: int, signature: bytes, *what: int | bytes | str) -> None:
        """Raise ValueError unless a robot, whose certificate has come, has signed this."""
        if not any(self._has_signed(key, signature, what) for key in self._admitted.get(robot, {}).values()):
            raise ValueError("the signature is not by its key")

    def check_operator(self, certificate: bytes, signature: bytes, *what: int | bytes | str) -> None:
        """Raise ValueError unless the operator of this team has signed this, by this certificate."""
        if certificate not in self._operators:
            if len(self._operators) >= MOST_CERTIFICATES:
                raise ValueError(f"more than {MOST_CERTIFICATES} certificates of operators")
            self._operators[certificate] = self._key_of(None, certificate)
        if not self._has_signed(self._operators[certificate], signature, what):
            raise ValueError("the signature is not by the operator's key")

    def _has_signed(
        self, key: ec.EllipticCurvePublicKey, signature: bytes, what: tuple[int | bytes | str, ...]
    ) -> bool:
        r, s = (int.from_bytes(half, "big") for half in (signature[:_HALF], signature[_HALF:]))
        try:
            key.verify(encode_dss_signature(r, s), self._message(what), _HOW)
        except InvalidSignature:
            return False
        return True

    def _message(self, what: tuple[int | bytes | str, ...]) -> bytes:
        return msgspec.msgpack.encode((self._names.team, self._mission, *what))

    def _key_of(self, robot: int | None, der: bytes) -> ec.EllipticCurvePublicKey:
        try:
            certificate = x509.load_der_x509_certificate(der)
            certificate.verify_directly_issued_by(self._authority)
            key = certificate.public_key()
        except (ValueError, TypeError, InvalidSignature, UnsupportedAlgorithm):
            raise ValueError("its certificate is not one of this team's authority") from None
        if common_name(certificate) != self._names.certificate(robot):
            raise ValueError(f"its certificate is that of {common_name(certificate)}")
        if not certificate.not_valid_before_utc <= datetime.now(UTC) <= certificate.not_valid_after_utc:
            raise ValueError("its certificate is not valid now")
        if not isinstance(key, ec.EllipticCurvePublicKey) or not isinstance(key.curve, ec.SECP256R1):
            raise ValueError("its certificate's key is not P-256")
        return key


def notary_of(
    config: AgentConfig, folder: Path, terms: Terms, speed: float
) -> tuple[CertifiedNotary | None, Terms]:
    """Return the notary of a robot's file, for the mission that its team agrees on; None: it has no keys.

    With the terms, and whether robots sign among them.

    Raises:
        InputError: keys that do not admit this robot now.
    """
    if config.links.keys is None:
        return None, {**terms, "signatures": "none"}
    own = credentials(folder / config.links.keys, datetime.now(UTC))
    notary = CertifiedNotary(own, f"{fingerprint_of(terms):x}", _steady(speed))
    return notary, {**terms, "signatures": "P-256"}


def _steady(speed: float) -> Callable[[], float]:
    """Return the time of day, so many times as fast [s]; it goes on though the clock is set meanwhile."""
    begun, at = time.time(), time.monotonic()
    return lambda: speed * (begun + time.monotonic() - at)
