"""What two maps say of each other where one is taken to lie on the other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.align.charted import Charted
from vedette.align.pose import FramePose
from vedette.kernels.align import CLEAR, SAME, align_counts
from vedette.maps import UNKNOWN

_PLACES = 4000  # of free ground are looked at for what both know


class MapAgreement(NamedTuple):
    """Walls and ground of two maps, in the mean of both ways of looking at it."""

    same: float  # walls of each that lie on the other's [m]
    against: float  # walls of each on the other's clear ground [m]
    common: float  # ground that both know [m^2]

    @property
    def contradicted(self) -> float:
        """Of the walls that the other could see, the share on its clear ground, 0..1; 1: there is none."""
        seen = self.same + self.against
        return self.against / seen if seen else 1.0


def agreement(a: Charted, b: Charted, between_middles: FramePose) -> MapAgreement:
    """Return how far two maps agree where B lies on A so."""
    on_a = _counts(a, b, between_middles) * b.cell
    on_b = _counts(b, a, between_middles.inverse()) * a.cell
    return MapAgreement(
        same=float(on_a[SAME] + on_b[SAME]) / 2.0,
        against=float(on_a[CLEAR] + on_b[CLEAR]) / 2.0,
        common=_common(a, b, between_middles),
    )


def _counts(on: Charted, of: Charted, pose: FramePose) -> NDArray[np.int64]:
    """Return how many faces of a map fall on each label of the other."""
    x, y = ((pose.x, pose.y) - on.corner) / on.cell
    moved = np.array([[x, y, pose.angle]])
    counts: NDArray[np.int64] = align_counts(on.labels, on.looks_at, of.walls / on.cell, of.looks, moved)[0]
    return counts


def _common(a: Charted, b: Charted, pose: FramePose) -> float:
    """Return how much ground that B has seen free A knows too, from some thousand places [m^2]."""
    step = max(1, len(b.free) // _PLACES)
    col, row = np.floor((pose.places(b.free[::step]) - a.corner) / a.cell).astype(np.int64).T
    inside = (row >= 0) & (col >= 0) & (row < a.frame.rows) & (col < a.frame.cols)
    known = np.count_nonzero(a.classes[row[inside], col[inside]] != UNKNOWN)
    return float(known) * step * b.cell**2


def own_frames(a: Charted, b: Charted, between_middles: FramePose) -> FramePose:
    """Return T_a_b between the maps' own frames."""
    (a_x, a_y), (b_x, b_y) = a.middle.tolist(), b.middle.tolist()
    return FramePose(a_x, a_y, 0.0).after(between_middles).after(FramePose(-b_x, -b_y, 0.0))


def middles(a: Charted, b: Charted, own: FramePose) -> FramePose:
    """Return T_a_b between the maps' middles, of one between their own frames."""
    (a_x, a_y), (b_x, b_y) = a.middle.tolist(), b.middle.tolist()
    return FramePose(-a_x, -a_y, 0.0).after(own).after(FramePose(b_x, b_y, 0.0))
