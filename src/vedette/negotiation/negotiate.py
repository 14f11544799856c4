"""A whole negotiation in one process: every platform's node, and the post between them."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import msgspec

from vedette.negotiation import messages
from vedette.negotiation.chooser import Chooser
from vedette.negotiation.door import check_codec, check_round, checked_reach, listed_impacts, remover
from vedette.negotiation.jacobi import JacobiNode
from vedette.negotiation.multistart import MultistartNode
from vedette.negotiation.node import Negotiator, Outgoing
from vedette.negotiation.optimiser import Optimiser
from vedette.negotiation.schemes import Node, node_of
from vedette.negotiation.token import TokenNode
from vedette.negotiation.tree import Tree
from vedette.problem.checked import value_of
from vedette.problem.controls import Controls, Float
from vedette.problem.door import check_choice, check_problem
from vedette.problem.objective import BeliefT, Codec, ImpactT, Objective
from vedette.problem.reach import Reach, behind, join
from vedette.problem.trial import Trial


@dataclass(frozen=True)
class Step:
    """The team's value after a turn (token), a sweep (fork), a change (async) or at an iterate (jacobi)."""

    sweep: int  # 0: at the start
    platform: int | None  # whose turn it was; None: everybody's
    value: float


@dataclass(frozen=True)
class Negotiation:
    """What a team agreed on, and what that took."""

    choice: tuple[int, ...]  # candidate index of each platform; -1 where it has controls instead
    value: float  # of the choice over nothing, in the objective's unit
    bound: float | None  # the optimum is no higher; None: the objective declares too little
    sweeps: int  # in which platforms replied
    messages: int  # sent in all
    bytes: int  # of all messages
    history: tuple[Step, ...]
    converged: bool  # nobody can gain more than epsilon by changing alone
    cycle: int  # period of the cycle that Jacobi ran into, 0 if none
    controls: tuple[Float | None, ...]  # each platform's, (d,); None where it has a list


def negotiate(
    objective: Objective[BeliefT, ImpactT],
    belief: BeliefT,
    candidates: Sequence[Sequence[ImpactT] | Controls[ImpactT]],
    tree: Tree,
    scheme: str = "token",
    *,
    start: Sequence[int] | None = None,
    epsilon: float = 1e-9,
    max_sweeps: int = 50,
    inverse: bool = False,
    codec: Codec[ImpactT] | None = None,
    reach: Sequence[Reach] | None = None,
    guard: bool = True,
) -> Negotiation:
    """Let every platform choose one of its candidates by messages on a tree, towards ``max psi``.

    Each platform sees its own candidates and its neighbours' messages, nothing else (paper, section 3.4).

    Args:
        objective: the team's ``*`` and ``psi``.
        belief: what the value depends on; the same for all.
        candidates: ``candidates[i]`` is the list of platform i's impacts, or its ``Controls``: it then
            replies by optimising, until its control changes by less than its threshold.
        tree: who talks to whom.
        scheme: ``token``, one after the other, never lowers the value; ``multistart``, that twice in opposite
            orders, ends at the better; ``fork``, all branches of the tree at once, takes back what does not
            go together; ``async``, whenever news comes, confirms changes before they count; ``jacobi``, all
            at once (paper, Table 1), ends at its best iterate.
        start: everybody's first candidate index, 0 for Controls, which have a start of their own; without
            it nobody with a list observes until its first reply, so that the first token sweep is the
            sequential greedy choice.
        epsilon: a platform changes only for more than this share of the present value.
        max_sweeps: the round ends after so many.
        inverse: with ``jacobi`` on a chain, send the team's total down it and let everybody remove its
            own impact by ``objective.remove`` (paper, Fig. 1).
        codec: how impacts travel; without it they are handed over and their plain size is counted.
        reach: where each platform can make a difference, as boxes (lowest x, lowest y, highest x, highest y).
            With it, and an objective that has ``clip``, messages leave out what the platforms that they
            are for cannot reach: no choice changes. Not with ``jacobi``; telling the reaches counts.
        guard: with ``async``, False lets changes count at once, unconfirmed: the value may fall, and
            platforms that answer each other's old places go on until ``max_sweeps`` changes of one.

    Raises:
        InputError: bad arguments, the line names platform, index and value; or an objective that changes what
            it is given, has another identity than nothing, or a value that is not a finite number. What an
            objective raises itself passes through.
    """
    listed = listed_impacts(candidates)
    check_problem(objective, belief, listed)
    check_round(tree, len(candidates), scheme, epsilon, max_sweeps, inverse, guard)
    choices = [(own,) if isinstance(own, Controls) else own for own in candidates]
    begun = [None] * tree.n if start is None else check_choice(start, choices, "start")
    reach = None if reach is None else checked_reach(objective, tree, scheme, reach)
    remove = remover(objective, tree, scheme) if inverse else None
    if codec is not None:
        check_codec(objective, belief, codec, listed[0][0])
    _try_out(objective, belief, listed, inverse, reach)
    base = value_of(objective, belief, objective.nothing(belief))
    seats = [
        Optimiser(objective, belief, own, base=base)
        if isinstance(own, Controls)
        else Chooser(objective, belief, own, start=first, epsilon=epsilon, base=base)
        for own, first in zip(candidates, begun, strict=True)
    ]
    root = next(i for i in range(tree.n) if len(tree.neighbours(i)) <= 1) if inverse else 0  # a chain's end
    parents = tree.parents(root)
    before = reduce(objective.combine, (seat.impact for seat in seats))
    reaches, told, told_size = tell_reaches(tree, parents, reach)
    nodes = [
        node_of(
            scheme,
            tree.neighbours(i),
            parents[i],
            seat,
            epsilon=epsilon,
            max_sweeps=max_sweeps,
            reaches=reaches[i],
            remove=remove,
            guard=guard,
        )
        for i, seat in enumerate(seats)
    ]
    sent, size = _deliver(nodes, codec)
    outcome = nodes[root].finished
    assert outcome is not None  # max_sweeps ends every round
    return Negotiation(
        choice=tuple(_index(seat) for seat in seats),
        value=outcome.value,
        bound=outcome.bound,
        sweeps=outcome.sweeps,
        messages=told + sent,
        bytes=told_size + size,
        history=(Step(0, None, seats[0].value(before)), *_steps(nodes)),
        converged=outcome.converged,
        cycle=outcome.cycle,
        controls=tuple(seat.control if isinstance(seat, Optimiser) else None for seat in seats),
    )


def _index(seat: Chooser[BeliefT, ImpactT] | Optimiser[BeliefT, ImpactT]) -> int:
    """Return the candidate that a platform ended with, -1 where it has controls."""
    if isinstance(seat, Optimiser):
        return -1
    assert seat.index is not None  # everybody has replied
    return seat.index


def _try_out(
    objective: Objective[BeliefT, ImpactT],
    belief: BeliefT,
    candidates: Sequence[Sequence[ImpactT]],
    inverse: bool,
    reach: Sequence[Reach] | None,
) -> None:
    """Raise ``InputError`` for an objective that two of the candidates show not to be believed."""
    trial = Trial(objective, belief, candidates)
    trial.laws()
    if inverse:
        trial.inverse()
    if reach is not None:
        trial.clip(reach[0])


def _deliver(nodes: Sequence[Negotiator[ImpactT]], codec: Codec[ImpactT] | None) -> tuple[int, int]:
    """Start all nodes and carry their messages, oldest first; return how many and how many bytes."""
    post: deque[tuple[int, Outgoing[ImpactT]]] = deque()
    for i, node in enumerate(nodes):
        post.extend((i, send) for send in node.start())
    sent = size = 0
    while post:
        sender, send = post.popleft()
        message = send.message
        sent += 1
        if codec is None:
            size += messages.size(message)
        else:
            data = messages.encode(message, codec)
            size += len(data)
            message = messages.decode(data, codec)
        post.extend((send.to, reply) for reply in nodes[send.to].receive(sender, message))
    return sent, size


def tell_reaches(
    tree: Tree, parents: Sequence[int | None], reach: Sequence[Reach] | None
) -> tuple[list[dict[int, Reach]], int, int]:
    """Return what each platform hears from each neighbour of the reach beyond it, and how much was said."""
    heard: list[dict[int, Reach]] = [{} for _ in range(tree.n)]
    if reach is None:
        return heard, 0, 0
    order = _outwards(tree, parents)
    said: list[Reach] = []
    for i in reversed(order):
        parent = parents[i]
        if parent is not None:
            said.append(join(reach[i], *heard[i].values()))
            heard[parent][i] = said[-1]
    for i in order:
        for k, there in behind(reach[i], heard[i]).items():
            if k != parents[i]:
                said.append(there)
                heard[k][i] = there
    return heard, len(said), sum(len(msgspec.msgpack.encode(there)) for there in said)


def _outwards(tree: Tree, parents: Sequence[int | None]) -> list[int]:
    """Return all platforms, each after its parent."""
    order = [i for i in range(tree.n) if parents[i] is None]
    for i in order:  # grows as it is walked
        order.extend(k for k in tree.neighbours(i) if k != parents[i])
    return order


def _turns(node: TokenNode[ImpactT] | MultistartNode[ImpactT], n: int) -> list[tuple[int, float]]:
    """Return a platform's turns, each with its number and the value after it; a second round's go on."""
    rounds = [node] if isinstance(node, TokenNode) else node.rounds
    before = [0, *(each.finished.sweeps * n for each in rounds if each.finished is not None)]
    return [
        (begun + k, value) for begun, each in zip(before, rounds, strict=False) for k, value in each.turns
    ]


def _steps(nodes: Sequence[Node[ImpactT]]) -> list[Step]:
    """Return the values after the start, in the order in which they came about."""
    n = len(nodes)
    iterates: list[Step] = []
    turns: list[tuple[int, int, float]] = []
    for i, node in enumerate(nodes):
        if isinstance(node, TokenNode | MultistartNode):
            turns.extend((k, i, value) for k, value in _turns(node, n))
        else:  # only the root has any
            first = 0 if isinstance(node, JacobiNode) else 1  # iterate 0 is the start
            sweeps = enumerate(node.values, first)
            iterates.extend(Step(sweep, None, value) for sweep, value in sweeps if sweep > 0)
    return iterates + [Step(-(-k // n), i, value) for k, i, value in sorted(turns)]
