"""Silent neighbours cut from a round: who is left ends it, with the value of exactly those left."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import reduce

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.support.priced import PRICED, priced
from tests.support.random_teams import Float, Longest, Node, misses
from vedette import Coverage, InputError, Tree, exhaustive
from vedette.negotiation import (
    SCHEMES,
    Chooser,
    JacobiNode,
    Message,
    Outgoing,
    RoundOutcome,
    TokenNode,
    node_of,
)
from vedette.negotiation.fork import ForkNode
from vedette.negotiation.messages import Gather, Stop, Tally, Token, Up
from vedette.problem import Reach
from vedette.problem.reach import behind

CELLS = 12
KINDS = [
    "token",
    "multistart",
    "fork",
    "async",
    "jacobi",
    "token, clipped",
    "multistart, clipped",
    "fork, clipped",
    "async, clipped",
]
SEEDS = st.integers(0, 100_000)


@dataclass
class Round:
    """A round, its messages delivered in any order that links allow, among platforms that fall silent."""

    tree: Tree
    nodes: Sequence[Node]
    team: Sequence[Chooser[Float, Float]]
    candidates: list[list[Float]]
    rng: np.random.Generator
    dead: set[int] = field(default_factory=set)
    cut: set[tuple[int, int]] = field(default_factory=set)  # (parent, child)
    cut_at: int = 0  # messages delivered before the last cut on the root's side
    log: list[tuple[int, Message[Float]]] = field(default_factory=list)  # to whom, and what
    _waiting: list[int] = field(default_factory=list)
    _links: dict[tuple[int, int], list[Message[Float]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._waiting = [int(i) for i in self.rng.permutation(self.tree.n)]

    def happen(self) -> bool:
        """Start a node or deliver a message; tell whether there was anything to do."""
        if self._waiting and (not self._links or self.rng.uniform() < 0.3):
            i = self._waiting.pop()
            if i not in self.dead:
                self._post(i, self.nodes[i].start())
            return True
        if not self._links:
            return False
        sender, to = list(self._links)[self.rng.integers(len(self._links))]
        message = self._links[sender, to].pop(0)
        if not self._links[sender, to]:
            del self._links[sender, to]
        if to not in self.dead:
            self.log.append((to, message))
            self._post(to, self.nodes[to].receive(sender, message))
        return True

    def cut_off(self, parent: int, child: int) -> None:
        """Let a platform go on without a child."""
        self.cut.add((parent, child))
        if parent in joined(self):
            self.cut_at = len(self.log)
        self._post(parent, self.nodes[parent].cut(child))

    def _post(self, sender: int, sends: Sequence[Outgoing[Float]]) -> None:
        for send in sends:
            self._links.setdefault((sender, send.to), []).append(send.message)

    def silent(self) -> list[tuple[int, int]]:
        """Living parents and the dead children that they wait for."""
        parents = self.tree.parents()
        return [
            (i, k)
            for i, node in enumerate(self.nodes)
            if i not in self.dead
            for k in sorted(node.waiting_for)
            if k in self.dead and k != parents[i]
        ]

    def finish(self) -> RoundOutcome:
        """Deliver everything, cut whoever is dead and waited for, until the root is through."""
        while True:
            if self.happen():
                continue
            silent = self.silent()
            if not silent:
                break
            self.cut_off(*silent[self.rng.integers(len(silent))])
        outcome = self.nodes[0].finished
        assert outcome is not None
        return outcome

    def value_of(self, members: set[int], weights: Float) -> float:
        """Brute force: what these platforms' present strategies are worth."""
        return PRICED.value(weights, together(weights, (self.team[i].impact for i in members)))

    def ended(self) -> set[int]:
        """Who has the root's outcome."""
        return {i for i, node in enumerate(self.nodes) if node.finished is self.nodes[0].finished} - self.dead


def reached(tree: Tree, gone: set[int]) -> set[int]:
    """Platforms joined to platform 0 by platforms that are not gone."""
    found, ahead = set(), [0]
    while ahead:
        found.add(i := ahead.pop())
        ahead += [k for k in tree.neighbours(i) if k not in found and k not in gone]
    return found


def together(weights: Float, impacts: Iterable[Float]) -> Float:
    """All of them combined."""
    return reduce(PRICED.combine, impacts, PRICED.nothing(weights))


def round_of(rng: np.random.Generator, n: int, kind: str, tree: Tree | None = None) -> tuple[Round, Float]:
    """A random team, in one of two with prices, and its weights.

    "clipped": each sees a few cells, and messages are clipped.
    """
    tree, weights = tree or Tree.random(n, seed=rng), rng.uniform(0.2, 1.0, size=CELLS)
    dear = float(rng.choice([0.0, 2.0]))
    candidates = [priced(rng, own, dear) for own in misses(rng, n, 4, CELLS)]
    parents = tree.parents()
    reaches: list[dict[int, Reach]] = [{} for _ in range(n)]
    if "clipped" in kind:
        first = rng.integers(0, CELLS - 3, size=n)
        own: list[Reach] = [((float(x), 0.0, float(x + 3), 0.0),) for x in first]
        for i in range(n):
            for k, impact in enumerate(candidates[i]):
                candidates[i][k] = PRICED.clip(weights, impact, own[i])
        for i in range(n):
            for k in tree.neighbours(i):
                reaches[i][k] = _reach_beyond(tree, own, i, k)
    begun = dear or rng.uniform() < 0.7  # a first choice may lower the value if it costs something
    start: list[int | None] = rng.integers(4, size=n).tolist() if begun else [None] * n
    team = [Chooser(PRICED, weights, own, start=k) for own, k in zip(candidates, start, strict=True)]
    nodes: list[Node] = [
        node_of(kind.split(",")[0], tree.neighbours(i), parents[i], team[i], reaches=reaches[i])
        for i in range(n)
    ]
    return Round(tree, nodes, team, candidates, rng), weights


def _reach_beyond(tree: Tree, own: Sequence[Reach], here: int, there: int) -> Reach:
    """The joint reach of all behind a link."""
    heard = {k: _reach_beyond(tree, own, there, k) for k in tree.neighbours(there) if k != here}
    return behind(own[there], {**heard, here: ()})[here]


def joined(run: Round) -> set[int]:
    """Platforms joined to the root by links that nobody cut."""
    found: set[int] = set()
    ahead = [0]
    while ahead:
        found.add(i := ahead.pop())
        ahead += [k for k in run.tree.neighbours(i) if k not in found and not {(i, k), (k, i)} & run.cut]
    return found


def play(run: Round) -> RoundOutcome:
    """Let some platforms fall silent at any message, some of them later; return how the round ends."""
    rng, n = run.rng, run.tree.n
    dying = rng.permutation(np.arange(1, n))[: rng.integers(1, n)].tolist()
    for half in (dying[: len(dying) // 2], dying):
        for _ in range(rng.integers(0, 40)):
            run.happen()
        run.dead.update(half)
    return run.finish()


def let_the_refused_go_back(run: Round, counted: set[int]) -> None:
    """Let those be as they are counted who fell silent before they heard that a fork takes them back."""
    parents, back = run.tree.parents(), set[int]()
    for i in sorted(counted, key=lambda i: len(_ancestors(parents, i))):
        parent = parents[i]
        node, above = run.nodes[i], None if parent is None else run.nodes[parent]
        if not (isinstance(node, ForkNode) and isinstance(above, ForkNode)):
            continue
        if parent in back or (i in run.dead and i in above._refused):
            run.team[i].adopt(node._before[0])
            back.add(i)


def _ancestors(parents: Sequence[int | None], i: int) -> list[int]:
    found = []
    while (parent := parents[i]) is not None:
        found.append(i := parent)
    return found


@settings(deadline=None, max_examples=150)
@given(seed=SEEDS, n=st.integers(2, 10), kind=st.sampled_from(KINDS))
@example(seed=53, n=10, kind="fork, clipped")  # one is refused, and dies before it hears of it
def test_whoever_is_left_ends_with_the_value_of_exactly_those_left(seed: int, n: int, kind: str) -> None:
    run, weights = round_of(np.random.default_rng(seed), n, kind)
    outcome = play(run)
    counted = joined(run)  # who dies unnoticed counts, but does not go back to Jacobi's best iterate
    let_the_refused_go_back(run, counted)
    if kind != "jacobi" or not counted & run.dead:
        assert outcome.value == pytest.approx(run.value_of(counted, weights), abs=1e-9)
    assert counted & reached(run.tree, run.dead) <= run.ended() <= counted
    assert all(not node.waiting_for for i, node in enumerate(run.nodes) if i in run.ended())


@settings(deadline=None, max_examples=100)
@given(seed=SEEDS, n=st.integers(2, 8), kind=st.sampled_from(KINDS))
def test_those_cut_at_any_time_are_in_the_value_only_if_they_hear_the_end(
    seed: int, n: int, kind: str
) -> None:
    rng = np.random.default_rng(seed)
    run, weights = round_of(rng, n, kind)
    parents = run.tree.parents()
    out: set[int] = set()
    for child in rng.permutation(np.arange(1, n))[: rng.integers(1, n)].tolist():
        for _ in range(rng.integers(0, 30)):
            run.happen()
        parent = parents[child]
        assert parent is not None
        out |= {child} & run.nodes[parent].waiting_for
        run.cut_off(parent, child)
    outcome = run.finish()
    assert joined(run) <= run.ended()
    assert not out & run.ended()
    assert outcome.value == pytest.approx(run.value_of(run.ended(), weights), abs=1e-9)


@settings(deadline=None, max_examples=60)
@given(seed=SEEDS, n=st.integers(2, 9), kind=st.sampled_from(["token", "token, clipped"]))
def test_after_a_cut_the_value_never_falls_and_ends_where_nobody_gains_alone(
    seed: int, n: int, kind: str
) -> None:
    run, weights = round_of(np.random.default_rng(seed), n, kind)
    outcome = play(run)
    counted = joined(run)
    late = [message for to, message in run.log[run.cut_at :] if to in counted]
    values = [message.tally.value for message in late if isinstance(message, Token)]
    assert (np.diff([*values, outcome.value]) >= -1e-9).all()
    assert outcome.converged
    for i in run.ended():
        rest = together(weights, (run.team[k].impact for k in counted - {i}))
        best = PRICED.values(weights, rest, run.candidates[i]).max()
        assert best <= outcome.value + 1e-8


@settings(deadline=None, max_examples=60)
@given(seed=SEEDS, n=st.integers(2, 4), kind=st.sampled_from(KINDS))
def test_the_bound_after_a_cut_is_above_the_optimum_of_those_left(seed: int, n: int, kind: str) -> None:
    run, weights = round_of(np.random.default_rng(seed), n, kind)
    outcome = play(run)
    best = exhaustive(PRICED, weights, [run.candidates[i] for i in sorted(joined(run))]).value
    assert outcome.bound is not None
    assert outcome.value <= best + 1e-9 <= outcome.bound + 2e-9


@pytest.mark.parametrize("kind", SCHEMES)
def test_who_loses_everybody_decides_alone(kind: str) -> None:
    run, weights = round_of(np.random.default_rng(3), 5, kind, Tree.star(5))
    run.dead.update({1, 2, 3, 4})
    outcome = run.finish()
    alone = max(PRICED.value(weights, own) for own in run.candidates[0])
    assert run.ended() == {0}
    assert outcome.value == outcome.bound == pytest.approx(alone)


@pytest.mark.parametrize("scheme", [TokenNode, JacobiNode])
def test_only_children_can_be_cut_and_once_is_enough(scheme: type[Node]) -> None:
    node = scheme([1, 2, 3], 1, Chooser(Coverage(), np.ones(2), [np.zeros(2)]))
    node.start()
    assert node.waiting_for == {2, 3}
    with pytest.raises(InputError, match="7, who is not a neighbour"):
        node.cut(7)
    with pytest.raises(InputError, match="1 is the parent, who cannot be cut; give the round up"):
        node.cut(1)
    assert node.cut(2) == node.cut(2) == []
    assert node.waiting_for == {3}
    assert [send.to for send in node.cut(3)] == [1]
    assert node.waiting_for == {1}


@pytest.mark.parametrize("scheme", [TokenNode, JacobiNode])
def test_what_a_cut_child_still_says_is_dropped_without_a_word(scheme: type[Node]) -> None:
    node = scheme([1, 2], None, Chooser(Coverage(), np.ones(2), [np.zeros(2)]))
    node.start()
    node.cut(1)
    mu, tally = np.ones(2), Tally(turns=0, quiet=0, value=0.0, slack=0.0, size=3, ceiling=1.0)
    late: list[Message[Float]] = [
        Gather(mu, 1, 0.0, 0.0),
        Token(mu, tally),
        Up(mu, 0.0, 0.0, ()),
        Stop(RoundOutcome(9.0, None, 1, True)),
    ]
    assert [node.receive(1, message) for message in late] == [[]] * len(late)
    assert node.finished is None
    assert node.waiting_for == {2}


def test_a_cut_takes_an_unknown_ceiling_off_without_a_bound_that_is_not_a_number() -> None:
    team = [Chooser(Longest(), None, [own, own + 1.0]) for own in (5.0, 4.0, 3.0)]
    tree = Tree.chain(3)
    parents = tree.parents()
    nodes = [TokenNode(tree.neighbours(i), parents[i], own) for i, own in enumerate(team)]
    for node in nodes[1:]:
        node.start()
    (gathered,) = nodes[1].receive(2, Gather(0.0, 1, math.inf, 0.0))
    nodes[0].start()
    (token,) = nodes[0].receive(1, gathered.message)
    (onwards,) = nodes[1].receive(0, token.message)
    assert onwards.to == 2
    (back,) = nodes[1].cut(2)
    assert (back.to, isinstance(back.message, Token)) == (0, True)
    nodes[0].receive(1, back.message)
    nodes[0].cut(1)
    assert nodes[0].finished is not None
    assert (nodes[0].finished.value, nodes[0].finished.bound) == (-5.0, None)


@pytest.mark.parametrize("seed", range(20))
def test_after_a_cut_the_ceiling_is_what_those_left_could_have_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    weights, candidates = rng.uniform(0.2, 1.0, CELLS), misses(rng, 4, 3, CELLS)
    tree = Tree.chain(4)
    parents = tree.parents()
    team = [Chooser(Coverage(), weights, own) for own in candidates]
    nodes = [TokenNode(tree.neighbours(i), parents[i], team[i], max_sweeps=1) for i in range(4)]
    run = Round(tree, nodes, team, candidates, rng)
    while not (run.log and isinstance(run.log[-1][1], Token) and run.log[-1][0] == 2):
        run.happen()
    run.dead.add(3)  # who has been sent the token, and is told of by two
    outcome = run.finish()
    alone = [max(float(np.sum(weights * (1.0 - own))) for own in candidates[i]) for i in range(3)]
    assert outcome.bound is not None
    assert outcome.bound <= sum(alone) + 1e-9


class Diary(Chooser[Float, Float]):
    """A chooser that writes down what it did in each iterate."""

    def __init__(self, weights: Float, candidates: list[Float], start: int) -> None:
        super().__init__(Coverage(), weights, candidates, start=start)
        self.pages: list[int | None] = [start]

    def reply(self, others: Float) -> bool:
        """Choose, and write it down."""
        changed = super().reply(others)
        self.pages.append(self.index)
        return changed


@pytest.mark.parametrize("cut", range(1, 4))
def test_after_a_cut_only_what_those_left_did_since_proves_a_cycle(cut: int) -> None:
    ends: set[str] = set()
    for seed in range(60):
        rng = np.random.default_rng(seed)
        weights, candidates = rng.uniform(0.2, 1.0, 3), misses(rng, 3, 3, 3)
        team = [Diary(weights, own, start=int(rng.integers(3))) for own in candidates]
        tree = Tree.star(3)
        nodes = [JacobiNode(tree.neighbours(i), tree.parents()[i], team[i]) for i in range(3)]
        run = Round(tree, nodes, team, candidates, rng)
        while len(nodes[0].values) < cut and run.happen():
            pass
        if nodes[0].finished:
            continue
        run.dead.add(2)
        outcome = run.finish()
        done = list(zip(team[0].pages, team[1].pages, strict=True))
        since = done[cut if (0, 2) in run.cut else 0 :]
        recurs = since.index(since[-1])
        assert len(set(since[:-1])) == len(since) - 1, "an earlier iterate had ended it"
        if recurs < len(since) - 1:
            length = len(since) - 1 - recurs
            assert outcome.cycle == (0 if length == 1 else length)
            ends.add("cycle" if outcome.cycle else "fixed point")
        else:
            assert outcome.value == pytest.approx(outcome.bound, rel=1e-6), "nothing recurred"
            ends.add("ceiling")
    assert "fixed point" in ends


def test_a_token_that_miscounts_the_team_is_refused() -> None:
    node = TokenNode([1, 2], None, Chooser(Coverage(), np.ones(2), [np.ones(2)]))
    node.start()
    node.receive(1, Gather(np.ones(2), 2, 1.0, 0.0))
    (send,) = node.receive(2, Gather(np.ones(2), 1, 1.0, 0.0))
    assert isinstance(send.message, Token)
    tally = send.message.tally
    assert tally.size == 4
    for size in (2, 5, 2**50):
        with pytest.raises(InputError, match=f"token of a team of {size}"):
            node.receive(1, Token(None, Tally(1, 0, 0.0, 0.0, size, 1.0)))
    assert node.waiting_for == {1}
