"""One searching vehicle: the flights it can make, what they would detect, and its best reply to the team."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.bounds import sweep_width
from vedette.domains.search.detectors import DefiniteRange, Detector
from vedette.domains.search.flights import (
    Flight,
    branches,
    held_sequences,
    look_poses,
    steer,
    time_to,
)
from vedette.domains.search.goals import NO_GOALS, Goals, find_goals, promise, share_left
from vedette.domains.search.gusts import expected_footprints
from vedette.domains.search.impact import Impact
from vedette.domains.search.options import FlightOptions, boxes_of, quantised_looks, with_promises
from vedette.domains.search.paths import impact_of
from vedette.errors import InputError
from vedette.forbidden import NOWHERE, Forbidden, Turning
from vedette.kernels import search
from vedette.problem import Reach
from vedette.vehicle import CALM, Gust, check_gusts, drive

MOST_CANDIDATES = 300
HYSTERESIS = 0.01  # a new flight must gain this share more than the present one


@dataclass(eq=False)
class SearchPlatform:
    """A vehicle at constant speed with a bounded turn rate; strategies are flights over the horizon.

    Candidates: all sequences of ``controls`` turn rates; a turn towards each of a few blocks of probability
    and straight on; and the present flight, shifted by the steps that have passed. Each also promises to
    search the block that suits it best after the horizon, thinned by how late it would come: without that,
    a vehicle among leftovers would never leave for a far place that holds more. Promises are in layers of the
    impact like any other, so that the team divides far places too, and the laws hold. Where ``worth`` has no
    promises, a vehicle with nothing to detect within the horizon flies to the best block, unseen by others.

    ``place`` says where it is before ``prepare``; a round then works on what ``prepare`` found. In the steps
    that the belief calls committed all candidates hold the present flight's turn rates.

    Raises:
        InputError: a number out of its range, or more than 300 candidates.
    """

    speed: float = 50.0  # [m/s]
    turn_rate: float = 0.5  # most [rad/s]
    detector: Detector = field(default_factory=DefiniteRange)
    controls: int = 5
    choices: int = 3  # turn rates, odd
    looks: int | None = None  # a step; None: enough to move by half the range between two
    gusts: tuple[Gust, ...] = CALM  # winds that may carry it off its way
    pose: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))  # [m, m, rad], team frame
    present: Flight | None = None
    forbidden: Forbidden = NOWHERE  # ground that it must not be over
    options: FlightOptions | None = None
    _known: dict[Impact, NDArray[np.float64]] = field(default_factory=dict)  # gains by the rest of the team

    def __post_init__(self) -> None:
        for name in ("speed", "turn_rate"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(f"{name} must be a number >= 0; got {value}")
        if self.choices < 1 or self.choices % 2 == 0 or self.controls < 1:
            raise InputError(f"need choices odd and controls >= 1; got {self.choices} and {self.controls}")
        if self.choices**self.controls > MOST_CANDIDATES:
            raise InputError(
                f"{self.choices} choices in each of {self.controls} controls are more than {MOST_CANDIDATES} "
                "candidates; take fewer controls: each is then held for longer"
            )
        check_gusts(self.gusts)
        if self.looks is not None and self.looks < 1:
            raise InputError(f"looks must be at least 1 a step; got {self.looks}")

    def place(self, pose: ArrayLike, present: Flight | None) -> None:
        """Say where the vehicle is at the belief's step, (3,) [m, m, rad], and what it is doing."""
        self.pose = np.asarray(pose, np.float64)
        self.present = present

    def looks_a_step(self, dt: float) -> int:
        """How often the sensor looks in a step of ``dt`` [s]."""
        return self.looks or max(1, math.ceil(self.speed * dt / (self.detector.range / 2.0)))

    def look_poses(self, pose: ArrayLike, turn_rate: float, dt: float) -> NDArray[np.float64]:
        """Where the sensor looks from in a step that begins at ``pose``, ``(looks, 3)`` [m, m, rad]."""
        looks = self.looks_a_step(dt)
        return drive(pose, np.full(looks, turn_rate), self.speed, dt / looks)

    def prepare(self, belief: SearchBelief) -> None:
        """List the flights and what each would detect; the slow part, before the round."""
        present = self._restated(belief)
        kept, free = present[: belief.committed], belief.horizon - belief.committed
        begin = drive(self.pose, kept, self.speed, belief.dt)[-1] if len(kept) else self.pose
        goals = self._goals(belief)
        towards = self._steer(belief, begin, goals.places, free)
        chosen = np.concatenate((held_sequences(self.turn_rate, free, self.controls, self.choices), towards))
        turn_rates = np.vstack((present, np.hstack((np.tile(kept, (len(chosen), 1)), chosen))))
        turn_rates = self._kept_out(belief, turn_rates)
        tree = branches(turn_rates)
        poses = look_poses(tree, self.pose, self.speed, belief.dt, self.looks_a_step(belief.dt))
        starts, cells, probability = expected_footprints(
            self.detector, belief.frame, tree, poses, belief.dt, self.gusts
        )
        paths = quantised_looks(tree, starts, cells, probability)
        after, delays = self._afterwards(belief, goals, poses[tree.ends, -1], len(towards))
        places = [tuple(place) for place in goals.places.tolist()]
        flights = [
            Flight(belief.step, rates, places[goal] if goal >= 0 else None)
            for rates, goal in zip(turn_rates, after, strict=True)
        ]
        index: dict[Flight, int] = {}
        for k, flight in enumerate(flights):
            index.setdefault(flight, k)
        to_best = len(flights) - len(goals) if len(goals) else 0
        promised = goals if belief.worth.promises else NO_GOALS
        boxes = boxes_of(belief, paths, promised)
        paths, ends = with_promises(paths, tree.ends, promised, after, *promise(delays, belief.duration))
        self.options = FlightOptions(flights, index, to_best, paths, ends, boxes)
        self._known.clear()

    @property
    def start(self) -> Flight:
        """The present flight restated for the round, straight ahead if there was none."""
        assert self.options is not None
        return self.options.flights[0]

    def impact(self, belief: SearchBelief, strategy: Flight) -> Impact:
        """What the flight would detect, each step's looks in a layer, and its promise; paper, eq. (39)."""
        options = self.options
        assert options is not None
        return impact_of(options.paths, int(options.ends[options.index[strategy]]), belief.layers)

    def gains(self, belief: SearchBelief, others: Impact) -> NDArray[np.float64]:
        """``psi(others * own_k) - psi(others)`` of each of the round's flights, ``(C,)``.

        Each flight depletes what it finds later itself; docs/search.md (V47).
        """
        options = self.options
        assert options is not None
        if others not in self._known:
            self._known[others] = search.path_gains(
                belief.mass,
                belief.stencil,
                belief.horizon,
                belief.worth.weights,
                others.sparse,
                options.paths,
            )[options.ends]
        return self._known[others]

    def reply(self, belief: SearchBelief, others: Impact, current: Flight) -> Flight:
        """Best flight against the rest of the team, if clearly better than the present one.

        Source: paper, eq. (30).
        """
        options = self.options
        assert options is not None
        gains = self.gains(belief, others)
        best = int(np.argmax(gains)) if gains.max() > 0.0 else options.to_best
        if gains[best] <= 0.0:
            return options.flights[best]
        present = gains[options.index[current]]
        return options.flights[best] if gains[best] > present * (1.0 + HYSTERESIS) else current

    def slack(self, belief: SearchBelief, team: Impact) -> float:
        """No flight of this round adds more than this to the team's impact."""
        return max(0.0, float(self.gains(belief, team).max()))

    def reach(self) -> Reach:
        """Return boxes [m], team frame, outside which no team-mate's impact touches this vehicle's gains."""
        assert self.options is not None
        return tuple((x0, y0, x1, y1) for x0, x1, y0, y1 in self.options.boxes.tolist())

    def _goals(self, belief: SearchBelief) -> Goals:
        if self.speed == 0.0 or self.turn_rate == 0.0:
            return NO_GOALS
        width = sweep_width(self.detector, self.speed, belief.dt / self.looks_a_step(belief.dt))
        area = width * self.speed * belief.duration
        return find_goals(belief, self.pose, area, self.speed, self.turn_rate)

    def _restated(self, belief: SearchBelief) -> NDArray[np.float64]:
        """What is left of the present flight, then towards its goal, or straight ahead."""
        if self.present is None:
            return np.zeros(belief.horizon)
        left = self.present.turn_rates[max(0, belief.step - self.present.step) :][: belief.horizon]
        missing = belief.horizon - len(left)
        if self.present.goal is None or missing == 0:
            return np.concatenate((left, np.zeros(missing)))
        end = drive(self.pose, left, self.speed, belief.dt)[-1] if len(left) else self.pose
        return np.concatenate((left, self._steer(belief, end, np.array([self.present.goal]), missing)[0]))

    def _kept_out(self, belief: SearchBelief, turn_rates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return flights with those that lead over forbidden ground replaced."""
        if self.speed == 0.0 or self.turn_rate == 0.0:
            return turn_rates
        turning = Turning(self.speed, self.turn_rate)
        return self.forbidden.kept_out(self.pose, turn_rates, turning, belief.dt, belief.committed)

    def _steer(
        self, belief: SearchBelief, pose: NDArray[np.float64], goals: NDArray[np.float64], steps: int
    ) -> NDArray[np.float64]:
        poses = np.broadcast_to(pose, (len(goals), 3))
        return steer(poses, goals, speed=self.speed, turn_rate=self.turn_rate, dt=belief.dt, steps=steps)

    def _afterwards(
        self, belief: SearchBelief, goals: Goals, ends: NDArray[np.float64], transits: int
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The goal of each flight, -1 for none, and how long after the horizon it is reached [s]."""
        count = len(ends)
        if not len(goals):
            return np.full(count, -1), np.zeros(count)
        delays = time_to(ends, goals.places, goals.side / 2.0, self.speed, self.turn_rate)
        chosen = np.argmax(goals.mass * share_left(delays, belief.duration), axis=1)
        chosen[count - transits :] = np.arange(transits)
        return chosen, delays[np.arange(count), chosen]
