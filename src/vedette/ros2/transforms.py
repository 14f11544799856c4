"""Where frames lie to each other at a time, from what TF has told of them."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from math import atan2, cos, hypot, sin
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

KEPT = 10.0  # a transform is remembered for so long [s]
RESTARTED = 10.0  # a stamp so much older than the latest is a clock that has begun anew [s]
Matrix: TypeAlias = NDArray[np.float64]  # (4, 4) T_parent_child


class Gap(Enum):
    """Why a transform is not known; the value says what a user can do about it."""

    UNCONNECTED = "no chain of transforms joins the two frames"
    NOT_YET = "not told for that time yet"
    FORGOTTEN = f"that time is past what is remembered, {KEPT:g} s"


def planar(x: float, y: float, yaw: float) -> Matrix:
    """Return the transform of a place in the plane [m, m, rad]."""
    c, s = cos(yaw), sin(yaw)
    return np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def place(T: Matrix) -> tuple[float, float, float]:
    """Return x, y [m] and yaw [rad] of a transform: where its x axis points in the plane."""
    return float(T[0, 3]), float(T[1, 3]), atan2(T[1, 0], T[0, 0])


def rotations(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the ``(..., 3, 3)`` rotations of quaternions ``(..., 4)`` x, y, z, w of any length but 0."""
    x, y, z, w = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def matrix(translation: Sequence[float], quaternion: Sequence[float]) -> Matrix:
    """Return a transform of a translation [m] and a quaternion x, y, z, w."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotations(np.asarray(quaternion, np.float64)), translation
    return T


def between(T0: Matrix, T1: Matrix, share: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """Return ``(..., 4, 4)``: transforms at shares 0 to 1 of the way from one to another.

    Places lie on the straight line; the turn is at a constant rate about one axis.
    """
    share = np.asarray(share, np.float64)
    turn = T0[:3, :3].T @ T1[:3, :3]
    axis = np.array((turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]))
    length = float(np.linalg.norm(axis))  # 2 sin(angle); a half turn has no direction and is not told apart
    angle = atan2(length, float(np.trace(turn)) - 1.0)
    x, y, z = axis / length if length > 0.0 else (0.0, 0.0, 1.0)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angles = (share * angle)[..., None, None]
    T = np.zeros((*share.shape, 4, 4))
    T[..., :3, :3] = T0[:3, :3] @ (np.eye(3) + np.sin(angles) * K + (1.0 - np.cos(angles)) * (K @ K))
    T[..., :3, 3] = T0[:3, 3] + share[..., None] * (T1[:3, 3] - T0[:3, 3])
    T[..., 3, 3] = 1.0
    return T


@dataclass
class _Joint:
    """A frame in its parent, by time."""

    parent: str
    fixed: bool
    stamps: list[float] = field(default_factory=list)  # ascending [s]
    told: list[Matrix] = field(default_factory=list)

    def add(self, stamp: float, T: Matrix) -> None:
        if self.fixed or (self.stamps and stamp < self.stamps[-1] - RESTARTED):
            self.stamps, self.told = [stamp], [T]
            return
        at = bisect_right(self.stamps, stamp)
        if at and self.stamps[at - 1] == stamp:
            self.told[at - 1] = T
            return
        self.stamps.insert(at, stamp)
        self.told.insert(at, T)
        old = bisect_left(self.stamps, self.stamps[-1] - KEPT)
        del self.stamps[:old], self.told[:old]

    def at(self, stamp: float | None) -> Matrix | Gap:
        if stamp is None or self.fixed:
            return self.told[-1]
        after = bisect_right(self.stamps, stamp)
        if after and self.stamps[after - 1] == stamp:
            return self.told[after - 1]
        if after == len(self.stamps):
            return Gap.NOT_YET
        if after == 0:
            return Gap.FORGOTTEN
        before, then = self.stamps[after - 1], self.stamps[after]
        return between(self.told[after - 1], self.told[after], (stamp - before) / (then - before))


@dataclass
class Transforms:
    """Remembers what TF tells, and chains it; stamps [s] are of whatever clock the robot has."""

    _joints: dict[str, _Joint] = field(default_factory=dict)  # by child

    def add(self, parent: str, child: str, stamp: float, T: Matrix, *, fixed: bool = False) -> None:
        """Take in ``T_parent_child``; of ``/tf_static`` it is ``fixed``. What is not finite is left out."""
        parent, child = parent.lstrip("/"), child.lstrip("/")
        if parent == child or not np.isfinite(T).all():
            return
        joint = self._joints.get(child)
        if joint is None or joint.parent != parent or joint.fixed != fixed:
            joint = self._joints[child] = _Joint(parent, fixed)
        joint.add(stamp, T)

    @property
    def frames(self) -> set[str]:
        """All frames that were told of."""
        return set(self._joints) | {joint.parent for joint in self._joints.values()}

    def newest(self, frame: str) -> float | None:
        """Return the latest stamp of the first joint above a frame that moves; None: there is none."""
        joints = (self._joints.get(each) for each in self._ancestors(frame))
        return next((joint.stamps[-1] for joint in joints if joint is not None and not joint.fixed), None)

    def lookup(self, target: str, source: str, stamp: float | None = None) -> Matrix | Gap:
        """Return ``T_target_source`` at a time; None: each joint as it was told last."""
        up, down = self._ancestors(source), self._ancestors(target)
        common = next((frame for frame in up if frame in down), None)
        if common is None:
            return Gap.UNCONNECTED
        T_common_source = self._chain(up[: up.index(common)], stamp)
        T_common_target = self._chain(down[: down.index(common)], stamp)
        if isinstance(T_common_target, Gap):
            return T_common_target
        if isinstance(T_common_source, Gap):
            return T_common_source
        return np.linalg.inv(T_common_target) @ T_common_source

    def _ancestors(self, frame: str) -> list[str]:
        """Return a frame and those that it hangs from, itself first; a ring is followed once."""
        frames = [frame.lstrip("/")]
        while (joint := self._joints.get(frames[-1])) is not None and joint.parent not in frames:
            frames.append(joint.parent)
        return frames

    def _chain(self, children: Sequence[str], stamp: float | None) -> Matrix | Gap:
        T = np.eye(4)
        for child in children:
            step = self._joints[child].at(stamp)
            if isinstance(step, Gap):
                return step
            T = step @ T
        return T


def deviations(covariance: Sequence[float]) -> tuple[float, float]:
    """Return the deviation of a place [m] and of its heading [rad] from a pose's 36 covariances."""
    c = np.asarray(covariance, np.float64).reshape(6, 6)
    if not np.isfinite(c).all():
        return 0.0, 0.0
    return hypot(max(c[0, 0], 0.0) ** 0.5, max(c[1, 1], 0.0) ** 0.5) / 2**0.5, max(c[5, 5], 0.0) ** 0.5
