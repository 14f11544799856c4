"""What a robot signs beside what it has seen: where and when it set out, and which visits were in vain."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette import wire
from vedette.kernels.tiles import SIDE, Tiling

MOST_NOTES = 512
MOST_COUNTED = 1e7  # of anything, by a robot, in a second; honest ones come to some 1e4
LONG = 60.0  # a robot may have looked about before it says to have set out [s]
ABOUT = 5.0  # where a visit is told of, its robot has been so near, some seconds ago [m]
Cell = Annotated[int, Meta(ge=0, lt=2**31)]
Centimetre = Annotated[int, Meta(ge=-(2**31), le=2**31)]
Time = Annotated[int, Meta(ge=0, lt=2**62)]  # by the contributor's own clock [0.1 s]
Note = tuple[
    Centimetre, Centimetre, Annotated[int, Meta(ge=0, le=2**53)], Time
]  # x, y, a number to it, and when


class Particulars(msgspec.Struct, frozen=True, array_like=True):
    """A contributor's start, which never changes, and what it has to tell all others."""

    row: Cell  # where it set out
    col: Cell
    began: Time
    notes: Annotated[tuple[Note, ...], Meta(max_length=MOST_NOTES)] = ()


class SignedPlace(msgspec.Struct, frozen=True, array_like=True):
    """Where a contributor has said to be, in one of its beacons."""

    sequence: Annotated[int, Meta(ge=0, le=2**53)]  # of the beacon
    x: Centimetre
    y: Centimetre


_PLACE_DECODER: msgspec.msgpack.Decoder[SignedPlace] = msgspec.msgpack.Decoder(SignedPlace)
_DECODER: msgspec.msgpack.Decoder[Particulars] = msgspec.msgpack.Decoder(Particulars)
encode = msgspec.msgpack.Encoder().encode


def decode(data: bytes) -> Particulars:
    """Return the particulars; ValueError if they are malformed."""
    return wire.decode(_DECODER, data, "particulars of evidence")


def decode_place(data: bytes) -> SignedPlace:
    """Return the place; ValueError if it is malformed."""
    return wire.decode(_PLACE_DECODER, data, "place of a robot")


@dataclass(frozen=True)
class Capabilities:
    """How far any robot of the team sees, and how fast it drives."""

    resolution: float  # of a cell [m]
    range: float  # [m]
    speed: float  # [m/s]
    origin: tuple[float, float] = (0.0, 0.0)  # of the grid [m], team frame

    def check_visits(self, told: Particulars) -> None:
        """Raise ValueError for visits between which nobody can have driven.

        docs/trust.md (V74)
        """
        (left, low), half = self.origin, 0.5
        place = left + (told.col + half) * self.resolution, low + (told.row + half) * self.resolution
        then = told.began
        for x, y, _, when in sorted(told.notes, key=lambda note: note[3]):
            there, seconds = (x / 100.0, y / 100.0), max(when - then, 0) / 10.0
            away = math.dist(place, there)
            if away > ABOUT + self.speed * seconds:
                raise ValueError(
                    f"it says to have been in two places {away:.0f} m apart within {seconds:.0f} s"
                )
            place, then = there, when

    def check_counts(self, counts: NDArray[np.int64], start: Particulars, time: int) -> None:
        """Raise ValueError for more than anybody can have counted since it set out."""
        seconds = max(time - start.began, 0) / 10.0 + LONG
        most = int(np.abs(counts).max(initial=0))
        if most > MOST_COUNTED * seconds:
            raise ValueError(f"it says to have counted {most} within {seconds:.0f} s, as nobody can")

    def check(self, tiling: Tiling, tiles: NDArray[np.int64], start: Particulars, time: int) -> None:
        """Raise ValueError for a tile farther from its maker's start than it can have driven, plus its range.

        docs/trust.md (V74)
        """
        top, left = tiling.corners(tiles)
        down = np.maximum(np.maximum(top - start.row, start.row - top - SIDE + 1), 0)
        along = np.maximum(np.maximum(left - start.col, start.col - left - SIDE + 1), 0)
        away = float(np.hypot(down, along).max(initial=0.0)) * self.resolution
        most = self.range + self.speed * max(time - start.began, 0) / 10.0 + self.resolution
        if away > most:
            raise ValueError(
                f"a tile {away:.0f} m from its start, from where it can have seen {most:.0f} m far by then"
            )
