"""What a robot signs, and who vouches that it was that robot: so that nobody speaks for another."""

from __future__ import annotations

from typing import NamedTuple, Protocol

SIGNATURE_BYTES = 64
MOST_CERTIFICATE = 4096  # [bytes]


class Seal(NamedTuple):
    """A contributor's word for one version of its evidence."""

    time: int  # when it gave it, by its own clock [0.1 s]
    signature: (
        bytes  # over mission, robot, boot, version, time and the root, which whoever reads it works out
    )


class Notary(Protocol):
    """Signs for one robot, and knows by certificates whose signatures are whose; for one mission."""

    @property
    def certificate(self) -> bytes:
        """The robot's own, which travels with what it says."""

    def now(self) -> int:
        """Return what the robot's clock shows [0.1 s]: time of day, as fast as the mission goes."""

    def sign(self, *what: int | bytes | str) -> bytes:
        """Return the robot's signature under what it says."""

    def admit(self, robot: int, certificate: bytes) -> None:
        """Take a robot's certificate; ValueError if it is not one of this team for this robot."""

    def certificate_of(self, robot: int) -> bytes:
        """Return the last one of a robot's that has come; KeyError if none has."""

    def knows(self, robot: int) -> bool:
        """Tell whether a certificate of a robot has come."""

    def check(self, robot: int, signature: bytes, *what: int | bytes | str) -> None:
        """Raise ValueError unless a robot, whose certificate has come, has signed this."""


EVIDENCE, STEPS, BEACON, ACCOUNT = "evidence", "steps", "beacon", "account"  # under every signature
