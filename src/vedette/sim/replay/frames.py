"""Shares of a log in frames of their own: where each lies in the log's, and the map laid back on that."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.align import FramePose
from vedette.align.turned import turned
from vedette.errors import InputError
from vedette.logs import RecordedLog, RecordedMap, Sight
from vedette.maps import GridFrame
from vedette.sim.framed import AWAY, frames_of
from vedette.sim.worlds.logged import frame_of

_BAND = 256  # rows that are laid at a time


def share_frames(
    log: RecordedLog, shares: Sequence[Sequence[Sight]], reach: float, seed: int, room: GridFrame
) -> list[FramePose]:
    """Return where each robot's frame lies in the log's, T_log_own: turned by anything, near what it sees.

    Args:
        log: of all shares.
        shares: of the robots.
        reach: of the beams [m].
        seed: of the frames.
        room: about each frame's origin.

    Raises:
        InputError: a share is larger than there is room for.
    """
    frames = []
    for share, away in zip(shares, frames_of(len(shares), seed), strict=True):
        x0, x1, y0, y1 = frame_of(_part(log, share), room.resolution, reach).extent
        needed = math.hypot(x1 - x0, y1 - y0) / 2.0 + reach + math.sqrt(2.0) * AWAY
        most = min(room.shape) / 2.0 * room.resolution
        if needed > most:
            raise InputError(
                f"{log.name}: a robot's share is of {x1 - x0:.0f} x {y1 - y0:.0f} m, and in a frame of its "
                f"own it needs {needed:.0f} m to each side, where there are {most:.0f} m in cells of "
                f"{room.resolution:g} m; raise --resolution or --robots"
            )
        frames.append(FramePose((x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0).after(away))
    return frames


def _part(log: RecordedLog, share: Sequence[Sight]) -> RecordedLog:
    maps = tuple(sight for sight in share if isinstance(sight, RecordedMap))
    scans = tuple(sight for sight in share if not isinstance(sight, RecordedMap))
    return replace(log, scans=scans, maps=maps)


def laid_back(
    classes: NDArray[np.uint8], own: GridFrame, there: FramePose, log: GridFrame
) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Return a robot's own map as it lies in the log's frame, and the grid ``(R, C)`` that holds it.

    Args:
        classes: ``(rows, cols)`` of its own frame.
        own: where they lie.
        there: T_log_own.
        log: the least that the grid holds, whose cells it has.
    """
    x0, x1, y0, y1 = own.extent
    corners = there.places(np.array([(x, y) for x in (x0, x1) for y in (y0, y1)]))
    cell, corner = log.resolution, (log.origin_x, log.origin_y)
    low = np.minimum(np.floor((corners.min(axis=0) - corner) / cell), 0)
    high = np.maximum(np.ceil((corners.max(axis=0) - corner) / cell), (log.cols, log.rows))
    (left, lower), (right, upper) = low.astype(int).tolist(), high.astype(int).tolist()
    onto = log.window(slice(lower, upper), slice(left, right))
    back = there.inverse()
    bands = [
        turned(classes, own, back, onto.window(slice(row, min(row + _BAND, onto.rows)), slice(0, onto.cols)))
        for row in range(0, onto.rows, _BAND)
    ]
    return onto, np.concatenate(bands)
