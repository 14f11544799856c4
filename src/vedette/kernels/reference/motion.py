"""Plain-Python twin of ``vedette.kernels.motion``: its specification."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.motion import Command, Limits

STEPS = 20  # of a roll-out
DISC_GUARD = 0.05
OFFSETS = (0.0, -0.1, 0.1, -0.2, 0.2, -0.35, 0.35, -0.5, 0.5, -0.7, 0.7)  # left positive [m]
SPEEDS = (1.0, 0.6, 0.25)  # shares of the top speed
LOOKS = (0.4, 0.15)  # look-ahead [m]
FADE = 0.2  # offsets fade over this last stretch [m]
COST_LATERAL = 0.4  # [s/m]
COST_CHANGE = 0.2  # [s/m]
COST_CLOSE = 0.5  # [s]
COST_WRONG_SIDE = 0.2  # [s]
COST_OUTSIDE = 0.3  # [s] a step
COST_BACK = 0.5  # [s] to turn back on the spot
ALIGNED, ASKEW = 0.35, 1.3  # full speed below, none above [rad]
SATISFIED = 0.1  # [s]
SLACK = 1e-9

Pose = tuple[float, float, float]


class Follower(NamedTuple):
    """A way to follow the path."""

    offset: float
    speed: float
    look: float


def clearance(solid: NDArray[np.bool_], resolution: float, x: float, y: float, reach: float) -> float:
    """Distance from the point to the nearest solid cell's square, by looking at every cell."""
    rows, cols = solid.shape
    border = max(min(x, y, cols * resolution - x, rows * resolution - y), 0.0)
    row, col = np.nonzero(solid)
    dx = np.maximum(np.maximum(col * resolution - x, x - (col + 1) * resolution), 0.0)
    dy = np.maximum(np.maximum(row * resolution - y, y - (row + 1) * resolution), 0.0)
    nearest = float(np.sqrt(dx * dx + dy * dy).min(initial=np.inf))
    return float(min(border, reach, nearest))


def block_discs(
    free: NDArray[np.bool_], resolution: float, discs: Sequence[tuple[float, float, float]]
) -> NDArray[np.bool_]:
    """Take out of ``free`` the cells whose centre lies in a disc, by looking at every cell."""
    y, x = ((np.arange(size) + 0.5) * resolution for size in free.shape)
    left = free.copy()
    for a, b, r in discs:
        left &= (x[None, :] - a) ** 2 + (y[:, None] - b) ** 2 >= r * r
    return left


class MotionScene(NamedTuple):
    """What a robot steers by; see ``vedette.kernels.motion.steer``."""

    solid: NDArray[np.bool_]  # (R, C)
    traversable: NDArray[np.bool_]  # (r, c)
    first: tuple[int, int]  # row and column of its first cell
    resolution: float  # [m]
    path: NDArray[np.float64]  # (L, 2) [m]
    arc: NDArray[np.float64]  # (L,) [m]
    others: NDArray[np.float64]  # (D, 6) x, y, vx, vy, radius, gap [m, m/s]
    limits: Limits
    turning: float  # how fast it has just turned on the spot [rad/s]; 0 if it moved

    def inside(self, x: float, y: float) -> bool:
        """Tell whether the point lies in a traversable cell."""
        row, col = (
            math.floor(y / self.resolution) - self.first[0],
            math.floor(x / self.resolution) - self.first[1],
        )
        rows, cols = self.traversable.shape
        return 0 <= row < rows and 0 <= col < cols and bool(self.traversable[row, col])

    def at(self, s: float) -> tuple[float, float, float, float]:
        """Point and unit direction at arc length ``s``."""
        i = min(max(bisect_right(self.arc.tolist(), s), 1), len(self.arc) - 1) - 1
        (x, y), (x1, y1) = self.path[i].tolist(), self.path[i + 1].tolist()
        span = float(self.arc[i + 1] - self.arc[i])
        tx, ty = (x1 - x) / span, (y1 - y) / span
        along = min(max(s - float(self.arc[i]), 0.0), span)
        return x + along * tx, y + along * ty, tx, ty

    def project(self, x: float, y: float, low: float, high: float) -> tuple[float, float]:
        """Arc length, within ``[low, high]``, of the path's nearest point; and its distance."""
        low, high = max(low, 0.0), min(high, float(self.arc[-1]))
        best = (low, math.inf)
        for i in range(len(self.arc) - 1):
            start, end = self.arc[i : i + 2].tolist()
            if (end <= low and i < len(self.arc) - 2) or start > high:
                continue
            (ax, ay), (bx, by) = self.path[i].tolist(), self.path[i + 1].tolist()
            span = end - start
            tx, ty = (bx - ax) / span, (by - ay) / span
            along = (x - ax) * tx + (y - ay) * ty
            along = min(max(along, max(low - start, 0.0)), min(high - start, span))
            distance = _norm(x - ax - along * tx, y - ay - along * ty)
            if distance < best[1]:
                best = (start + along, distance)
        return best

    def follow(self, f: Follower, pose: Pose, s: float) -> tuple[float, float, float]:
        """Speed, turn rate and heading error of a follower."""
        total, limits = float(self.arc[-1]), self.limits
        ahead = min(s + f.look, total)
        px, py, tx, ty = self.at(ahead)
        offset = f.offset * min((total - ahead) / FADE, 1.0)
        dx, dy = px - offset * ty - pose[0], py + offset * tx - pose[1]
        distance = _norm(dx, dy)
        if distance < 1e-6:
            return 0.0, 0.0, 0.0
        error = _wrap(math.atan2(dy, dx) - pose[2])
        turn = min(max(error / limits.period, -limits.turn_rate), limits.turn_rate)
        aligned = (math.cos(error) - math.cos(ASKEW)) / (math.cos(ALIGNED) - math.cos(ASKEW))
        stop = distance / limits.period if ahead >= total else math.inf
        return min(f.speed * min(max(aligned, 0.0), 1.0), stop), turn, error

    def gap(
        self, here: tuple[float, float], there: tuple[float, float], step: int
    ) -> tuple[bool, float, float]:
        """Whether a step keeps the guard to discs; how close it comes (0 to 1); whether on the wrong side."""
        free, close, wrong = True, 0.0, 0.0
        period = self.limits.period
        times = (0.0, 0.0) if step == 1 else ((step * period) - period, step * period)
        for x, y, vx, vy, radius, courtesy in self.others.tolist():
            before, after = (
                _norm(p[0] - x - t * vx, p[1] - y - t * vy) - (self.limits.radius + radius)
                for p, t in zip((here, there), times, strict=True)
            )
            if after < DISC_GUARD and after < before + SLACK:
                free = False
            near = max((courtesy - after) / courtesy, 0.0)
            if near > close:
                close = near
                mx, my = there[0] - here[0], there[1] - here[1]
                t = step * period
                rx, ry = x + t * vx - there[0], y + t * vy - there[1]
                head_on = mx * vx + my * vy < -0.5 * _norm(mx, my) * _norm(vx, vy)
                wrong = 1.0 if head_on and mx * ry - my * rx < 0.0 else 0.0
        return free, close, wrong

    def price(
        self, f: Follower, pose: Pose, s: float, last_offset: float, enough: float = math.inf
    ) -> Command:
        """Roll a follower out and price it; infinity once its own speed cannot beat ``enough``."""
        period, keep = self.limits.period, self.limits.radius + self.limits.guard
        x, y, heading = pose
        speed, turn, first_arc = 0.0, 0.0, s
        close, wrong, outside, error = 0.0, 0.0, 0, 0.0
        change = COST_CHANGE * abs(f.offset - last_offset)
        was_outside = not self.inside(x, y)
        wall = clearance(self.solid, self.resolution, x, y, keep)
        for step in range(1, STEPS + 1):
            v, w, error = self.follow(f, (x, y, heading), s)
            middle = heading + 0.5 * w * period
            nx, ny = x + v * period * math.cos(middle), y + v * period * math.sin(middle)
            is_outside = not self.inside(nx, ny)
            free, near, side = self.gap((x, y), (nx, ny), step)
            next_wall = clearance(self.solid, self.resolution, nx, ny, keep)
            go = free and (was_outside or not is_outside) and next_wall >= wall - SLACK
            heading += w * period
            if go:
                if near > close:
                    close, wrong = near, side
                x, y, wall, was_outside = nx, ny, next_wall, is_outside
                s = self.project(x, y, s - 0.1, s + 0.5)[0]
            outside += was_outside
            if step == 1:
                turn = w
                if abs(w) >= self.limits.turn_rate and w * self.turning < 0.0:
                    change += COST_BACK
                if go:
                    speed, first_arc = v, s
            reach = s + (STEPS - step) * period * f.speed
            least = max(float(self.arc[-1]) - reach, 0.0) / self.limits.speed
            least += change + COST_CLOSE * close + COST_OUTSIDE * outside
            if least > enough + SLACK:
                return Command(speed, turn, first_arc, f.offset, math.inf)
        arc, lateral = self.project(x, y, s - 0.1, s + 0.5)
        cost = (
            (float(self.arc[-1]) - arc) / self.limits.speed
            + abs(error) / self.limits.turn_rate
            + COST_LATERAL * lateral
            + change
            + COST_CLOSE * close
            + COST_WRONG_SIDE * wrong
            + COST_OUTSIDE * outside
        )
        return Command(speed, turn, first_arc, f.offset, cost)


def steer(
    solid: NDArray[np.bool_],
    traversable: NDArray[np.bool_],
    first: tuple[int, int],
    resolution: float,
    pose: Pose,
    path: NDArray[np.float64],
    arc: NDArray[np.float64],
    progress: tuple[float, float, float],
    others: NDArray[np.float64],
    limits: Limits,
) -> Command:
    """Try every follower in turn; stop at the first that is good enough, else take the cheapest."""
    s, last_offset, turning = progress
    scene = MotionScene(solid, traversable, first, resolution, path, arc, others, limits, turning)
    s = scene.project(pose[0], pose[1], s - 0.5, s + 1.0)[0]
    conceivable = max(float(arc[-1]) - s - STEPS * limits.period * limits.speed, 0.0) / limits.speed
    best = scene.price(Follower(last_offset, 0.0, LOOKS[0]), pose, s, last_offset)
    for share in SPEEDS:
        for look in LOOKS:
            for offset in OFFSETS:
                if best.cost <= conceivable + SATISFIED:
                    return best
                f = Follower(offset, share * limits.speed, look)
                command = scene.price(f, pose, s, last_offset, best.cost)
                if command.cost < best.cost - SLACK:
                    best = command
    return best


def _norm(x: float, y: float) -> float:
    return math.sqrt(x * x + y * y)


def _wrap(angle: float) -> float:
    return math.atan2(math.sin(angle), math.cos(angle))


def remaining(path: NDArray[np.float64], x: float, y: float, length: float) -> NDArray[np.float64]:
    """Twin of ``motion.remaining``, by whole arrays."""
    if len(path) < 2:
        return path
    here = np.array((x, y))
    start, step = path[:-1], path[1:] - path[:-1]
    square = np.maximum(np.einsum("ij,ij->i", step, step), 1e-12)
    along = np.minimum(np.maximum(np.einsum("ij,ij->i", here - start, step) / square, 0.0), 1.0)
    foot = start + along[:, None] * step
    away = foot - here
    leg = int(np.einsum("ij,ij->i", away, away).argmin())
    rest = path[leg:].copy()
    rest[0] = foot[leg]
    arc = np.zeros(len(rest))
    np.cumsum(np.hypot(*(rest[1:] - rest[:-1]).T), out=arc[1:])
    if arc[-1] <= length:
        return rest
    inside = arc < length
    last = [np.interp(length, arc, rest[:, 0]), np.interp(length, arc, rest[:, 1])]
    return np.vstack((rest[inside], last))
