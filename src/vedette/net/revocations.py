"""How a robot learns whose certificates have been revoked, and lets the others know."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import inf

from cryptography import x509

from vedette.errors import InputError
from vedette.maps.atomic import atomic_path
from vedette.net.credentials import CA, Credentials, load_certificate
from vedette.net.names import robot_name
from vedette.net.revoked import REVOKED, Revoked, checked, load_revoked, number_of

KIND, ASKS, ANSWERS = b"R", b"?", b"!"  # a datagram's first byte, and its second
LOOK = 2.0  # for a newer list in the robot's own folder, so often [s]
AGAIN = 10.0  # a neighbour that has not confirmed the list is told again after so long [s]


@dataclass
class Revocations:
    """Keeps the longest list that this robot has, and tells it to each neighbour until that has it too.

    A list counts by its signature, whoever passes it on; a shorter one never takes its place. Call ``look``
    now and then, ``tell`` after anything else. ``now`` is a clock that never goes back [s].
    """

    credentials: Credentials
    say: Callable[[str], None]  # tells whoever watches this process
    latest: Revoked = field(init=False)
    malformed: int = 0
    _authority: x509.Certificate = field(init=False)
    _known: dict[int, int] = field(default_factory=dict)  # number of the list that each neighbour has
    _told: dict[int, float] = field(default_factory=dict)  # when each was told last [s]
    _looked: float = -inf  # [s]

    def __post_init__(self) -> None:
        """Begin with the list that lies beside the robot's keys."""
        self.latest = self.credentials.revoked
        self._authority = load_certificate(self.credentials.folder / CA)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom."""
        return dict.fromkeys(self.latest.robots, "its certificate has been revoked")

    def look(self, now: float) -> None:
        """Take a longer list that somebody has put beside the robot's keys."""
        if now < self._looked + LOOK:
            return
        self._looked = now
        try:
            found = load_revoked(self.credentials.folder, self._authority, self.credentials.team)
        except InputError:  # half copied, perhaps
            return
        if found.number > self.latest.number:
            self.latest = found

    def hear(self, robot: int, data: bytes) -> list[tuple[int, bytes]]:
        """Take a neighbour's list; return what to send.

        Raises:
            ValueError: malformed, or a longer list than this robot's that its authority has not signed.
        """
        asks, text = data[:1], data[1:]
        number = number_of(text)
        if number > self.latest.number:
            self.latest = checked(text, self._authority, self.credentials.team)
            self._keep()
        self._known[robot] = number
        return [(robot, KIND + ANSWERS + self.latest.text)] if asks == ASKS else []

    def tell(self, neighbours: Iterable[int], now: float) -> list[tuple[int, bytes]]:
        """Return what to send to those who are not known to have the list."""
        due = [
            robot
            for robot in neighbours
            if self._known.get(robot, 0) < self.latest.number and now >= self._told.get(robot, -inf) + AGAIN
        ]
        self._told |= dict.fromkeys(due, now)
        return [(robot, KIND + ASKS + self.latest.text) for robot in due]

    def _keep(self) -> None:
        """Put the list beside the robot's keys, for its next start."""
        names = ", ".join(robot_name(robot) for robot in sorted(self.latest.robots))
        self.say(f"certificates revoked by now: {names}")
        try:
            with atomic_path(self.credentials.folder / REVOKED) as part:
                part.write_bytes(self.latest.text)
        except (OSError, InputError) as error:
            self.say(f"the list of revoked certificates is not kept for the next start: {error}")
