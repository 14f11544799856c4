"""How platforms take turns, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from vedette.errors import check_word
from vedette.negotiation.asynchronous import AsyncNode
from vedette.negotiation.fork import ForkNode
from vedette.negotiation.jacobi import JacobiNode
from vedette.negotiation.multistart import MultistartNode
from vedette.negotiation.node import Claims, Participant
from vedette.negotiation.token import TokenNode
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach

Node: TypeAlias = (
    TokenNode[ImpactT]
    | MultistartNode[ImpactT]
    | ForkNode[ImpactT]
    | AsyncNode[ImpactT]
    | JacobiNode[ImpactT]
)
SCHEMES = ("token", "multistart", "fork", "async", "jacobi")


def node_of(
    scheme: str,
    neighbours: Sequence[int],
    parent: int | None,
    own: Participant[ImpactT],
    *,
    epsilon: float = 1e-9,
    max_sweeps: int = 50,
    reaches: Mapping[int, Reach] | None = None,
    remove: Callable[[ImpactT, ImpactT], ImpactT] | None = None,
    claims: Claims[ImpactT] | None = None,
    guard: bool = True,
) -> Node[ImpactT]:
    """Return a platform's part in a round of one of the ``SCHEMES``; InputError for another name.

    ``reaches`` are not for ``jacobi``, ``remove`` is for it alone, ``guard`` for ``async``; all else as the
    nodes take it.
    """
    check_word("scheme", scheme, SCHEMES)
    if scheme == "async":
        return AsyncNode(
            neighbours, parent, own, max_sweeps=max_sweeps, reaches=reaches, claims=claims, guard=guard
        )
    if scheme != "jacobi":
        kinds: Mapping[str, Callable[..., Node[ImpactT]]] = {
            "token": TokenNode,
            "multistart": MultistartNode,
            "fork": ForkNode,
        }
        return kinds[scheme](
            neighbours, parent, own, epsilon=epsilon, max_sweeps=max_sweeps, reaches=reaches, claims=claims
        )
    return JacobiNode(
        neighbours, parent, own, epsilon=epsilon, max_sweeps=max_sweeps, remove=remove, claims=claims
    )
