"""Which of the matches that are told the evidence of both bears out, and where it has them lie.

docs/align.md, section 6
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from vedette.align.agreement import MapAgreement
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.charts import Charts
from vedette.missions.explore.frames.graph import CLOSED

BORNE_OUT = 8.0, 0.15  # walls in common at least [m], and contradicted at most, that an edge may count
ALLOWED = 5.0, 0.25  # where more contradicts, and a larger share, two are not joined [m, 1]
PULLED = 0.02, math.radians(0.1)  # where walls pull it farther, a match lies where they do [m, rad]
AGAIN = 8  # versions of either, for each million cells, after which all look anew at what evidence says
STARTS = 8  # the latest of a robot, whose matches count

REFUTED = 2.0, 0.5  # walls in common at most [m], or contradicted at least: two do not lie so
PATIENCE = 24  # versions of whoever tells of such an edge, in which it could have taken it back

Told = Mapping[Key, Sequence[FrameEdge]]
_Place = tuple[Key, Key, Transform]  # the second's frame in the first's
_Versions = tuple[tuple[int, int], tuple[int, int]]  # of both, by their pace


class _Verdict(NamedTuple):
    """What the evidence of two says of where one is taken to lie on the other."""

    versions: _Versions
    agreement: MapAgreement | None  # None: there is nothing to compare

    @property
    def bears_out(self) -> bool:
        found = self.agreement
        return found is not None and found.same >= BORNE_OUT[0] and found.contradicted <= BORNE_OUT[1]

    @property
    def allows(self) -> bool:
        found = self.agreement
        return found is None or found.against < ALLOWED[0] or found.contradicted <= ALLOWED[1]

    @property
    def refutes(self) -> bool:
        found = self.agreement
        return found is not None and (found.same < REFUTED[0] or found.contradicted > REFUTED[1])


@dataclass(eq=False)
class BorneOut:
    """Holds what is told of how frames lie against the evidence; all who hold the same find the same."""

    evidence: FramedMap[Any]
    charts: Charts
    _verdicts: dict[_Place, _Verdict] = field(default_factory=dict)
    _pulled: dict[_Place, tuple[_Versions, Transform | None]] = field(default_factory=dict)
    _asked: set[_Place] = field(default_factory=set)  # since `begin`
    _refuted: dict[tuple[Key, FrameEdge], int] = field(default_factory=dict)  # by whom, since which version

    def begin(self) -> None:
        """Forget of what nobody has asked since this was called last."""
        self._verdicts = {place: self._verdicts[place] for place in self._asked & self._verdicts.keys()}
        self._pulled = {place: self._pulled[place] for place in self._asked & self._pulled.keys()}
        self._asked.clear()

    def matches(self, told: Told, seen: Collection[Key]) -> list[FrameEdge]:
        """Return the matches that count, each where the walls of both have it, weighed by these.

        Whose maps they are tell of them; others' word counts only where of theirs none does.
        """
        by_pair: dict[tuple[Key, Key], tuple[set[FrameEdge], set[FrameEdge]]]
        by_pair = defaultdict(lambda: (set(), set()))
        for teller, edge in _matches(told, seen):
            of_others = teller[0] not in (edge.a[0], edge.b[0])
            by_pair[edge.a, edge.b][of_others].add(edge)
        found = list[FrameEdge]()
        for own, others in by_pair.values():
            found += self._counting(own) or self._counting(others)
        return found

    def allows(self, a: Key, b: Key, there: Transform) -> bool:
        """Tell whether the evidence of two does not speak against it that b lies in a's frame so."""
        return self._verdict((a, b, there)).allows

    def walls_apart(self, a: Key, b: Key, there: Transform) -> float | None:
        """Return how far walls have b lie from there [m]; None: the evidence of both does not bear it out."""
        bears_out = self._verdict((a, b, there)).bears_out
        return self.charts.pulled(a, b, there)[1] if bears_out else None

    def find_false(self, told: Told, seen: Collection[Key], own: Key) -> None:
        """Note who goes on telling of matches that the evidence of both refutes.

        An honest robot takes such an edge back as soon as it knows of that evidence.
        """
        refuted: dict[tuple[Key, FrameEdge], int] = {}
        for key, edge in _matches(told, seen):
            if self._verdict(edge[:3]).refutes:
                refuted[key, edge] = self._refuted.get((key, edge), self.evidence.copies[key].version)
        self._refuted = refuted
        late = {
            key[0]
            for (key, _), since in refuted.items()
            if key != own and self.evidence.copies[key].version >= since + PATIENCE
        }
        self.evidence.misleading = frozenset(late)

    def _counting(self, edges: Iterable[FrameEdge]) -> list[FrameEdge]:
        """Return those of some matches that evidence bears out, where it has them."""
        found = []
        for edge in edges:
            there = self._pulled_to(edge[:3])
            if there is None:
                continue
            verdict = self._verdict((edge.a, edge.b, there))
            if verdict.bears_out and verdict.agreement is not None:
                most = round(100.0 * verdict.agreement.same)
                found.append(edge._replace(there=there, weight=min(edge.weight, most)))
        return found

    def _pulled_to(self, place: _Place) -> Transform | None:
        """Return where the walls of both have b lie; None: too far from where it is taken to."""
        self._asked.add(place)
        versions = self._versions(place)
        known = self._pulled.get(place)
        if known is None or known[0] != versions:
            a, b, there = place
            to, shift, turn = self.charts.pulled(a, b, there)
            if shift > CLOSED[0] or turn > CLOSED[1]:
                known = versions, None
            else:
                known = versions, there if shift <= PULLED[0] and turn <= PULLED[1] else to
            self._pulled[place] = known
        return known[1]

    def _verdict(self, place: _Place) -> _Verdict:
        self._asked.add(place)
        versions = self._versions(place)
        known = self._verdicts.get(place)
        if known is None or known.versions != versions:
            known = _Verdict(versions, self.charts.agreement(*place))
            self._verdicts[place] = known
        return known

    def _versions(self, place: _Place) -> _Versions:
        """Return what stands for versions: as long as it does not change, nobody looks again."""
        return self._paced(place[0]), self._paced(place[1])

    def _paced(self, key: Key) -> tuple[int, int]:
        pace = AGAIN * self.charts.size(key)
        return pace, self.evidence.copies[key].version // pace


def _matches(told: Told, seen: Collection[Key]) -> Iterable[tuple[Key, FrameEdge]]:
    """Yield matches between contributors who have seen anything, by whom; of a robot the latest starts'."""
    starts: dict[int, int] = defaultdict(int)
    for key in sorted(told, reverse=True):
        starts[key[0]] += 1
        if starts[key[0]] > STARTS:
            continue
        for edge in told[key]:
            if edge.kind is EdgeKind.MATCH and edge.a in seen and edge.b in seen:
                yield key, edge.upwards
