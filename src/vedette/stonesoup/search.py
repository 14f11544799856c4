"""Where a negotiation starts: the best of many best-response searches, run side by side.

A team's equilibria differ by some per cent, most of all in small teams and where the reward is not
submodular. All searches take their turns together, so that a turn is one stacked factorisation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.stonesoup.objectives import StoneSoupTracks, TrackReward

MOST_STARTS = 128
EFFORT = 384  # starts are EFFORT m / n^2: small teams and many tracks have the worse equilibria
MOST_SWEEPS = 20
EPSILON = 1e-9  # least gain for which somebody changes, relative where the value exceeds 1, as in negotiate


def good_start(
    objective: TrackReward,
    belief: StoneSoupTracks,
    menus: Sequence[NDArray[np.float64]],
    starts: int,
    seed: int,
) -> tuple[int, ...]:
    """Return a choice, one index a menu, from which nobody gains by changing alone.

    Args:
        objective: the reward.
        belief: the tracks.
        menus: ``menus[i]`` is what each of chooser i's candidates tells, (K_i, m, d, d).
        starts: least number of random starts; small teams, and those with many tracks, have more.
        seed: of the starts.
    """
    sizes = [len(menu) for menu in menus]
    count = max(starts, min(MOST_STARTS, EFFORT * len(belief.norms) // len(sizes) ** 2))
    choices = np.random.default_rng(seed).integers(sizes, size=(count, len(sizes)))
    search = _Search(objective, belief, [_Menu.of(menu) for menu in menus], choices)
    best = int(np.argmax(search.run()))
    return tuple(int(k) for k in search.choices[best])


@dataclass(frozen=True, eq=False)
class _Menu:
    """What one chooser's candidates tell, and the pairs of candidate and track where that is something."""

    told: NDArray[np.float64]  # (K, m, d, d)
    seen: NDArray[np.bool_]  # (K, m)
    tracks: NDArray[np.int64]  # (pairs,)
    pairs: NDArray[np.float64]  # (pairs, d, d)
    member: NDArray[np.float64]  # (pairs, K), 1 where the pair is of the candidate

    @classmethod
    def of(cls, told: NDArray[np.float64]) -> _Menu:
        seen = np.asarray(told.any(axis=(2, 3)))
        k, t = np.nonzero(seen)
        return cls(told, seen, t, told[k, t], np.eye(len(told))[k])


class _Search:
    """R searches at once: in each, every chooser in turn replies to all others."""

    def __init__(
        self,
        objective: TrackReward,
        belief: StoneSoupTracks,
        menus: Sequence[_Menu],
        choices: NDArray[np.int64],
    ) -> None:
        self.choices = choices  # (R, n), changed as the searches go on
        self._objective = objective
        self._belief = belief
        self._menus = menus
        self._total = np.sum(
            [menu.told[choices[:, i]] for i, menu in enumerate(menus)], axis=0
        )  # (R, m, d, d)
        count, m, d, _ = self._total.shape
        tracks = np.tile(np.arange(m), count)
        self._gains = objective.gains(belief, tracks, self._total.reshape(-1, d, d)).reshape(count, m)
        self._quiet = np.zeros(count, dtype=np.int64)  # turns in a row without a change

    def run(self) -> NDArray[np.float64]:
        """Go on until nobody changes, or for ``MOST_SWEEPS``; return the values, (R,)."""
        n = len(self._menus)
        for turn in range(MOST_SWEEPS * n):
            active = np.flatnonzero(self._quiet < n)
            if len(active) == 0:
                break
            self._turn(turn % n, active)
            if turn % n == n - 1:
                self._retire(active)
        return np.asarray(self._gains.sum(axis=1), dtype=np.float64)

    def _retire(self, active: NDArray[np.int64]) -> None:
        """Leave off the worse half of the active searches: what one is worth shows early."""
        ranked = active[np.argsort(-self._gains[active].sum(axis=1), kind="stable")]
        self._quiet[ranked[(len(ranked) + 1) // 2 :]] = len(self._menus)

    def _turn(self, i: int, active: NDArray[np.int64]) -> None:
        """Let chooser i reply in the active searches; only tracks that it can see are computed anew."""
        menu, present = self._menus[i], self.choices[active, i]
        rows = np.arange(len(active))
        others = self._total[active] - menu.told[present]
        saw, lost = np.nonzero(menu.seen[present])
        joined = (others[:, menu.tracks] + menu.pairs).reshape(-1, *menu.pairs.shape[1:])
        gains = self._objective.gains(
            self._belief,
            np.concatenate([lost, np.tile(menu.tracks, len(active))]),
            np.concatenate([others[saw, lost], joined]),
        )
        base = self._gains[active]  # without chooser i
        base[saw, lost] = gains[: len(lost)]
        after = gains[len(lost) :].reshape(len(active), -1)
        values = (after - base[:, menu.tracks]) @ menu.member  # (active, K), over base
        best = values.argmax(axis=1)
        least = EPSILON * np.maximum(1.0, base.sum(axis=1) + values[rows, present])
        changed = values[rows, best] - values[rows, present] > least
        best = np.where(changed, best, present)
        row, pair = np.nonzero(menu.member.T[best])
        base[row, menu.tracks[pair]] = after[row, pair]
        self._gains[active] = base
        self._total[active] = others + menu.told[best]
        self.choices[active, i] = best
        self._quiet[active] = np.where(changed, 0, self._quiet[active] + 1)
