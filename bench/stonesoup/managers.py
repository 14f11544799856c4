"""The managers side by side: how each is made, how far it gets, and one decision of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from stonesoup.sensormanager import BruteForceSensorManager, GreedySensorManager
from stonesoup.sensormanager.optimise import OptimizeBasinHoppingSensorManager
from stonesoup.sensormanager.tree_search import MonteCarloTreeSearchSensorManager

from bench.stonesoup.scenario import THEN, Scene
from vedette.stonesoup import VedetteSensorManager

OURS, LOG_DET, GREEDY, BRUTE = "vedette", "vedette, log-det", "greedy", "brute force"
ANY = 1 << 30


@dataclass(frozen=True)
class Manager:
    """A manager under test."""

    make: Callable[[Scene], Any]
    most: int  # radars x targets up to which one decision takes a bearable time
    repeats: int = 1
    all_scenes: bool = False  # the slow ones decide only the first of each size


@dataclass(frozen=True)
class Decision:
    """One manager's decision on one scene."""

    cpu_s: float  # median of the repeats
    share: float  # of the best known reward


def with_reward(kind: Callable[..., Any], **arguments: Any) -> Callable[[Scene], Any]:
    """Return how to make one of Stone Soup's managers for a scene."""
    return lambda scene: kind(set(scene.sensors), reward_function=scene.reward(**arguments))


def log_det(scene: Scene) -> VedetteSensorManager:
    """Return our manager with its own reward."""
    return VedetteSensorManager(set(scene.sensors), predictor=scene.predictor)


MANAGERS = {
    OURS: Manager(with_reward(VedetteSensorManager), ANY, 5, True),
    LOG_DET: Manager(log_det, ANY, 5, True),
    GREEDY: Manager(with_reward(GreedySensorManager), ANY, 3, True),
    BRUTE: Manager(with_reward(BruteForceSensorManager), 24, 1, True),
    "basin hopping": Manager(with_reward(OptimizeBasinHoppingSensorManager), 64),
    # lists all configurations: 12^8 do not fit into memory
    "tree search": Manager(with_reward(MonteCarloTreeSearchSensorManager, return_tracks=True), 32),
}


def decide(name: str, scene: Scene, repeats: int) -> tuple[float, float]:
    """Return the CPU time of a decision [s] and its worth, by Stone Soup's own reward but for log-det."""
    times = []
    for _ in range(repeats):
        manager = MANAGERS[name].make(scene)
        np.random.seed(0)  # noqa: NPY002  # what Stone Soup's searches draw from
        began = time.process_time()
        config = manager.choose_actions(set(scene.tracks), THEN)[0]
        times.append(time.process_time() - began)
    return median(times), manager.last.reward if name == LOG_DET else scene.worth(config)


def best_known(scene: Scene, reward: str, searches: int) -> float:
    """Return the best reward of many searches, in its own unit."""
    manager = VedetteSensorManager(
        set(scene.sensors), reward_function=reward, predictor=scene.predictor, starts=searches, seed=1
    )
    manager.choose_actions(set(scene.tracks), THEN)
    assert manager.last is not None
    return manager.last.reward


def compare(scene: Scene, names: list[str], searches: int, repeats: int | None) -> dict[str, Decision]:
    """Let managers decide a scene; all shares are of the best that anybody found."""
    found = {name: decide(name, scene, repeats or MANAGERS[name].repeats) for name in names}
    own = max(best_known(scene, "logdet", searches), found[LOG_DET][1])
    best = max(
        [
            best_known(scene, "uncertainty", searches),
            *(w for name, (_, w) in found.items() if name != LOG_DET),
        ]
    )
    return {
        name: Decision(cpu_s, worth / (own if name == LOG_DET else best))
        for name, (cpu_s, worth) in found.items()
    }
