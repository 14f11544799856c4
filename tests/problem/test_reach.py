"""Messages that leave out what their receivers cannot reach: same choices, same values, fewer bytes."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette import Coverage, InputError, Tree, negotiate
from vedette.problem.reach import MOST_BOXES, Box, Reach, behind, join

Float = NDArray[np.float64]


class Strip(Coverage):
    """Coverage of cells 0, 1, 2, ... at x = 0.5, 1.5, 2.5, ...; impacts are dense arrays."""

    def clip(self, belief: Float, impact: Float, reach: Reach) -> Float:
        """Forget what lies in none of the boxes."""
        x = np.arange(len(belief)) + 0.5
        inside = np.zeros(len(belief), bool)
        for box in reach:
            inside |= (box[0] <= x) & (x <= box[2])
        return np.where(inside, impact, 1.0)


class Sparse:
    """Codec that sends what differs from the identity."""

    def __init__(self, cells: int) -> None:
        self.cells = cells

    def encode(self, impact: Float) -> bytes:
        """Cells and misses."""
        cells = np.flatnonzero(impact != 1.0)
        return cells.astype("<u4").tobytes() + impact[cells].astype("<f8").tobytes()

    def decode(self, data: bytes) -> Float:
        """All other cells are missed."""
        count = len(data) // 12
        impact = np.ones(self.cells)
        impact[np.frombuffer(data, "<u4", count)] = np.frombuffer(data, "<f8", count, 4 * count)
        return impact


def strip_team(
    seed: int, n: int, k: int = 4, spread: int = 6
) -> tuple[Float, list[list[Float]], list[Reach]]:
    """Return weights, candidates and reaches of platforms in a row that see some cells around their own."""
    rng = np.random.default_rng(seed)
    cells = 3 * n + 2 * spread
    weights = rng.uniform(size=cells)
    candidates, reaches = [], []
    for i in range(n):
        low, high = 3 * i, 3 * i + 2 * spread
        own = []
        for _ in range(k):
            impact = np.ones(cells)
            seen = rng.choice(np.arange(low, high), size=4, replace=False)
            impact[seen] = rng.choice([0.0, 0.3, 0.8], size=4)
            own.append(impact)
        candidates.append(own)
        reaches.append(((float(low), 0.0, float(high), 1.0),))
    return weights, candidates, reaches


@pytest.mark.parametrize("kind", [Tree.chain, Tree.star, Tree.balanced])
@pytest.mark.parametrize("start", [False, True])
def test_with_reaches_a_team_chooses_what_it_chooses_without_and_counts_the_same_value(
    kind: type[Tree], start: bool
) -> None:
    for seed in range(8):
        weights, candidates, reaches = strip_team(seed, n=9)
        tree = kind(9)  # type: ignore[call-arg]
        first = [seed % 4] * 9 if start else None
        whole = negotiate(Strip(), weights, candidates, tree, start=first)
        clipped = negotiate(Strip(), weights, candidates, tree, start=first, reach=reaches)
        assert clipped.choice == whole.choice
        assert clipped.value == pytest.approx(whole.value, abs=1e-12)
        assert clipped.bound == pytest.approx(whole.bound, abs=1e-12)
        assert clipped.sweeps == whole.sweeps


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 12))
def test_on_any_tree_clipping_changes_no_choice(seed: int, n: int) -> None:
    weights, candidates, reaches = strip_team(seed, n)
    tree = Tree.random(n, seed=seed)
    whole = negotiate(Strip(), weights, candidates, tree, codec=Sparse(len(weights)))
    clipped = negotiate(Strip(), weights, candidates, tree, codec=Sparse(len(weights)), reach=reaches)
    assert clipped.choice == whole.choice
    assert clipped.value == pytest.approx(whole.value, abs=1e-12)
    assert clipped.messages == whole.messages + 2 * (n - 1)


def test_on_a_chain_along_the_strip_clipped_messages_do_not_grow_with_the_team() -> None:
    per_message = []
    for n in (16, 64):
        weights, candidates, reaches = strip_team(1, n)
        codec = Sparse(len(weights))
        result = negotiate(Strip(), weights, candidates, Tree.chain(n), codec=codec, reach=reaches)
        whole = negotiate(Strip(), weights, candidates, Tree.chain(n), codec=codec)
        per_message.append(result.bytes / result.messages)
        assert result.bytes < 0.6 * whole.bytes
    assert per_message[1] < 1.2 * per_message[0]


BOXES = st.tuples(*[st.floats(-50, 50)] * 4).map(
    lambda b: (min(b[0], b[2]), min(b[1], b[3]), max(b[0], b[2]), max(b[1], b[3]))
)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.lists(BOXES, max_size=4), max_size=6))
def test_a_joined_reach_holds_every_box_in_few(reaches: list[list[Box]]) -> None:
    joined = join(*(tuple(boxes) for boxes in reaches))
    assert len(joined) <= MOST_BOXES
    for box in (box for boxes in reaches for box in boxes):
        assert any(j[0] <= box[0] and j[1] <= box[1] and box[2] <= j[2] and box[3] <= j[3] for j in joined)


@pytest.mark.parametrize("seed", range(20))
def test_of_five_boxes_those_two_are_joined_that_waste_least(seed: int) -> None:
    corners = np.sort(np.random.default_rng(seed).uniform(-50, 50, (5, 2, 2)), axis=1)
    boxes: list[Box] = [(*low, *high) for low, high in corners.tolist()]

    def around(one: Box, other: Box) -> Box:
        return (*map(min, one[:2], other[:2]), *map(max, one[2:], other[2:]))  # type: ignore[return-value]

    def area(reach: Reach) -> float:
        return sum((box[2] - box[0]) * (box[3] - box[1]) for box in reach)

    joined = [
        (around(one, other), *(box for box in boxes if box not in (one, other)))
        for one, other in combinations(boxes, 2)
    ]
    assert area(join(tuple(boxes))) == pytest.approx(min(map(area, joined)), rel=1e-12)


def test_a_neighbour_is_told_of_everybody_but_those_beyond_it() -> None:
    heard: dict[int, Reach] = {k: ((float(k), 0.0, k + 0.5, 1.0),) for k in (3, 5, 8)}
    own: Reach = ((0.0, 0.0, 0.5, 1.0),)
    told = behind(own, heard)
    assert told == {k: join(own, *(heard[j] for j in heard if j != k)) for k in heard}


@pytest.mark.parametrize(
    ("reach", "scheme", "message"),
    [
        ([()], "token", "reach has 1 for 2 platforms"),
        ([(), ((1.0, 0.0, 0.0, 1.0),)], "token", r"reach\[1\] has .* a box is lowest x"),
        ([(), ()], "jacobi", "reach goes with token, fork and async"),
    ],
)
def test_a_reach_that_makes_no_sense_is_refused(reach: list[Reach], scheme: str, message: str) -> None:
    weights, candidates, _ = strip_team(0, 2)
    with pytest.raises(InputError, match=message):
        negotiate(Strip(), weights, candidates, Tree.chain(2), scheme, reach=reach)


def test_an_objective_that_cannot_clip_is_refused() -> None:
    weights, candidates, reaches = strip_team(0, 2)
    with pytest.raises(InputError, match=r"needs Coverage\.clip"):
        negotiate(Coverage(), weights, candidates, Tree.chain(2), reach=reaches)
