"""Finding out by their maps how contributors lie that nothing joins yet: one pair at a time, as jobs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from vedette.align import Alignment, Charted, FramePose, align
from vedette.align.agreement import middles
from vedette.align.candidates import FINELY, weighed
from vedette.align.fitted import fitted
from vedette.align.verdict import STEADY, JoinRule, JoinVerdict, bare, judged
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.fusion.link import Key
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.charts import Charts, pose_of
from vedette.missions.explore.frames.graph import Graph

RULE = JoinRule(rivalry=0.6, lead=12.0, same=15.0, common=15.0)
GUESSED = 5.0  # walls in common less what contradicts, from which a place is worth a guess [m]
LIKELY = 0.5  # that the best places of two maps, refused, have the right one among them [1]
VERSIONS = 3  # of both maps in a row, for which the rule has to hold, at one pose
LEAST = 15.0  # ground that a map has before it is looked at [m^2]
GROWN, GROWN_LITTLE = 1.2, 1.03  # more of both, before they are looked at again; after the rule has held [1]
SETTLED = 20.0, 1.01  # so long, and no more of both than this, and two maps are judged as saved ones [s, 1]
FITTED_AGAIN = 1.15  # more of both, before a join is fitted anew [1] ...
FITTED_AFTER = 20.0  # ... or so long, where either has changed: a SLAM bends its map [s]
MOVED = 0.02, math.radians(0.1)  # a fit this near to what is told already is no news [m, rad]
WHERE_JOINED = JoinRule(rivalry=1.0, lead=0.0, same=8.0, common=8.0)  # of maps that others' edges join
BESIDE = 0.5, math.radians(3.0)  # and how far from where those say they may fit [m, rad]
SEED = 0  # of what is left out of maps that are judged
EVERY = 2.0  # a robot looks at a pair [s]

Pair = tuple[Key, Key]


@dataclass
class _Attempts:
    """What came of looking at a pair."""

    ground: float = 0.0  # of both, when they were looked at last [m^2]
    versions: int = 0  # of both, then
    when: float = 0.0  # [s]
    held: list[FramePose] = field(default_factory=list)  # poses, since the rule holds
    grown: tuple[float, float] = 0.0, 0.0  # of both, when they had grown last [m^2], and when [s]
    judged: tuple[bytes, bytes] | None = None  # maps by their names, as saved ones, the latest

    def settled(self, ground: float, names: tuple[bytes, bytes], now: float) -> bool:
        """Tell whether neither map has grown for a while, and they have not been judged as they are."""
        before, since = self.grown
        if ground > SETTLED[1] * before:
            self.grown = ground, now
            return False
        return now >= since + SETTLED[0] and self.judged != names


@dataclass
class Matcher:
    """One robot's search for matches, and the edges that it has found."""

    robot: int
    charts: Charts
    found: dict[Pair, FrameEdge] = field(default_factory=dict)
    guesses: dict[Pair, FrameEdge] = field(default_factory=dict)  # what may be, of pairs that nothing joins
    refused: Counter[str] = field(default_factory=Counter)  # by why
    looked: int = 0  # at pairs
    _attempts: dict[Pair, _Attempts] = field(default_factory=dict)
    _done: list[Callable[[], None]] = field(default_factory=list)  # what a job has found, to be taken in
    _due: float = 0.0
    _at_work: bool = False  # a job is on its way

    def errand(self, graph: Graph, living: Collection[int], now: float) -> Callable[[], None] | None:
        """Return what to work out beside all else, if it is time for it."""
        self.take()
        if now < self._due or self._at_work:
            return None
        self._due = now + EVERY
        for pair in self._mine(graph, living):
            grounds = [self.charts.ground(key) for key in pair]
            if min(grounds) < LEAST:
                continue
            there = _between(graph, *pair)
            attempts = self._attempts.setdefault(pair, _Attempts())
            ground, names = sum(grounds), (self.charts.name(pair[0]), self.charts.name(pair[1]))
            settled = attempts.settled(ground, names, now) and there is None and pair not in self.found
            versions = self.charts.versions(*pair)
            steady = there is not None and pair in self.found
            grown = FITTED_AGAIN if steady else GROWN_LITTLE if there or attempts.held else GROWN
            bent = there is not None and now >= attempts.when + FITTED_AFTER and versions > attempts.versions
            due = bent or ground >= grown * attempts.ground
            if not due and not settled:
                continue
            a, b = (self.charts.of(key) for key in pair)
            if a is None or b is None:
                continue
            attempts.ground, attempts.versions, attempts.when = ground, versions, now
            self._at_work = True
            if there is not None:
                return partial(self._fit, pair, a, b, there)
            if not due:
                attempts.grown, attempts.judged = (attempts.grown[0], now), names
                return partial(self._judge, pair, a, b)
            return partial(self._look, pair, a, b)
        return None

    def take(self) -> None:
        """Take in what the latest job has found."""
        while self._done:
            self._done.pop(0)()
            self._at_work = False

    def drop(self, pair: Pair) -> None:
        """Take an edge back that evidence has come to contradict; the pair is looked at anew."""
        self.found.pop(pair, None)
        before = self._attempts.pop(pair, None)
        if before is not None:  # what has been judged is not judged again
            self._attempts[pair] = _Attempts(grown=before.grown, judged=before.judged)
        self.refused["taken back"] += 1

    def _mine(self, graph: Graph, living: Collection[int]) -> Iterator[Pair]:
        """Yield the pairs that this robot looks at: each the first living one of both, else of all.

        Latest starts come first: who tells of many takes nobody's turn.
        """
        keys, starts = sorted(graph), Counter[int]()
        later = dict[Key, int]()  # starts of the same robot
        for key in reversed(keys):
            later[key] = starts[key[0]]
            starts[key[0]] += 1
        pairs = [(a, b) for at, a in enumerate(keys) for b in keys[at + 1 :]]
        for a, b in sorted(pairs, key=lambda pair: later[pair[0]] + later[pair[1]]):
            whose = next((key[0] for key in (a, b) if key[0] in living), min(living))
            if whose == self.robot:
                yield a, b

    def _look(self, pair: Pair, a: Charted, b: Charted) -> None:
        alignment = align(a, b)
        doubt = RULE.doubt(alignment) or bare(a, b, alignment.candidates[0], RULE)
        self._done.append(lambda: self._weigh(pair, alignment, doubt, b))

    def _weigh(self, pair: Pair, alignment: Alignment, doubt: str | None, b: Charted) -> None:
        """Believe a match once the rule has held for so many versions, at one pose."""
        attempts = self._attempts.setdefault(pair, _Attempts())
        self.looked += 1
        if doubt is not None:
            attempts.held.clear()
            self.refused[_kind(doubt)] += 1
            self._guess(pair, alignment)
            return
        best = alignment.candidates[0]
        gaps = [best.pose.apart(earlier, b.middle) for earlier in attempts.held]
        if any(shift > STEADY[0] or turn > STEADY[1] for shift, turn in gaps):
            attempts.held.clear()
            self.refused["elsewhere than before"] += 1
        attempts.held.append(best.pose)
        if len(attempts.held) >= VERSIONS:
            self.found[pair] = _edge(pair, best.pose, best.same)

    def _judge(self, pair: Pair, a: Charted, b: Charted) -> None:
        """Judge two maps that do not grow as saved ones are, for which no more versions are to come."""
        verdict = judged(a, b, SEED)
        self._done.append(lambda: self._take(pair, verdict))

    def _take(self, pair: Pair, verdict: JoinVerdict) -> None:
        self.looked += 1
        if verdict.joined is not None:
            self.found[pair] = _edge(pair, verdict.joined.pose, verdict.joined.same)
        elif verdict.doubt is not None:
            self.refused[_kind(verdict.doubt)] += 1
            self._guess(pair, verdict.alignment)

    def _guess(self, pair: Pair, alignment: Alignment) -> None:
        """Tell where the maps of a pair fit best, if that is somewhere at all."""
        self.guesses.pop(pair, None)
        if alignment.candidates and alignment.candidates[0].score >= GUESSED:
            chance = LIKELY / (1.0 + alignment.rivalry)
            pose = alignment.candidates[0].pose
            there = Transform.of(pose.x, pose.y, pose.angle)
            self.guesses[pair] = FrameEdge(*pair, there, round(100.0 * chance), EdgeKind.GUESS)

    def _fit(self, pair: Pair, a: Charted, b: Charted, there: Transform) -> None:
        """Fit two maps that whatever edges join, where they lie: if they do fit, that is an edge."""
        guess = middles(a, b, pose_of(there))
        fit = fitted(a, b, guess, FINELY)
        known = self.found.get(pair)
        stands = known is not None and _is_near(fit.pose, middles(a, b, pose_of(known.there)), MOVED)
        place = weighed(a, b, fit)
        fits = _is_near(fit.pose, guess, BESIDE) and WHERE_JOINED.doubt(Alignment((place,))) is None
        better = {} if stands or not fits else {pair: _edge(pair, place.pose, place.same)}
        self._done.append(lambda: self.found.update(better))


def _is_near(one: FramePose, other: FramePose, most: tuple[float, float]) -> bool:
    """Tell whether two poses between maps' middles are no farther apart than that [m, rad]."""
    shift, turn = one.apart(other, np.zeros(2))
    return shift <= most[0] and turn <= most[1]


def _between(graph: Graph, a: Key, b: Key) -> Transform | None:
    """Return where b lies in a's frame; None: nothing joins them."""
    one, other = graph[a], graph[b]
    return one.there.inverse().after(other.there) if one.anchor == other.anchor else None


def _edge(pair: Pair, pose: FramePose, same: float) -> FrameEdge:
    return FrameEdge(*pair, Transform.of(pose.x, pose.y, pose.angle), round(100.0 * same))


def _kind(doubt: str) -> str:
    """Return a doubt without its figures."""
    return (
        doubt.split(":")[0]
        if not any(c.isdigit() for c in doubt.split(":")[0])
        else "look-alike or contradicted"
    )
