"""A belief filtered over step evidence, and filtered again from where late evidence falls."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from vedette.fusion.steps import StepEvidence

B = TypeVar("B")
E = TypeVar("E")

DENSE = 8  # checkpoints in each doubling of age


class Refilter(Generic[B, E]):
    """``belief(k) = update(predict(belief(k - 1)), total(k))``: the central filter over what is known now.

    docs/theory.md (V29)

    Exact however late evidence comes, as long as its step is open. Checkpoints are dense for recent steps and
    thin out with age, some ``8 log2(steps / 8)`` in all; evidence that is *a* steps late costs at most
    ``1.125 a`` steps of filtering again.
    """

    def __init__(
        self,
        evidence: StepEvidence[E],
        prior: B,
        start: int,
        *,
        predict: Callable[[B, int], B],
        update: Callable[[B, int, E], B],
    ) -> None:
        """``prior`` is the belief at step ``start``, ahead of that step's evidence.

        ``predict(belief, k)`` takes a belief from step k to k + 1; ``update(belief, k, total)`` takes in
        the evidence of step k.
        """
        self._evidence = evidence
        self._prior, self._start = prior, start
        self._base = start - 1  # the step of the oldest belief that is kept; nothing before it can change
        self._predict, self._update = predict, update
        self._kept: dict[int, B] = {}  # step -> belief, its evidence included

    @property
    def first(self) -> int:
        """The first step that can be asked for: later than the start once steps are closed."""
        return max(self._start, self._base)

    def at(self, step: int) -> B:
        """Return the belief at a step, given all known evidence up to it.

        Raises ValueError for steps before the start, and for those that are closed and no longer kept.
        """
        if step < self.first:
            raise ValueError(f"step {step} lies before {self.first}, the first still kept")
        changed = self._evidence.take_changed()
        if changed is not None:
            self._kept = {k: belief for k, belief in self._kept.items() if k < changed}
        belief = self._filter(step)
        self._thin(step)
        return belief

    def _filter(self, step: int) -> B:
        done = max((k for k in self._kept if k <= step), default=self._base)
        belief = self._kept.get(done, self._prior)
        for k in range(done + 1, step + 1):
            if k > self._start:
                belief = self._predict(belief, k - 1)
            belief = self._update(belief, k, self._evidence.total(k))
            if self._is_kept(k, step):
                self._kept[k] = belief
        return belief

    def _is_kept(self, k: int, now: int) -> bool:
        spacing = 1
        while 2 * spacing * DENSE <= now - k:
            spacing *= 2
        return (k - self._start) % spacing == 0

    def _thin(self, now: int) -> None:
        """Keep what the spacing says, and of the closed steps the last one alone."""
        closed = [k for k in self._kept if k < self._evidence.open_from]
        self._base = base = max(closed, default=self._base)
        self._kept = {
            k: belief
            for k, belief in self._kept.items()
            if k == base or (k > base and (k > now or self._is_kept(k, now)))
        }
        self._evidence.forget(base + 1)
