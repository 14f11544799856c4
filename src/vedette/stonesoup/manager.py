"""``VedetteSensorManager``: Stone Soup's sensors negotiate who looks where."""

from __future__ import annotations

import datetime
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from stonesoup.base import Property
from stonesoup.predictor import Predictor
from stonesoup.sensormanager import SensorManager
from stonesoup.sensormanager.reward import UncertaintyRewardFunction

from vedette.errors import InputError, nearest_name
from vedette.negotiation import Negotiation, Tree, negotiate
from vedette.stonesoup.candidates import Actions, Menu, menus
from vedette.stonesoup.forecast import forecast
from vedette.stonesoup.objectives import REWARDS, StoneSoupTracks, TrackReward
from vedette.stonesoup.search import good_start


@dataclass(frozen=True)
class ManagerDecision:
    """What the last call of ``choose_actions`` agreed on, and what that took."""

    reward: float  # of the configuration returned: nats with logdet, the covariances' units with uncertainty
    bound: float | None  # no configuration is worth more; None where the reward is not submodular
    converged: bool  # no chooser can gain by changing alone
    sweeps: int
    messages: int
    bytes: int
    asked: int  # sensor states for which a sensor was asked what it would see
    candidates: tuple[int, ...]  # different choices of each chooser


class VedetteSensorManager(SensorManager):  # type: ignore[misc]  # Stone Soup has no types
    """Every sensor chooses by messages on a tree, against the sum of what all others would learn.

    Takes the place of Stone Soup's own managers: same sensors, platforms, tracks and result. It asks each
    sensor once for each distinct action, by its own measurement model at the predicted tracks. A platform
    that can move chooses together with its sensors. ``last`` tells about the last decision.
    """

    reward_function: str | UncertaintyRewardFunction = Property(
        default="logdet",
        doc="``logdet``, the entropy taken off the tracks [nat], with a bound; ``uncertainty``, what Stone "
        "Soup's `UncertaintyRewardFunction` counts, without one; or such a function itself, whose predictor "
        "is used.",
    )
    predictor: Predictor = Property(
        default=None, doc="Predicts the tracks; not needed where `reward_function` brings one."
    )
    max_actions: int = Property(
        default=10_000, doc="Most joint actions of a sensor, or of a platform that moves with its sensors."
    )
    starts: int = Property(
        default=8,
        doc="The sensors negotiate from the best of at least so many quick searches; 0: from nothing, by "
        "messages alone.",
    )
    seed: int = Property(default=0, doc="Of the searches; every call is the same for the same tracks.")

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.last: ManagerDecision | None = None

    def choose_actions(
        self,
        tracks: Collection[Any],
        timestamp: datetime.datetime,
        nchoose: int = 1,
        return_reward: bool = False,
        **kwargs: Any,
    ) -> Any:
        """Return ``[configuration]``: one tuple of actions for every sensor and platform.

        Args:
            tracks: of Gaussian states, all of one size.
            timestamp: when the actions end and the measurements are made.
            nchoose: 1; other than Stone Soup's managers, this one has no second best.
            return_reward: return ``([configuration], array([reward]))``, as its brute-force manager does.
            **kwargs: ignored, as Stone Soup's managers do.

        Raises:
            InputError: an unknown reward, no predictor, no sensors, tracks without covariances, or a sensor
                with more than ``max_actions`` joint actions.
        """
        if nchoose != 1:
            raise InputError(f"nchoose must be 1; got {nchoose}")
        objective, predictor = self._reward()
        if not self.sensors:
            raise InputError("the manager has no sensors; pass sensors={...}, or platforms that carry some")
        ahead = forecast(tracks, predictor, timestamp)
        found, config = menus(self.sensors, self.platforms, ahead, self.max_actions)
        agreed = self._negotiate(objective, StoneSoupTracks.of(ahead.covariances, ahead.names), found)
        for menu, k in zip(found, agreed.choice, strict=True):
            config |= menu.candidates[k].actions
        self.last = ManagerDecision(
            reward=agreed.value,
            bound=agreed.bound,
            converged=agreed.converged,
            sweeps=agreed.sweeps,
            messages=agreed.messages,
            bytes=agreed.bytes,
            asked=sum(menu.asked for menu in found),
            candidates=tuple(len(menu.candidates) for menu in found),
        )
        return _result(config, agreed.value, return_reward)

    def _negotiate(
        self, objective: TrackReward, belief: StoneSoupTracks, menus: Sequence[Menu]
    ) -> Negotiation:
        """Let the choosers agree, from a good start unless ``starts`` is 0."""
        own = [[candidate.information for candidate in menu.candidates] for menu in menus]
        start = None
        if self.starts > 0:
            start = good_start(objective, belief, [np.stack(each) for each in own], self.starts, self.seed)
        return negotiate(objective, belief, own, Tree.balanced(len(own)), start=start)

    def _reward(self) -> tuple[TrackReward, Any]:
        """Return the objective and the predictor that the properties name."""
        asked = self.reward_function
        if isinstance(asked, UncertaintyRewardFunction):
            if not asked.method_sum:
                raise InputError("reward_function: method_sum=False is no sum over the tracks; leave it out")
            objective, predictor = REWARDS["uncertainty"], self.predictor or asked.predictor
        elif isinstance(asked, str) and asked in REWARDS:
            objective, predictor = REWARDS[asked], self.predictor
        else:
            name = asked if isinstance(asked, str) else type(asked).__name__
            raise InputError(f"unknown reward_function {name!r}; {nearest_name(name, REWARDS)}")
        if predictor is None:
            raise InputError("predictor is missing; pass the one that predicts your tracks")
        return objective, predictor


def _result(config: Actions, reward: float, return_reward: bool) -> Any:
    return ([config], np.array([reward])) if return_reward else [config]
