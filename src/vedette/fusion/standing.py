"""Whose word counts, and whose does not any more: of evidence of any kind, beacons and accounts alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from vedette.fusion.contradictions import Contradiction, ProvenLie
from vedette.fusion.digest import fingerprint
from vedette.fusion.link import Key
from vedette.fusion.particulars import SignedPlace
from vedette.fusion.seals import Notary
from vedette.fusion.trust import APART

REVOKED = "its certificate has been revoked: the belief and the plans leave out all that it has signed"


@dataclass
class Standing:
    """What one robot knows of the others' words: one for all that it hears."""

    notary: Notary
    complaints: dict[int, str] = field(default_factory=dict)  # by robot: why its word was not taken
    misdated: dict[int, str] = field(default_factory=dict)  # robots whose latest evidence has a far-off date
    forgers: set[int] = field(default_factory=set)  # neighbours that pass on what they have changed
    gone: dict[int, str] = field(default_factory=dict)  # robots of whom nothing counts any more, and why
    found: list[ProvenLie] = field(
        default_factory=list
    )  # lies that this robot can prove; whoever reads it empties it

    @property
    def said(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        return self.misdated | self.complaints | self.gone

    def catch(self, robot: int, proof: Contradiction) -> None:
        """Note what a robot has signed that cannot both be so."""
        if robot not in self.gone and all(robot != found.robot for found in self.found):
            self.found.append(ProvenLie(robot, proof))

    def convict(self, robot: int, at: str) -> None:
        """Let nothing count of a robot whose lie is proven."""
        self.gone.setdefault(robot, f"{at}: the belief and the plans leave it out")

    def dates(self, robot: int, time: int) -> None:
        """Note by what time [0.1 s] a robot has just dated what it signed; far off, it is named for it."""
        apart = time - self.notary.now()
        self.misdated.pop(robot, None)
        if abs(apart) > APART:
            away = f"{apart / 10:+.0f} s from this robot's clock"
            self.misdated[robot] = f"it dates what it sees {away}: that is compared with nobody's"

    def revoke(self, robots: frozenset[int]) -> bool:
        """Let nothing count that these robots have signed; tell whether that is news.

        Not even what they had signed before: whoever has stolen a key can date what it signs as it likes.
        """
        news = robots - self.gone.keys()
        self.gone |= dict.fromkeys(news, REVOKED)
        return bool(news)


class Signed(Protocol):
    """Evidence that is signed, of any kind, as agents ask of it."""

    @property
    def standing(self) -> Standing:
        """Whose word counts."""

    @property
    def out(self) -> frozenset[int]:
        """Robots whose evidence is held, and not believed."""

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""

    @property
    def covers(self) -> bool:
        """Tell whether this robot's latest evidence has told of its place lately."""

    def be_at(self, sequence: int, x: int, y: int) -> None:
        """Note where this robot is by one of its beacons [cm]."""

    def take_places(self) -> Mapping[Key, tuple[SignedPlace, int]]:
        """Return where others have signed to be, and when [0.1 s], since that was last asked for."""

    def heed(self) -> None:
        """Take up that somebody has gone."""


def signed_by(fusion: object) -> Signed | None:
    """Return a way of fusing as one whose evidence is signed, if it is."""
    found: Signed | None = getattr(fusion, "signed", None)
    return found


def print_of(out: frozenset[int], part: int) -> int:
    """Return what the robots that are not believed add to a digest, as its part of this number."""
    return fingerprint(repr(sorted(out)).encode(), part) if out else 0
