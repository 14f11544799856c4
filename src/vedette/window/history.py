"""What has been shown, to be shown again: a moment a second, fewer of a long mission."""

from __future__ import annotations

import zlib
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from threading import Lock
from typing import Any

import msgspec
import numpy as np

from vedette.maps import GridFrame
from vedette.window.picture import Picture

MOST_MOMENTS = 4000
MOST_BYTES = 256 << 20


@dataclass(frozen=True)
class _Kept:
    """A picture with its map compressed."""

    t: float
    text: bytes
    frame: GridFrame
    classes: bytes

    @property
    def size(self) -> int:
        return len(self.text) + len(self.classes)

    @property
    def picture(self) -> Picture:
        """The picture itself."""
        classes = np.frombuffer(zlib.decompress(self.classes), np.uint8).reshape(self.frame.shape)
        return Picture(self.t, self.text, self.frame, classes)


class History:
    """Pictures by time; any thread may add and look."""

    def __init__(self, period: float = 1.0) -> None:
        """Keep at most a picture in each ``period`` [s]; twice as long when there are too many."""
        self._period, self._kept, self._size = period, list[_Kept](), 0
        self._lock = Lock()

    def add(self, shown: Picture) -> None:
        """Keep a picture, later than those before, unless one was kept just before."""
        with self._lock:
            if self._kept and shown.t < self._kept[-1].t + self._period - 1e-6:
                return
            packed = zlib.compress(np.ascontiguousarray(shown.classes).data, 1)
            self._kept.append(_Kept(shown.t, shown.text, shown.frame, packed))
            self._size += self._kept[-1].size
            if len(self._kept) > MOST_MOMENTS or self._size > MOST_BYTES:
                self._kept = self._kept[::2]
                self._size = sum(kept.size for kept in self._kept)
                self._period *= 2.0

    @property
    def span(self) -> tuple[float, float]:
        """The first and the last moment [s]; equal for none."""
        with self._lock:
            return (self._kept[0].t, self._kept[-1].t) if self._kept else (0.0, 0.0)

    def at(self, t: float) -> Picture | None:
        """Return what was shown at a time [s], or before; None: nothing was shown."""
        with self._lock:
            if not self._kept:
                return None
            kept = self._kept[max(bisect_right(self._kept, t + 1e-6, key=lambda each: each.t) - 1, 0)]
        return kept.picture

    def all(self) -> Iterator[Picture]:
        """Yield all that is kept, in order of time."""
        with self._lock:
            kept = list(self._kept)
        return (each.picture for each in kept)

    def told(self) -> list[Any]:
        """Return what was told in words and numbers, of at most some 500 moments."""
        with self._lock:
            texts = [kept.text for kept in self._kept]
        return [msgspec.json.decode(text) for text in texts[:: max(len(texts) // 500, 1)]]
