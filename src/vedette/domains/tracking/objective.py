"""What a team of trackers gains: information about the targets' trajectories, or about where they end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.domains.tracking import impact as impacts
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.impact import Impact, Impacts
from vedette.kernels.tracking import Measure, chain_gradient, chain_values
from vedette.number import many
from vedette.parts import PartKind, number, numbers, telling, told
from vedette.problem import Objective, Reach


class TrackingObjective(Objective[Tracks, Impact]):
    """``psi(I) = sum_t sum_k 1/2 ln det(1 + P_{k|k-1} I_k)`` [nat], with ``*`` the sum of information.

    By the chain rule it is the entropy that the horizon's measurements take off the targets' whole
    trajectories, ``1/2 ln det(L + blkdiag(I_k)) - 1/2 ln det L`` with L the trajectories' prior information,
    but it takes a singular Q. As the mutual information of conditionally independent measurements it is
    monotone and submodular. With a horizon of one step it is the paper's eq. (28), as a logarithm.
    docs/tracking.md (V36)

    With layers after the horizon it adds what they are worth, monotone and submodular too. (V90)
    """

    monotone = True
    submodular = True
    measure: Measure = "trajectory"

    def nothing(self, belief: Tracks) -> Impact:
        """Return the impact of a team that observes nothing."""
        return impacts.nothing(belief.blocks)

    def combine(self, a: Impact, b: Impact) -> Impact:
        """``a * b``: sums of information; paper, eq. (27)."""
        return impacts.combine(a, b)

    def remove(self, total: Impact, own: Impact) -> Impact:
        """``total * own^-1``; paper, eq. (31)."""
        return impacts.remove(total, own)

    def clip(self, belief: Tracks, impact: Impact, reach: Reach) -> Impact:
        """Return what can matter to platforms that see within ``reach`` only; docs/theory.md (V14)."""
        places = np.concatenate([belief.predicted_means, belief.tail.means]) if belief.layers else None
        return impacts.clip(impact, belief.predicted_means if places is None else places, reach)

    def value(self, belief: Tracks, impact: Impact) -> float:
        """Return the gain over no measurements."""
        return float(self.values(belief, impact, [self.nothing(belief)])[0])

    def values(self, belief: Tracks, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        """``value(others * own_k)`` for every k, by one kernel call that redoes only what own_k sees.

        Where targets differ in weight, by one for all that share it: ``psi = sum_t w_t psi_t``. (V166)
        """
        if not belief.weights:
            return self._values(belief, others, own)
        weights = np.array(belief.weights)
        return np.asarray(
            sum(
                weight
                * self._values(
                    belief,
                    impacts.of_targets(others, weights == weight),
                    [impacts.of_targets(each, weights == weight) for each in own],
                )
                for weight in np.unique(weights).tolist()
            )
        )

    def _values(self, belief: Tracks, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        """The values of targets that all weigh the same."""
        rows = impacts.stack(own, belief.blocks)
        values = self._within(belief, others, rows)
        return values + self._after(belief, others, rows) if belief.layers else values

    def _within(self, belief: Tracks, others: Impact, rows: Impacts) -> NDArray[np.float64]:
        """The horizon's part of the values."""
        near = (rows.targets, _near(rows.blocks, belief))
        theirs = (others.targets, _near(others.blocks, belief))
        return chain_values(belief.motion, self.measure, theirs, rows.starts, near)

    def layer_weights(self, belief: Tracks) -> NDArray[np.float64]:
        """(B,) What a nat is worth in each layer after the horizon."""
        return belief.tail.weights

    def _after(self, belief: Tracks, others: Impact, rows: Impacts) -> NDArray[np.float64]:
        """The tail's part of the values."""
        tail, k = belief.tail, belief.horizon
        theirs = np.zeros((len(belief), len(belief.layers), 3))
        theirs[others.targets] = others.blocks[:, k:]
        weights = self.layer_weights(belief)
        before = tail.worth(np.arange(len(belief)), theirs, weights)
        then = tail.worth(rows.targets, theirs[rows.targets] + rows.blocks[:, k:], weights)
        more = then - before[rows.targets]
        whose = np.repeat(np.arange(len(rows)), np.diff(rows.starts))
        return np.asarray(before.sum() + np.bincount(whose, more, len(rows)))

    def gradient(self, belief: Tracks, team: Impact) -> NDArray[np.float64]:
        """Derivative of ``value`` by each number in the horizon's ``team.blocks``, (M, K, 3)."""
        slopes = self._gradient(belief, team)
        return slopes * np.array(belief.weights)[team.targets, None, None] if belief.weights else slopes

    def _gradient(self, belief: Tracks, team: Impact) -> NDArray[np.float64]:
        """The same of targets that all weigh the same."""
        return chain_gradient(belief.motion, self.measure, (team.targets, _near(team.blocks, belief)))


def _near(blocks: NDArray[np.float64], belief: Tracks) -> NDArray[np.float64]:
    """Return the horizon's part of blocks (N, K + B, 3)."""
    return _first(blocks, belief.horizon)


def _first(blocks: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    return np.ascontiguousarray(blocks[:, :steps])


class Endless(TrackingObjective):
    """``sum_k gamma^(k-1) 1/2 ln det(1 + P_{k|k-1} I_k)`` over all time to come, gamma a step's discount.

    A sum of the trajectory's gains over the first 1, 2, ... steps with weights >= 0, as gamma^k falls: so it
    is monotone and submodular as they are. Beyond the horizon layers count by the discount of their steps,
    the last one for ever. docs/tracking.md (V91)
    """

    gamma = 0.98  # a second

    def discount(self, belief: Tracks) -> float:
        """Of a step."""
        return float(self.gamma**belief.dt)

    def _within(self, belief: Tracks, others: Impact, rows: Impacts) -> NDArray[np.float64]:
        """``sum_k (gamma^(k-1) - gamma^k) J_k + gamma^(K-1) J_K``, J_k the gain of the first k steps."""
        return np.asarray(
            sum(
                weight
                * chain_values(
                    belief.motion,
                    self.measure,
                    (others.targets, _first(others.blocks, k)),
                    rows.starts,
                    (rows.targets, _first(rows.blocks, k)),
                )
                for k, weight in enumerate(self._weights(belief), 1)
            )
        )

    def _weights(self, belief: Tracks) -> list[float]:
        gamma = self.discount(belief)
        falls = [gamma ** (k - 1) * (1.0 - gamma) for k in range(1, belief.horizon)]
        return [*falls, gamma ** (belief.horizon - 1)]

    def layer_weights(self, belief: Tracks) -> NDArray[np.float64]:
        """(B,) Discounted steps in each layer."""
        return belief.tail.discounted(belief.horizon, self.discount(belief))

    def _gradient(self, belief: Tracks, team: Impact) -> NDArray[np.float64]:
        """Derivative of the horizon's part by each number in ``team.blocks``, (M, K, 3)."""
        total = np.zeros((len(team.targets), belief.horizon, 3))
        for k, weight in enumerate(self._weights(belief), 1):
            part = chain_gradient(belief.motion, self.measure, (team.targets, _first(team.blocks, k)))
            total[:, :k] += weight * part
        return total


class FinalEntropy(TrackingObjective):
    """``1/2 ln det P_K`` without measurements less that with them [nat]: only the last step's state counts.

    Monotone, but where targets are disturbed returns need not diminish: of two precise lines of sight that
    cross, the later disturbance blurs what either fixes, but not that they cross. So there is no bound.
    """

    submodular = False
    measure: Measure = "final-logdet"


class FinalVariance(TrackingObjective):
    """``tr P_K`` of the positions without measurements less that with them [m^2].

    Monotone, as information never enlarges a covariance; but returns need not diminish, not even in one step:
    along the short axis of a long, oblique ellipse a look removes little, and more once another has made the
    ellipse rounder. So there is no bound.
    """

    submodular = False
    measure: Measure = "final-trace"


OBJECTIVES: dict[str, type[TrackingObjective]] = {
    "trajectory": TrackingObjective,
    "endless": Endless,
    "final-entropy": FinalEntropy,
    "final-variance": FinalVariance,
}


def _wrong(part: Any) -> str | None:
    return None if callable(part) else f"is {type(part).__name__}, not a class of objectives"


OBJECTIVE: PartKind[Callable[[], TrackingObjective]] = PartKind(
    "objectives", "objective", OBJECTIVES, _wrong, "docs/how-to/own-objective.md"
)


def objective(name: str) -> TrackingObjective:
    """Return the objective of this name.

    Raises:
        InputError: there is none, or what its class makes is none.
    """
    make = OBJECTIVE.find(name)
    if name in OBJECTIVES:
        return make()
    where = f"objective {name}"
    with telling(where):
        own = make()
        if not isinstance(own, TrackingObjective):
            raise TypeError(f"gives {type(own).__name__}; a TrackingObjective is asked for")
    setattr(own, "values", _one_each(own.values))  # noqa: B010, of this one
    return told(own, {"value": number, "values": numbers}, where)


def _one_each(values: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function, which raises ValueError where it gives another number of values than impacts."""

    def checked(belief: Any, others: Any, own: Any) -> Any:
        returned = values(belief, others, own)
        if np.shape(returned) != (len(own),):
            raise ValueError(f"gives {np.shape(returned)} for {many(len(own), 'impact')}")
        return returned

    return checked
