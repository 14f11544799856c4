"""What looks from viewpoints reveal of the belief frozen last: in one process each is worked out once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, TypeAlias
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.prior import Shares

Aim: TypeAlias = tuple[int, float]  # from a cell of the window, which way [rad]
_Row: TypeAlias = tuple[NDArray[np.uint32], NDArray[np.float32]]


@dataclass(frozen=True, eq=False)
class LooksTaken:
    """Robots simulated together freeze one belief, and most of their viewpoints are the same."""

    belief: ref[MapBelief]
    known: dict[Hashable, dict[Aim, _Row]] = field(default_factory=dict)  # by sensor and map

    last: ClassVar[LooksTaken | None] = None

    @classmethod
    def at(cls, belief: MapBelief) -> LooksTaken:
        """Return what has been worked out on a belief so far, which is forgotten with the next belief."""
        last = cls.last
        if last is None or last.belief() is not belief:
            last = cls.last = cls(ref(belief))
        return last

    def reveal(
        self, sensor: Hashable, looks: Sequence[Aim], work_out: Callable[[list[int]], Shares]
    ) -> Shares:
        """Return a row a look, as ``work_out`` gives them for those of these numbers that are new."""
        known = self.known.setdefault(sensor, {})
        new = list({look: number for number, look in enumerate(looks) if look not in known}.values())
        if new:
            starts, cells, shares = work_out(new)
            for row, number in enumerate(new):
                entries = slice(starts[row], starts[row + 1])
                known[looks[number]] = cells[entries], shares[entries]
        rows = [known[look] for look in looks]
        return (
            np.cumsum([0, *(len(cells) for cells, _ in rows)], dtype=np.int64),
            np.concatenate([np.empty(0, np.uint32), *(cells for cells, _ in rows)]),
            np.concatenate([np.empty(0, np.float32), *(shares for _, shares in rows)]),
        )
