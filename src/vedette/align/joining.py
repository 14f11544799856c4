"""Which of several maps can be joined, and where each lies in the first one's frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vedette.align.candidates import PossibleJoin
from vedette.align.charted import Charted
from vedette.align.pose import FramePose
from vedette.align.verdict import JoinVerdict, judged

CLOSED = 0.3, math.radians(2.0)  # how far a match may be from what the others say [m, rad]


@dataclass(frozen=True, eq=False)
class Match:
    """Two maps that may be joined."""

    a: int
    b: int
    candidate: PossibleJoin  # T_a_b


@dataclass(frozen=True, eq=False)
class JoinedMaps:
    """Where the maps lie, and what they are held together by."""

    poses: tuple[FramePose | None, ...]  # of each map in the first one's frame; None: it could not be joined
    tree: tuple[Match | None, ...]  # by which each map is held; None: the first, and those not joined
    doubts: tuple[str | None, ...]  # why a map fits none of the most that fit each other

    @property
    def whole(self) -> bool:
        """Whether all are joined."""
        return all(pose is not None for pose in self.poses)


def joined(maps: Sequence[Charted], seed: int) -> JoinedMaps:
    """Return where maps lie in the frame of the first: along a tree of the best matches, whose cycles close.

    All pairs are judged. A match that contradicts the tree is a doubt about all maps of that cycle, and none
    of them is joined.

    Args:
        maps: two or more.
        seed: of what the thinned copies lack.
    """
    verdicts = {(i, j): judged(maps[i], maps[j], seed) for i, j in combinations(range(len(maps)), 2)}
    matches = sorted(
        (Match(i, j, verdict.joined) for (i, j), verdict in verdicts.items() if verdict.joined is not None),
        key=lambda match: -match.candidate.score,
    )
    poses: list[FramePose | None] = [FramePose(0.0, 0.0, 0.0), *[None] * (len(maps) - 1)]
    tree: list[Match | None] = [None] * len(maps)
    while (match := _next(matches, poses)) is not None:
        known, new = (match.a, match.b) if poses[match.a] is not None else (match.b, match.a)
        pose = poses[known]
        assert pose is not None
        step = match.candidate.pose if known == match.a else match.candidate.pose.inverse()
        poses[new], tree[new] = pose.after(step), match
    fit = _most(matches, len(maps))
    doubts = [None if fit[number] else _doubt(number, verdicts) for number in range(len(maps))]
    for number in _torn(matches, poses, maps) - {0}:
        poses[number] = tree[number] = None
        doubts[number] = "the matches with the others contradict each other"
    return JoinedMaps(tuple(poses), tuple(tree), tuple(doubts))


def _next(matches: Sequence[Match], poses: Sequence[FramePose | None]) -> Match | None:
    """Return the best match between a map that is placed and one that is not."""
    return next((m for m in matches if (poses[m.a] is None) != (poses[m.b] is None)), None)


def _most(matches: Sequence[Match], count: int) -> NDArray[np.bool_]:
    """Tell which maps are of the most that matches hold together; of as many, those with the first map."""
    edges = ([1] * len(matches), ([match.a for match in matches], [match.b for match in matches]))
    labels = connected_components(coo_array(edges, shape=(count, count)), directed=False)[1]
    return np.asarray(labels == np.bincount(labels).argmax())


def _torn(matches: Sequence[Match], poses: Sequence[FramePose | None], maps: Sequence[Charted]) -> set[int]:
    """Return the maps whose matches do not close."""
    torn: set[int] = set()
    for match in matches:
        a, b = poses[match.a], poses[match.b]
        if a is None or b is None:
            continue
        shift, turn = a.inverse().after(b).apart(match.candidate.pose, maps[match.b].middle)
        if shift > CLOSED[0] or turn > CLOSED[1]:
            torn |= {match.a, match.b}
    return torn


def _doubt(number: int, verdicts: dict[tuple[int, int], JoinVerdict]) -> str | None:
    """Return the doubt about the pair in which a map fitted best."""
    own = [verdict for pair, verdict in verdicts.items() if number in pair and verdict.doubt is not None]
    best = max(own, key=lambda v: v.alignment.candidates[0].score if v.alignment.candidates else -math.inf)
    return best.doubt
