"""Which neighbours rounds get anywhere with, by what this robot has seen of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from vedette.agent.events import TreeChanged

MISSES = 2  # rounds in a row that a child may be cut from before the next ones go on without it
PAUSE, MOST_PAUSE = 10.0, 160.0  # for which they do, doubling each time [s]
UNLIKE = 4  # rounds in a row may be planned on another belief than the root's, for each link to it
BRIEF, THRICE = 0.2, 3.0  # of the patience, or of what it took last: for a child that has missed a round
FARTHEST = 8  # a robot farther from the root, in links, counts as no farther


@dataclass
class Attendance:
    """A child that keeps being cut from rounds is left out of them for a while, then asked again.

    It stays on the tree: evidence goes both ways, and nobody else waits for it any more. Whoever takes part
    in no round plans alone meanwhile (``vedette.agent.rounds``). Until it is there again to a round's end,
    its first word in a round, which takes no thought, is waited for but briefly.
    """

    _missed: Counter[int] = field(default_factory=Counter)  # rounds in a row, by child
    _pauses: dict[int, float] = field(default_factory=dict)  # the latest of each [s]
    _until: dict[int, float] = field(default_factory=dict)  # left out until [s]
    _took: dict[int, float] = field(default_factory=dict)  # until its first word in a round, lately [s]

    def keep(self, neighbours: Iterable[int]) -> None:
        """Ask all but these again when they come again; who was left out before has one round to be there."""
        for robot in (self._missed.keys() | self._until.keys()) - set(neighbours):
            self._missed.pop(robot, None)
            self._until.pop(robot, None)

    def missed(self, child: int, now: float, tempo: float) -> None:
        """Note that a child was cut from a round; ``tempo``: seconds of ``now``'s clock in a real one."""
        self._missed[child] += 1
        if self._missed[child] >= MISSES or child in self._pauses:
            self._pauses[child] = min(2.0 * self._pauses.get(child, PAUSE / 2.0), MOST_PAUSE)
            self._until[child] = now + self._pauses[child] * tempo

    def flushed(self, child: int, took: float) -> None:
        """Note how long a child's first word in a round took [s]."""
        self._took[child] = took

    def bears(self, child: int, patience: float) -> float:
        """Return how long to wait for a child's first word in a round, at most so long [s]."""
        if child not in self._missed and child not in self._pauses:
            return patience
        return min(patience, max(BRIEF * patience, THRICE * self._took.get(child, 0.0)))

    def attended(self, children: Iterable[int]) -> None:
        """Note that children were there to a round's end."""
        for child in children:
            self._missed.pop(child, None)
            self._pauses.pop(child, None)

    def absent(self, now: float) -> frozenset[int]:
        """Return the children that rounds go on without."""
        return frozenset(child for child, until in self._until.items() if now < until)


@dataclass
class Upwards:
    """How rounds fare that come by the parent; the farther the root, the longer a robot bears with it.

    So whose neighbour is at fault acts before those behind it. A tree on which no round has ended yet gets
    one round less.
    """

    _failed: int = 0  # rounds in a row that came to nothing
    _worked: bool = False  # a round has ended on this tree
    _unlike: int = 0  # rounds in a row in which the belief was not the root's

    def fails(self, tree: TreeChanged) -> bool:
        """Note a round that came to nothing; tell whether to do without the parent."""
        self._failed += 1
        return self._is_enough(tree, self._failed + (not self._worked) > _far(tree))

    def ends(self, tree: TreeChanged, approximate: bool) -> bool:
        """Note a round that has ended, on the root's belief or another; tell likewise.

        A belief that is never the root's tells of evidence that is changed on its way.
        """
        self._failed, self._worked = 0, True
        self._unlike = self._unlike + 1 if approximate else 0
        return self._is_enough(tree, self._unlike >= UNLIKE * _far(tree))

    def _is_enough(self, tree: TreeChanged, is_much: bool) -> bool:
        if tree.parent is None or not is_much:
            return False
        self._failed = self._unlike = 0
        return True


def _far(tree: TreeChanged) -> int:
    return min(max(tree.distance, 1), tree.size, FARTHEST)
