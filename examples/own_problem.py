"""Your own problem: six guards each pick a post, to see the most of a museum.

An impact is the set of tiles a guard sees, `*` is union (which has no inverse), the value is what the tiles
seen are worth. Every guard knows only its own posts and talks only to its neighbours on a tree.
"""

import numpy as np

from vedette import Objective, Tree, exhaustive, negotiate

Tiles = frozenset[tuple[int, int]]


class Watch(Objective[np.ndarray, Tiles]):  # the belief: worth[row, col] of every tile
    monotone = submodular = True

    def nothing(self, belief: np.ndarray) -> Tiles:
        return frozenset()

    def combine(self, a: Tiles, b: Tiles) -> Tiles:
        return a | b

    def value(self, belief: np.ndarray, impact: Tiles) -> float:
        return sum(float(belief[tile]) for tile in impact)


def seen_from(row: int, col: int) -> Tiles:
    return frozenset((r, c) for r in range(12) for c in range(16) if abs(r - row) + abs(c - col) <= 3)


rng = np.random.default_rng(7)
worth = rng.exponential(size=(12, 16))
posts = [rng.integers((12, 16), size=(4, 2)).tolist() for guard in range(6)]
candidates = [[seen_from(row, col) for row, col in own] for own in posts]

agreed = negotiate(Watch(), worth, candidates, Tree.random(6, seed=7))
best = exhaustive(Watch(), worth, candidates)
print("posts  ", [own[k] for own, k in zip(posts, agreed.choice, strict=True)])
print(f"value   {agreed.value:.2f} after {agreed.sweeps} sweeps and {agreed.messages} messages")
print(f"optimum {best.value:.2f}, known to be at most {agreed.bound:.2f} without trying everything")
