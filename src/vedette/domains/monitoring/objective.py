"""The team's monitoring objective: what its measurements take off the field's entropy, and how soon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.belief import FieldBelief, with_information
from vedette.domains.monitoring.factor import Factor
from vedette.domains.monitoring.impact import NOTHING, Impact
from vedette.domains.monitoring.worth import Patrol
from vedette.kernels import coverage
from vedette.kernels.misses import CERTAIN
from vedette.problem import Objective

Floats = NDArray[np.float64]

_KEPT = 32  # factors of one round


@dataclass(frozen=True, eq=False)
class MonitoringBelief:
    """What a round of monitoring is decided on; the field is taken to stand still over the horizon."""

    field: FieldBelief
    patrol: Patrol
    unit: float  # of information in impacts [1 / unit^2]

    @cached_property
    def posteriors(self) -> dict[bytes, Factor]:
        """Factors of ``L + W' diag(y) W`` found in this round, by y."""
        return {}

    def posterior(self, units: NDArray[np.int64]) -> Factor:
        """Return the factor of ``L + W' diag(units unit) W``, (spots,), made once."""
        key = np.packbits(units > 0).tobytes() + units[units > 0].tobytes()
        if key not in self.posteriors:
            if len(self.posteriors) >= _KEPT:
                self.posteriors.clear()
            more = self.field.information + self.unit * units
            self.posteriors[key] = Factor(with_information(self.field, more))
        return self.posteriors[key]


class MonitoringObjective(Objective[MonitoringBelief, Impact]):
    """``psi = sum_l (w_l - w_{l+1}) I(x; z_1..l)``, ``I = 1/2 ln det(L + Y_l) - 1/2 ln det L`` [nat].

    ``Y_l = W' diag(y_l) W`` is the information of all measurements up to the end of layer l, y_l in whole
    units, cut off at 255. ``*`` adds them: exactly associative. docs/monitoring.md (V124), (V125)

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

    def value(self, belief: MonitoringBelief, impact: Impact) -> float:
        """Return the entropy taken off, discounted."""
        prior = belief.field.factor.log_det
        logs = [belief.posterior(units).log_det for units in _by_layer(belief, impact)]
        return float(0.5 * belief.patrol.weights @ (np.array(logs) - prior))

    def values(self, belief: MonitoringBelief, others: Impact, own: Sequence[Impact]) -> Floats:
        """``value(others * own_k)`` for every k, by one factorisation a layer and small determinants."""
        gains = np.zeros(len(own))
        theirs = _by_layer(belief, others)
        mine = [_by_layer_sparse(belief, impact) for impact in own]
        for layer, weight in enumerate(belief.patrol.weights):
            looks = [each[layer] for each in mine]
            spots = np.unique(np.concatenate([look.spots for look in looks] or [np.empty(0, np.int64)]))
            if weight == 0.0 or not len(spots):
                continue
            before = theirs[layer]
            covariance = belief.posterior(before).covariance(belief.field.spots.weights[spots])
            for k, look in enumerate(looks):
                at = np.searchsorted(spots, look.spots)
                more = np.minimum(before[look.spots] + look.units, CERTAIN) - before[look.spots]
                root = np.sqrt(belief.unit * more)
                inner = np.eye(len(at)) + root[:, None] * covariance[np.ix_(at, at)] * root
                gains[k] += weight * np.log(np.diag(np.linalg.cholesky(inner))).sum()
        return self.value(belief, others) + gains


@dataclass(frozen=True, eq=False)
class _Looks:
    """Units of information at some spots, by the end of a layer."""

    spots: NDArray[np.int64]  # (m,) ascending
    units: NDArray[np.int64]  # (m,) 1 to 255


def _by_layer_sparse(belief: MonitoringBelief, impact: Impact) -> list[_Looks]:
    """Return what an impact comes to by the end of each layer."""
    spot, layer = np.divmod(impact.keys.astype(np.int64), belief.patrol.layers)
    out = []
    for last in range(belief.patrol.layers):
        spots, where = np.unique(spot[layer <= last], return_inverse=True)
        units = np.bincount(where, impact.misses[layer <= last], len(spots)).astype(np.int64)
        out.append(_Looks(spots, np.minimum(units, CERTAIN)))
    return out


def _by_layer(belief: MonitoringBelief, impact: Impact) -> NDArray[np.int64]:
    """Return the same as (layers, spots)."""
    out = np.zeros((belief.patrol.layers, belief.field.spots.count), np.int64)
    for row, looks in zip(out, _by_layer_sparse(belief, impact), strict=True):
        row[looks.spots] = looks.units
    return out
