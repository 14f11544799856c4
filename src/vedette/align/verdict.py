"""Whether two maps may be joined: the rule, and whether it holds too where parts of them are missing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.align.agreement import middles
from vedette.align.candidates import Alignment, PossibleJoin, align, compared
from vedette.align.charted import Charted, charted
from vedette.align.lines import beside_lines
from vedette.maps import UNKNOWN

THINNINGS = 3
THINNED = 0.3  # share of the ground that a thinning takes out
BLOCK = 2.0  # side of what it takes out at once [m]
TWIN = 3, 15.0, 0.02  # a rival looks the same: lines; walls beside them, contradicted [1, m, 1]
LITTLE = 0.4  # of the map that knows less: one room may lie above one like it
LEAST = 0.25  # rivalry to which a rule falls with what is contradicted
STEADY = 0.3, math.radians(2.0)  # how far thinned maps may come from the whole ones' pose [m, rad]


@dataclass(frozen=True)
class JoinRule:
    """What a best candidate must have to be believed."""

    rivalry: float  # at most, where nothing is contradicted: score of the second best over its own
    lead: float  # at least: its score less that of the second best [m of wall]
    contradicted: float = 0.1  # at most: share of the walls seen
    same: float = 20.0  # at least: walls that both have [m]
    common: float = 20.0  # at least: ground that both know [m^2]
    deviation: float = 0.1  # at most, in the worst direction [m]
    steep: float = 0.0  # by so many times the share contradicted the rivalry has to be less
    lines: int = 3  # straight ones, those with most walls along them, that say nothing: any hall has them
    beside: float = 4.0  # at least: walls that both have beside them [m]
    beside_of_little: float = 4.0  # the same, where of neither map more than `LITTLE` is in common [m]
    clash: float = 1.0  # at most: what is contradicted, of itself and the walls beside the lines

    def doubt(self, alignment: Alignment) -> str | None:
        """Return why the best candidate is not believed, in words for people; None: it is."""
        if not alignment.candidates:
            return "no wall of one fits any of the other"
        best = alignment.candidates[0]
        if best.same < self.same or best.common < self.common:
            return f"what both have is little: {best.same:.0f} m of walls, {best.common:.0f} m2 of ground"
        if best.contradicted > self.contradicted:
            return f"where they fit best they contradict each other in {best.contradicted:.0%} of the walls"
        if best.deviation > self.deviation:
            return f"along one direction nothing tells where they lie, by {best.deviation:.2f} m"
        if alignment.rivalry > self.rivalry_at(best.contradicted) or alignment.lead < self.lead:
            told = f"another place fits {alignment.rivalry:.0%} as well: they look alike in more than one way"
            return told + (
                f", and {best.contradicted:.0%} contradict here" if best.contradicted >= 0.005 else ""
            )
        return None

    def rivalry_at(self, contradicted: float) -> float:
        """Return the rivalry at most, (V245): the more walls speak against the best, the less."""
        return max(LEAST, self.rivalry - self.steep * contradicted)


SAVED = JoinRule(
    rivalry=0.6,
    lead=12.0,
    same=15.0,
    common=15.0,
    steep=20.0,
    lines=4,
    beside=3.5,
    beside_of_little=10.0,
    clash=0.1,
)
OF_THINNED = JoinRule(rivalry=0.75, lead=3.0, contradicted=0.15, same=4.0, common=4.0, deviation=0.2)


@dataclass(frozen=True, eq=False)
class JoinVerdict:
    """What came of the rule for two maps."""

    alignment: Alignment
    doubt: str | None  # why they are not joined; None: they are

    @property
    def joined(self) -> PossibleJoin | None:
        """Where B lies on A, if that is safe."""
        return None if self.doubt is not None else self.alignment.candidates[0]


def judged(a: Charted, b: Charted, seed: int) -> JoinVerdict:
    """Return whether two maps that will not change can be joined.

    The rule must hold for them whole, with more in common than the form of a hall, and no other place that
    looks the same, and for each of `THINNINGS` copies with parts missing, and all at about one pose: what
    depends on a few walls is not believed.

    Args:
        a: first map.
        b: the map that is laid on it.
        seed: of what the copies lack.
    """
    whole = align(a, b)
    doubt = SAVED.doubt(whole) or bare(a, b, whole.candidates[0], SAVED) or _twin(a, b, whole.possible[1:])
    for number in range(THINNINGS):
        if doubt is not None:
            break
        rng = np.random.default_rng([seed, number])
        doubt = _doubt_of_thinned(whole, thinned(a, rng), thinned(b, rng))
    return JoinVerdict(whole, doubt)


def bare(a: Charted, b: Charted, best: PossibleJoin, rule: JoinRule) -> str | None:
    """Return why what two maps have in common, laid so, may be a hall like any other; None: it is more."""
    beside = beside_lines(a, b, best.pose, rule.lines)
    if beside < (rule.beside if best.overlap >= LITTLE else rule.beside_of_little):
        return (
            f"what both have is a few straight lines, as many halls have them: {beside:.1f} m of other walls"
        )
    if best.against > rule.clash * (best.against + beside):
        return (
            f"{best.against:.1f} m of walls contradict each other, where both have {beside:.0f} m of walls "
            "that are no long straight lines"
        )
    return None


def _twin(a: Charted, b: Charted, rivals: Sequence[PossibleJoin]) -> str | None:
    """Return why a place may be a look-alike of another, which less has been seen of; None: it is none."""
    lines, least, contradicted = TWIN
    for rival in rivals:
        if rival.same >= least and rival.contradicted <= contradicted:
            beside = beside_lines(a, b, rival.pose, lines)
            if beside >= least:
                return f"another place looks the same, too: {beside:.0f} m of walls, not in straight lines"
    return None


def _doubt_of_thinned(whole: Alignment, a: Charted | None, b: Charted | None) -> str | None:
    """Return why copies with parts missing, laid where the whole maps may lie, do not lie as those do."""
    if a is None or b is None:
        return "they are too small to be looked at in parts"
    alignment = compared(a, b, [middles(a, b, each.pose) for each in whole.possible])
    doubt = OF_THINNED.doubt(alignment)
    if doubt is None:
        shift, turn = alignment.candidates[0].pose.apart(whole.candidates[0].pose, b.middle)
        if shift > STEADY[0] or turn > STEADY[1]:
            doubt = "they come to lie elsewhere"
    return None if doubt is None else f"where parts are left out, {doubt}"


def thinned(whole: Charted, rng: np.random.Generator) -> Charted | None:
    """Return a map without a share of its ground, block by block; None if nothing is left to go by."""
    side = max(1, round(BLOCK / whole.cell))
    rows, cols = whole.frame.shape
    first = rng.integers(side, size=2)
    blocks = rng.random((rows // side + 2, cols // side + 2)) < THINNED
    gone = blocks[np.ix_((np.arange(rows) + first[0]) // side, (np.arange(cols) + first[1]) // side)]
    classes = np.where(gone, np.uint8(UNKNOWN), whole.classes)
    return charted(whole.frame, classes)
