"""Your own model: two robots listen for a leak that is in one of six rooms, or nowhere, and may have spread.

What a joint action is expected to tell is summed exactly, and the best found by a centre that knows both
robots' sensors. Then they agree by messages, on a partially separable objective in its place.
"""

import numpy as np

from vedette import Coverage, FiniteModel, Tree, negotiate

ROOMS = 6  # in a row; state 6: there is no leak
prior = np.array([0.1, 0.1, 0.2, 0.2, 0.15, 0.05, 0.2])
spread = np.eye(ROOMS + 1)  # P(x_k | x_{k-1}), a column for each x_{k-1}
for room in range(ROOMS - 1):
    spread[room, room], spread[room + 1, room] = 0.9, 0.1


def ear(place: int) -> np.ndarray:
    """P(heard or not | where the leak is): nine of ten in the same room, half of that next door."""
    heard = 0.02 + 0.88 * 0.5 ** np.abs(np.arange(ROOMS + 1.0) - place)
    heard[ROOMS] = 0.02  # a false alarm
    return np.vstack([heard, 1.0 - heard])


places = [[0, 1, 2, 3], [2, 3, 4, 5]]  # where each robot can go
model = FiniteModel(prior, [[ear(place) for place in own] for own in places], spread)


def places_of(choice: tuple[int, ...]) -> list[int]:
    return [own[k] for own, k in zip(places, choice, strict=True)]


best = model.optimum()
print(f"best places {places_of(best.choice)} worth {best.value:.3f} nat")
guess = model.sampled_value(best.choice, np.random.default_rng(1), samples=20_000)
print(f"by samples  {guess.estimate:.3f}, between {guess.low:.3f} and {guess.high:.3f}")
misses = [[1.0 - ear(place)[0, :ROOMS] for place in own] for own in places]
agreed = negotiate(Coverage(), model.predicted[:ROOMS], misses, Tree.chain(2))
print(f"agreed on   {places_of(agreed.choice)} worth {model.value(agreed.choice):.3f}")
