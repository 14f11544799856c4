"""What stands free before a lidar may be a robot or a person: it is no wall until it has stood still."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.kernels.tiles import TiledGrid
from vedette.maps import FREE, OCCUPIED
from vedette.maps.frame import GridFrame

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Disc = tuple[float, float, float]  # x, y, radius [m]

STILL = 3.0  # what has been in one place for so long is part of it [s]
BROAD = 0.9  # what is broader is no robot and nobody [m]
GAP = 0.3  # what stands free is nearer than what is beside it by so much [m]
FIRMLY = -8  # log-odds of ground that was seen to be free for sure [0.2 nats]
THROUGH = 1.5  # a beam that gets so far beyond a cell has been through it [cells]
LONG = 1e3  # of a beam that comes back from nothing [m]
LATELY = 1.0  # for so long it is taken to be where it was seen [s]

_BESIDE = np.arange(-1, 2)


@dataclass(eq=False)
class PassersBy:
    """Keeps returns from what may move out of one robot's evidence, whoever that is and wherever it is.

    A return is doubted where it is of something that stands free and is no broader than a body, or where
    there was free ground before. Its cell is told once something has been there for `STILL` seconds, nothing
    having been seen behind it meanwhile, and taken back as soon as something is.
    """

    frame: GridFrame  # of the evidence
    radius: float  # of a body, as theirs are expected to be [m]
    _cells: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))  # doubted, increasing
    _since: Floats = field(default_factory=lambda: np.empty(0))  # when something was first seen there [s]
    _discs: tuple[Disc, ...] = ()  # those that may move, frame of the evidence's own
    seen: float = 0.0  # when anything was looked at last [s]

    def sift(
        self,
        log_odds: TiledGrid[np.int8],
        place: tuple[float, float],
        angles: Floats,
        ranges: Floats,
        hits: Mask,
        nudge: float,
        now: float,
    ) -> NDArray[np.int64]:
        """Let doubtful returns tell of free ground before them alone; return the cells that are taken back.

        Args:
            log_odds: of the robot; what is taken back is changed in place.
            place: of the lidar, from the corner of the grid [m].
            angles: ``(B,)`` [rad].
            ranges: ``(B,)`` [m]; of what is doubted shortened in place.
            hits: ``(B,)``; of what is doubted taken away in place.
            nudge: so much farther a return counts [m].
            now: [s].
        """
        order = np.argsort(angles, kind="stable")
        angles, whole, told = angles[order], ranges, hits
        ranges, hits = ranges[order], hits[order]
        back = self._seen_through(log_odds, place, angles, ranges)
        first, last = _standing_free(angles, ranges, hits)
        doubted = np.zeros(len(hits), np.bool_)
        for start, end in zip(first.tolist(), last.tolist(), strict=True):
            doubted[np.arange(start, end + 1) % len(hits)] = True
        cells = self._under(place, angles, ranges + nudge)
        doubted |= hits & self._was_free(log_odds, cells, hits)
        self._remember(cells[doubted], now)
        moving = doubted.copy()
        moving[doubted] = now - self._since[np.searchsorted(self._cells, cells[doubted])] < STILL
        self._note_discs(place, angles, ranges, moving, first, last)
        self.seen = now
        hits[moving] = False
        ranges[moving] = np.maximum(ranges[moving] - self.frame.resolution, 0.0)
        whole[order], told[order] = ranges, hits
        return back

    def sift_map(
        self, log_odds: TiledGrid[np.int8], classes: NDArray[np.uint8], first: tuple[int, int], now: float
    ) -> None:
        """Keep what may move out of a map that the robot has made itself, changed in place.

        Small things that are in it where there was free ground, and not yet for `STILL` seconds, are free as
        before.

        Args:
            log_odds: of the robot, as the map before has left it.
            classes: ``(R, C)`` of the map.
            first: row and column of its first cell.
            now: [s].
        """
        row, col = (slice(at, at + n) for at, n in zip(first, classes.shape, strict=True))
        new = (classes == OCCUPIED) & (log_odds.window(row, col) < 0)
        at = np.argwhere(_small(new, round(BROAD / self.frame.resolution)))
        flat = (at[:, 0] + first[0]) * self.frame.cols + at[:, 1] + first[1]
        still = np.isin(self._cells, flat)
        self._cells, self._since = self._cells[still], self._since[still]
        self._remember(flat, now)
        moving = at[now - self._since[np.searchsorted(self._cells, flat)] < STILL]
        classes[moving[:, 0], moving[:, 1]] = FREE

    def discs(self, now: float) -> list[Disc]:
        """Return those seen lately that may move, as discs in the frame of the map [m]."""
        if now > self.seen + LATELY:
            return []
        left, low = self.frame.origin_x, self.frame.origin_y
        return [(x + left, y + low, radius) for x, y, radius in self._discs]

    def _under(self, place: tuple[float, float], angles: Floats, ranges: Floats) -> NDArray[np.int64]:
        """Return the flat cell of each beam's end; those outside the grid are put on its edge."""
        side, (rows, cols) = self.frame.resolution, self.frame.shape
        col = np.floor((place[0] + ranges * np.cos(angles)) / side).astype(np.int64)
        row = np.floor((place[1] + ranges * np.sin(angles)) / side).astype(np.int64)
        flat: NDArray[np.int64] = np.clip(row, 0, rows - 1) * cols + np.clip(col, 0, cols - 1)
        return flat

    def _was_free(self, log_odds: TiledGrid[np.int8], cells: NDArray[np.int64], hits: Mask) -> Mask:
        """Tell which returns come from ground that was free, with no wall beside it."""
        free = hits & (log_odds.take(cells) <= FIRMLY)
        at = np.flatnonzero(free)
        if len(at):
            row, col = np.divmod(cells[at], self.frame.cols)
            rows = np.clip(row[:, None, None] + _BESIDE[:, None], 0, self.frame.rows - 1)
            cols = np.clip(col[:, None, None] + _BESIDE, 0, self.frame.cols - 1)
            around = log_odds.take((rows * self.frame.cols + cols).ravel()).reshape(len(at), -1)
            free[at] = (around <= 0).all(axis=1)
        return free

    def _remember(self, cells: NDArray[np.int64], now: float) -> None:
        """Doubt cells from now on, those that are not doubted already."""
        fresh = np.setdiff1d(cells, self._cells)
        if len(fresh):
            at = np.searchsorted(self._cells, fresh)
            self._cells = np.insert(self._cells, at, fresh)
            self._since = np.insert(self._since, at, now)

    def _seen_through(
        self, log_odds: TiledGrid[np.int8], place: tuple[float, float], angles: Floats, ranges: Floats
    ) -> NDArray[np.int64]:
        """Forget cells that beams have been through; return those of them that were told, taken back."""
        if not len(self._cells) or not len(angles):
            return self._cells[:0]
        row, col = np.divmod(self._cells, self.frame.cols)
        side = self.frame.resolution
        dx, dy = (col + 0.5) * side - place[0], (row + 0.5) * side - place[1]
        away = np.hypot(dx, dy)
        beam, off = _nearest(angles, np.arctan2(dy, dx))
        through = (off * away < 0.5 * side) & (ranges[beam] > away + THROUGH * side)
        gone = self._cells[through]
        self._cells, self._since = self._cells[~through], self._since[~through]
        told = gone[log_odds.take(gone) > 0]
        log_odds.put(told, np.full(len(told), -1, np.int8))
        return told

    def _note_discs(
        self,
        place: tuple[float, float],
        angles: Floats,
        ranges: Floats,
        moving: Mask,
        first: NDArray[np.int64],
        last: NDArray[np.int64],
    ) -> None:
        """Remember where they are: behind the middle of what is seen of them."""
        discs = []
        for start, end in zip(first.tolist(), last.tolist(), strict=True):
            beams = np.arange(start, end + 1) % len(moving)
            if moving[beams].any():
                middle = beams[len(beams) // 2]
                away = float(ranges[beams].min()) + self.radius
                x, y = place[0] + away * np.cos(angles[middle]), place[1] + away * np.sin(angles[middle])
                discs.append((float(x), float(y), self.radius))
        self._discs = tuple(discs)


def _standing_free(angles: Floats, ranges: Floats, hits: Mask) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first and the last beam of each narrow thing with something farther beside it.

    What is on its other side is farther too, or hides the rest of it: then it counts from two beams on, for
    single ones are of walls that are seen along. The last is before the first, plus the number of beams,
    where a thing lies across the first beam.
    """
    count = len(hits)
    seen = np.where(hits, ranges, LONG)
    step = np.roll(seen, -1) - seen  # from each beam to the next
    breaks = np.flatnonzero(np.abs(step) > GAP)
    if len(breaks) < 2:
        return breaks[:0], breaks[:0]
    begins, ends = (np.roll(breaks, 1) + 1) % count, breaks
    last = np.where(ends < begins, ends + count, ends)
    before, after = (
        step[begins - 1],
        step[ends],
    )  # a nearer thing begins with a step down, and ends with one up
    free = (before < 0.0) & (after > 0.0)
    half_hidden = ((before < 0.0) | (after > 0.0)) & (last > begins)
    breadth = np.remainder(angles[ends] - angles[begins], 2.0 * np.pi) * ranges[begins]
    kept = hits[begins] & (free | half_hidden) & (breadth <= BROAD)
    return begins[kept], last[kept]


def _small(cells: Mask, most: int) -> Mask:
    """Return those of the cells ``(R, C)`` whose part, corners included, is at most so many cells broad."""
    labels, _ = scipy.ndimage.label(cells, np.ones((3, 3)))
    small = [False] + [
        max(b.stop - b.start for b in box) <= most for box in scipy.ndimage.find_objects(labels)
    ]
    found: Mask = np.array(small)[labels]
    return found


def _nearest(angles: Floats, bearings: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return the beam nearest to each bearing, and how far it is from that [rad]."""
    turned = angles[0] + np.remainder(bearings - angles[0], 2.0 * np.pi)
    right = np.searchsorted(angles, turned) % len(angles)
    left = right - 1
    gaps = [np.abs(np.remainder(angles[at] - turned + np.pi, 2.0 * np.pi) - np.pi) for at in (left, right)]
    nearer = gaps[0] < gaps[1]
    return np.where(nearer, left % len(angles), right), np.minimum(gaps[0], gaps[1])
