"""Who chooses, and what each choice would tell: every distinct action asked of its sensor once."""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.stonesoup.forecast import Forecast
from vedette.stonesoup.information import measured
from vedette.stonesoup.rotating import RotatingView, is_clear, is_plain_rotating_radar

Actions = dict[Any, tuple[Any, ...]]  # by actionable, as Stone Soup's managers return them


@dataclass(frozen=True, eq=False)
class Candidate:
    """Actions of one chooser and what its sensors would then tell."""

    actions: Actions
    information: NDArray[np.float64]  # (m, d, d)


@dataclass(frozen=True, eq=False)
class Menu:
    """What one chooser can do: no two candidates tell the same."""

    candidates: tuple[Candidate, ...]
    asked: int  # sensor states for which a sensor was asked


def menus(
    sensors: Collection[Any], platforms: Collection[Any], forecast: Forecast, most: int
) -> tuple[list[Menu], Actions]:
    """Return every chooser's menu, and the empty actions of those that have no choice to make.

    A sensor chooses for itself; a platform that can move chooses together with its sensors. The order
    depends on kinds and places, not on a set's.

    Raises:
        InputError: somebody has more than ``most`` joint actions.
    """
    still: Actions = {}
    found: list[Menu] = []
    left = sorted(sensors, key=_place)
    for platform in sorted(platforms, key=_place):
        moves = joint_actions(platform, forecast, most)
        if moves == [()]:
            still[platform] = ()
            continue
        carried = [s for s in left if s.movement_controller is platform.movement_controller]
        left = [s for s in left if s not in carried]
        found.append(_platform_menu(platform, moves, carried, forecast, most))
    return found + [_sensor_menu(sensor, sensor, forecast, most) for sensor in left], still


def joint_actions(actionable: Any, forecast: Forecast, most: int) -> list[tuple[Any, ...]]:
    """Return the product of the actions that each actionable property allows."""
    generators = sorted(
        actionable.actions(forecast.timestamp), key=lambda generator: str(generator.attribute)
    )
    choices = [list(generator) for generator in generators]
    _check_count(actionable, math.prod(map(len, choices)), most)
    return list(itertools.product(*choices))


def _sensor_menu(sensor: Any, standing: Any, forecast: Forecast, most: int) -> Menu:
    """Return the menu of a sensor; ``standing`` is the sensor as its platform will have carried it."""
    asked: set[bytes] = set()
    told: dict[bytes, Candidate] = {}
    ask: Callable[[Any], NDArray[np.float64]] | None = None
    for actions in joint_actions(sensor, forecast, most):
        acting = _after(standing, actions, forecast)
        state = _fingerprint(acting, actions)
        if state in asked:
            continue
        asked.add(state)
        ask = ask or _question(acting, actions, forecast)
        tells = ask(acting)
        told.setdefault(tells.tobytes(), Candidate({sensor: actions}, tells))
    return Menu(tuple(told.values()), len(asked))


def _platform_menu(
    platform: Any, moves: Sequence[tuple[Any, ...]], carried: Sequence[Any], forecast: Forecast, most: int
) -> Menu:
    """Return the menu of a platform that can move: each move with all that its sensors can do there."""
    told: dict[bytes, Candidate] = {}
    asked = 0
    for move in moves:
        there = copy.copy(platform.movement_controller)
        there.add_actions(move)
        there.act(forecast.timestamp, noise=False)
        own = [_sensor_menu(sensor, _mounted(sensor, there), forecast, most) for sensor in carried]
        asked += sum(menu.asked for menu in own)
        _check_count(platform, len(moves) * math.prod(len(menu.candidates) for menu in own), most)
        for candidate in _together({platform: move}, own, forecast):
            told.setdefault(candidate.information.tobytes(), candidate)
    return Menu(tuple(told.values()), asked)


def _together(move: Actions, menus: Sequence[Menu], forecast: Forecast) -> Iterator[Candidate]:
    """Yield a move with every combination of what the sensors on board can do."""
    for chosen in itertools.product(*(menu.candidates for menu in menus)):
        total = np.zeros_like(forecast.covariances)
        actions = dict(move)
        for candidate in chosen:
            total = total + candidate.information
            actions |= candidate.actions
        yield Candidate(actions, total)


def _after(sensor: Any, actions: Sequence[Any], forecast: Forecast) -> Any:
    """Return a light copy of the sensor that has acted; what does not change it shares with the sensor."""
    acting = copy.copy(sensor)
    acting.scheduled_actions = dict(sensor.scheduled_actions)
    for name in _changed(actions):  # some of Stone Soup's actions write into the value
        setattr(acting, name, copy.copy(getattr(sensor, name)))
    acting.add_actions(actions)
    acting.act(forecast.timestamp)
    return acting


def _mounted(sensor: Any, controller: Any) -> Any:
    """Return a light copy of the sensor on another movement controller."""
    standing = copy.copy(sensor)
    standing.movement_controller = controller
    return standing


def _question(
    acting: Any, actions: Sequence[Any], forecast: Forecast
) -> Callable[[Any], NDArray[np.float64]]:
    """Return how to ask this sensor after any of its actions."""
    if not forecast.truths:
        return lambda sensor: forecast.covariances
    plain = _changed(actions) <= {"dwell_centre"} and is_plain_rotating_radar(acting)
    if plain and is_clear(acting, forecast):
        return RotatingView(acting, forecast)
    return lambda sensor: measured(sensor, forecast)


def _changed(actions: Sequence[Any]) -> set[str]:
    return {action.generator.attribute for action in actions}


def _fingerprint(acting: Any, actions: Sequence[Any]) -> bytes:
    """Return bytes that are equal for actions that leave the sensor in the same state."""
    values = [np.asarray(getattr(acting, name), dtype=np.float64) for name in sorted(_changed(actions))]
    return b"".join(np.round(value, 9).tobytes() for value in values)


def _check_count(actionable: Any, count: int, most: int) -> None:
    name = type(actionable).__name__
    if count == 0:
        raise InputError(f"{name} offers no value for one of its actions; widen its limits")
    if count > most:
        raise InputError(
            f"{name} has {count} joint actions, at most {most}; coarsen its resolution or raise max_actions"
        )


def _place(actionable: Any) -> tuple[str, tuple[float, ...]]:
    """Return a key by kind, place and direction, so that the order of a set does not matter."""
    parts = [getattr(actionable, name, None) for name in ("position", "orientation", "dwell_centre")]
    numbers = (np.asarray(part, dtype=np.float64).ravel().tolist() for part in parts if part is not None)
    return type(actionable).__name__, tuple(itertools.chain.from_iterable(numbers))
