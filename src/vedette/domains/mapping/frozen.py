"""The belief that was frozen last in this process: a team simulated together freezes equal maps once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief


@dataclass(frozen=True, eq=False)
class Frozen:
    """What a belief was frozen from, and the belief while anybody holds it."""

    arrays: tuple[NDArray[Any], ...]
    rest: tuple[Any, ...]
    belief: ref[MapBelief]

    last: ClassVar[Frozen | None] = None

    @classmethod
    def once(
        cls, arrays: tuple[NDArray[Any], ...], rest: tuple[Any, ...], make: Callable[[], MapBelief]
    ) -> MapBelief:
        """Return the last belief if it was made from the same, to the bit; else make one.

        ``arrays`` are held, not copied: nobody may write to them.
        """
        last = cls.last
        if last is not None and last.rest == rest:
            belief = last.belief()
            if belief is not None and all(map(np.array_equal, last.arrays, arrays)):
                return belief
        belief = make()
        cls.last = cls(arrays, rest, ref(belief))
        return belief
