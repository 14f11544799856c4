"""The team's monitoring objective: what its measurements take off the field's entropy, and how soon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.banded import BandedField, LayerLooks, Posterior
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.impact import NOTHING, Impact, clip
from vedette.domains.monitoring.worth import Patrol
from vedette.kernels import coverage
from vedette.problem import Objective, Reach

Floats = NDArray[np.float64]
Units = NDArray[np.int64]

_KEPT = 32  # posteriors of one round


@dataclass(frozen=True, eq=False)
class SpotsFirst:
    """Spots where measurements are worth more."""

    spots: NDArray[np.bool_]  # (spots,)
    extra: float  # how many times as much, less one


@dataclass(frozen=True, eq=False)
class MonitoringBelief:
    """What a round of monitoring is decided on; the field is taken to stand still over the horizon."""

    field: FieldBelief
    patrol: Patrol
    unit: float  # of information in impacts [1 / unit^2]
    priorities: Sequence[SpotsFirst] = ()

    @cached_property
    def banded(self) -> BandedField:
        """The field, ready to be factorised."""
        return BandedField(self.field)

    @cached_property
    def posteriors(self) -> dict[bytes, Posterior]:
        """The field with ``W' diag(y) W`` more, found in this round, by y."""
        return {}

    def posterior(self, units: Units) -> Posterior:
        """Return the field with ``W' diag(units unit) W`` more, (spots,), factorised once."""
        some = np.flatnonzero(units)
        key = some.tobytes() + units[some].tobytes()
        if key not in self.posteriors:
            if len(self.posteriors) >= _KEPT:
                self.posteriors.clear()
            self.posteriors[key] = self.banded.posterior(self.unit * units.astype(np.float64))
        return self.posteriors[key]

    def by_layer(self, impact: Impact) -> Units:
        """Return what an impact comes to by the end of each layer, (layers, spots)."""
        out = np.zeros((self.patrol.layers, self.field.spots.count), np.int64)
        for row, looks in zip(out, LayerLooks.of([impact], self.patrol.layers), strict=True):
            row[looks.spots[looks.places]] = looks.units
        return out


class MonitoringObjective(Objective[MonitoringBelief, Impact]):
    """``psi = sum_l (w_l - w_{l+1}) I(x; z_1..l)``, ``I = 1/2 ln det(L + Y_l) - 1/2 ln det L`` [nat].

    ``Y_l = W' diag(y_l) W`` is the information of all measurements up to the end of layer l, y_l in whole
    units, cut off at 255. ``*`` adds them: exactly associative. docs/monitoring.md (V124), (V125)

    With priorities a it is ``psi(all) + sum_a (f_a - 1) psi(measurements in a)``. (V165)

    Monotone and submodular: so is each mutual information with measurements that are independent given the
    field, and a sum of such with weights >= 0 is. (V126)
    """

    monotone = True
    submodular = True

    def nothing(self, belief: MonitoringBelief) -> Impact:
        """Return the impact of a team that measures nothing."""
        return NOTHING

    def combine(self, a: Impact, b: Impact) -> Impact:
        """``a * b``: sums of information, saturating."""
        return Impact(*coverage.combine(*a.sparse, *b.sparse, layers=1))

    def clip(self, belief: MonitoringBelief, impact: Impact, reach: Reach) -> Impact:
        """Leave out what next to nothing of receivers' gains depends on; docs/monitoring.md, section 3."""
        return clip(impact, belief.field.model.frame, belief.patrol.layers, reach)

    def value(self, belief: MonitoringBelief, impact: Impact) -> float:
        """Return the entropy taken off, discounted."""
        units = belief.by_layer(impact)
        more = (each.extra * _taken_off(belief, units * each.spots) for each in belief.priorities)
        return _taken_off(belief, units) + sum(more)

    def gains(self, belief: MonitoringBelief, others: Impact, own: Sequence[LayerLooks]) -> Floats:
        """``value(others * own_k) - value(others)`` for every k; ``own``: as `LayerLooks.of`."""
        before = belief.by_layer(others)
        gains = _gains(belief, before, own)
        for each in belief.priorities:
            some = [looks.within(each.spots) for looks in own]
            gains = gains + each.extra * _gains(belief, before * each.spots, some)
        return gains

    def values(self, belief: MonitoringBelief, others: Impact, own: Sequence[Impact]) -> Floats:
        """``value(others * own_k)`` for every k, by one factor a layer and small determinants."""
        return self.value(belief, others) + self.gains(
            belief, others, LayerLooks.of(own, belief.patrol.layers)
        )


def _taken_off(belief: MonitoringBelief, units: Units) -> float:
    """Return what measurements of units by layer, (layers, spots), take off the entropy, discounted."""
    prior = belief.posterior(np.zeros_like(units[0])).log_det
    logs = [belief.posterior(layer).log_det for layer in units]
    return float(0.5 * belief.patrol.weights @ (np.array(logs) - prior))


def _gains(belief: MonitoringBelief, before: Units, own: Sequence[LayerLooks]) -> Floats:
    """Return what each of several impacts adds to that, after measurements ``before``, (layers, spots)."""
    weighed = [
        weight * looks.gains(belief.posterior(layer), layer, belief.unit)
        for weight, looks, layer in zip(belief.patrol.weights, own, before, strict=True)
        if weight > 0.0
    ]
    return np.asarray(np.sum(weighed, axis=0))
