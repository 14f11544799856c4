"""One pair of maps, judged as ``vedette merge`` judges them, beside the truth."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Literal

from bench.frames.pairs import Pair
from vedette.align import Charted, JoinVerdict, align, charted, judged
from vedette.record.summary import SCHEMA_VERSION

RIGHT = 0.5, math.radians(3.0)  # a join farther from the truth is wrong [m, rad]
REPETITIVE = 0.5  # of itself a place repeats elsewhere, from which on its pairs are told apart


@dataclass(frozen=True)
class Trial:
    """What came of one pair; a line of the results file."""

    sort: str  # one, two or alike
    number: int
    place: str
    outcome: Literal["joined", "wrong", "refused"]
    doubt: str | None
    common_m2: float  # free ground that both have mapped, by the truth
    least_m2: float  # free ground of the map that has less
    error_m: float | None  # of a join from the truth, at the middle of the second map
    error_deg: float | None
    rivalry: float
    alike: float | None  # rivalry of the smaller map laid on itself, of one place
    side_m: float  # the longer side of the larger map
    time_s: float  # of CPU, all alignments of the pair
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[str, int]:
        """What tells the pair from all others."""
        return self.sort, self.number

    @property
    def overlap(self) -> float:
        """Share of the smaller map's free ground that the other has mapped too, 0..1."""
        return self.common_m2 / self.least_m2 if self.least_m2 else 0.0

    @property
    def repetitive(self) -> bool:
        """Whether it is a maze, or a map of which half fits elsewhere on itself."""
        return self.place == "maze" or (self.alike is not None and self.alike > REPETITIVE)


def tried(sort: str, number: int, pair: Pair, commit: str) -> Trial | None:
    """Judge a pair; None if one of its maps has nothing to be found by."""
    a, b = (charted(each.frame, each.classes) for each in (pair.a, pair.b))
    if a is None or b is None:
        return None
    began = time.process_time()
    verdict = judged(a, b, seed=number)
    spent = time.process_time() - began
    shift, turn = _off(verdict, pair, b)
    joined = verdict.joined is not None
    right = (
        pair.together and shift is not None and turn is not None and shift <= RIGHT[0] and turn <= RIGHT[1]
    )
    return Trial(
        sort=sort,
        number=number,
        place=pair.place,
        outcome=("joined" if right else "wrong") if joined else "refused",
        doubt=verdict.doubt,
        common_m2=pair.common,
        least_m2=pair.least,
        error_m=shift,
        error_deg=None if turn is None else math.degrees(turn),
        rivalry=verdict.alignment.rivalry,
        alike=_alike(a, b) if sort == "one" else None,
        side_m=max(a.side, b.side),
        time_s=spent,
        commit=commit,
    )


def _alike(a: Charted, b: Charted) -> float:
    """Return how well the map with less free ground fits elsewhere on itself, 0..1."""
    smaller = min((a, b), key=lambda each: len(each.free) * each.cell**2)
    return align(smaller, smaller).rivalry


def _off(verdict: JoinVerdict, pair: Pair, b: Charted) -> tuple[float | None, float | None]:
    """Return how far a join is from the truth [m, rad]; None without one."""
    if verdict.joined is None or not pair.together:
        return None, None
    return verdict.joined.pose.apart(pair.truth, b.middle)
