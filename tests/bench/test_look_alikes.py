"""Real places that were once joined wrongly: floors of one architect, and halls of one form."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from bench.frames.robots import REACH, anywhere, looked, mapped
from vedette.align import Charted, charted, judged
from vedette.maps.world import World

MAPS = Path(os.environ.get("MAPS", Path(__file__).parents[3] / "shared" / "maps"))
pytestmark = pytest.mark.skipif(not MAPS.is_dir(), reason="there are no maps of real places")

Start = tuple[str, float, float, float]  # map; x, y of the start; how far it has explored about it [m]
OF_LIKE_ROOMS: Start = ("kth-50052753", 50.25, 9.15, 15.1)
ABOVE_IT: Start = ("kth-50052751", 30.85, 4.55, 21.1)
HALL: Start = ("dungeon-40", 102.6, 20.2, 15.7)
HALL_OF_ITS_FORM: Start = ("dungeon-20", 75.0, 24.6, 21.7)


def seen(start: Start, seed: int) -> Charted:
    """What a robot would have mapped about a start, in a frame of its own."""
    name, x, y, way = start
    rng = np.random.default_rng(seed)
    world = World.from_map(MAPS / f"{name}.yaml")
    own = mapped(looked(world, world.frame.flat(x, y), way, rng), REACH, anywhere(rng))
    made = charted(own.frame, own.classes)
    assert made is not None
    return made


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(
    ("first", "second", "common"),
    [(OF_LIKE_ROOMS, ABOVE_IT, 60.0), (HALL, HALL_OF_ITS_FORM, 80.0)],
)
def test_much_in_common_does_not_join_places_that_look_alike(
    first: Start, second: Start, common: float, seed: int
) -> None:
    """Logs of one place contradict each other as much, and some of these have as little of a rival."""
    verdict = judged(seen(first, seed), seen(second, seed + 10), seed)
    best = verdict.alignment.candidates[0]
    assert best.same > common
    assert best.contradicted < 0.1
    assert verdict.joined is None


@pytest.mark.parametrize("start", [OF_LIKE_ROOMS, ABOVE_IT])
def test_one_of_them_explored_twice_is_joined(start: Start) -> None:
    assert judged(seen(start, 0), seen(start, 1), 0).joined is not None
