"""What a negotiation is given is checked once, before the first message."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from vedette.errors import InputError, brief, check_word
from vedette.negotiation.schemes import SCHEMES
from vedette.negotiation.tree import Tree
from vedette.number import is_number, is_whole, many
from vedette.problem.controls import Controls
from vedette.problem.door import check_list
from vedette.problem.objective import BeliefT, Codec, ImpactT, Invertible, Objective
from vedette.problem.reach import Box, Clippable, Reach


def check_round(
    tree: Tree, platforms: int, scheme: str, epsilon: float, max_sweeps: int, inverse: bool, guard: bool
) -> None:
    """Raise ``InputError`` for no tree over so many platforms, no scheme, no threshold or no sweep."""
    if not isinstance(tree, Tree):
        raise InputError(f"tree is {brief(tree)}; give a Tree, say Tree.chain({platforms})")
    if platforms != tree.n:
        raise InputError(f"candidates has {platforms} lists for a tree of {tree.n}; give one each")

    check_word("scheme", scheme, SCHEMES)
    if not is_number(epsilon) or epsilon < 0.0:
        raise InputError(f"epsilon must be a number >= 0; got {brief(epsilon)}")
    if not is_whole(max_sweeps):
        raise InputError(f"max_sweeps must be a whole number; got {brief(max_sweeps)}")
    if max_sweeps < 1:
        raise InputError(f"max_sweeps must be at least 1; got {max_sweeps}")
    if not isinstance(inverse, bool | np.bool_):
        raise InputError(f"inverse must be True or False; got {brief(inverse)}")
    if not isinstance(guard, bool | np.bool_):
        raise InputError(f"guard must be True or False; got {brief(guard)}")
    if scheme != "async" and not guard:
        raise InputError(f"guard=False belongs to scheme 'async'; got {scheme!r}")


def listed_impacts(candidates: Sequence[Sequence[ImpactT] | Controls[ImpactT]]) -> list[Sequence[ImpactT]]:
    """Return each platform's list, with examples in the place of controls; ``InputError`` for no list."""
    check_list(candidates, "candidates", "a list of every platform's list of impacts, or its Controls")
    return [own.examples if isinstance(own, Controls) else own for own in candidates]


def remover(
    objective: Objective[BeliefT, ImpactT], tree: Tree, scheme: str
) -> Callable[[ImpactT, ImpactT], ImpactT]:
    """Return ``objective.remove`` for the paper's own sweep; ``InputError`` where that cannot run."""
    if scheme != "jacobi":
        raise InputError(f"inverse=True belongs to scheme 'jacobi'; got {scheme!r}")
    if not tree.is_chain:
        raise InputError("inverse=True needs a chain; use Tree.chain(n), or leave inverse out on other trees")
    if not isinstance(objective, Invertible):
        raise InputError(
            f"inverse=True needs {type(objective).__name__}.remove(total, own); leave inverse out"
        )
    return objective.remove


def check_codec(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, codec: Codec[ImpactT], impact: ImpactT
) -> None:
    """Raise ``InputError`` if a codec does not make bytes of an impact, and an impact of them."""
    if not all(callable(getattr(codec, name, None)) for name in ("encode", "decode")):
        raise InputError(f"codec is {brief(codec)}; give an object with encode(impact) and decode(data)")
    name = type(codec).__name__
    data = codec.encode(impact)
    if not isinstance(data, bytes | bytearray | memoryview):
        raise InputError(f"{name}.encode returned {brief(data)}; it must return bytes")
    back = codec.decode(bytes(data))
    if back is None:
        raise InputError(f"{name}.decode returned None; it must return the impact")
    if (wrong := objective.wrong_impact(belief, [back])) is not None:
        raise InputError(f"{name}.decode of an encoded impact: {wrong[1]}")


def checked_reach(
    objective: Objective[BeliefT, ImpactT], tree: Tree, scheme: str, reach: Sequence[Reach]
) -> list[Reach]:
    """Return everybody's boxes as plain numbers; ``InputError`` if messages cannot be clipped to them."""
    if scheme == "jacobi":
        raise InputError("reach goes with token, fork and async; got scheme 'jacobi'; leave reach out")
    if not isinstance(objective, Clippable):
        raise InputError(f"reach needs {type(objective).__name__}.clip(belief, impact, reach); leave it out")
    check_list(reach, "reach", "a list of boxes for each platform")
    if len(reach) != tree.n:
        raise InputError(f"reach has {len(reach)} for {many(tree.n, 'platform')}; give one each")
    for i, boxes in enumerate(reach):
        check_list(boxes, f"reach[{i}]", "a list of boxes")
    return [tuple(_box(i, box) for box in boxes) for i, boxes in enumerate(reach)]


def _box(i: int, box: Box) -> Box:
    """Return a box as plain numbers, which may be infinite."""
    listed = isinstance(box, tuple | list) or (isinstance(box, np.ndarray) and box.ndim == 1)
    ends = list(box) if listed else []
    if len(ends) == 4 and all(is_number(end) or (isinstance(end, float) and math.isinf(end)) for end in ends):
        x0, y0, x1, y1 = map(float, ends)
        if x0 <= x1 and y0 <= y1:
            return x0, y0, x1, y1
    raise InputError(f"reach[{i}] has {brief(box)}; a box is lowest x, lowest y, highest x, highest y")
