"""Equal maps are frozen once in a process, others for themselves."""

from __future__ import annotations

import numpy as np

from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.frozen import Frozen
from vedette.domains.mapping.layers import rate
from vedette.domains.mapping.sightings import empty_counts
from vedette.maps import FREE, GridFrame

FRAME = GridFrame(0.1, 20, 30)
LAYERS = rate()


def frozen(free: int, *, reach: float = 1.0) -> MapBelief:
    classes, counts = np.zeros(FRAME.shape, np.uint8), empty_counts()
    classes[5:10, :free] = FREE
    return Frozen.once(
        (classes, counts),
        (FRAME, reach),
        lambda: freeze(classes, FRAME, reach=reach, extent=2.5, hidden=1.0, layers=LAYERS, counts=counts),
    )


def test_equal_maps_make_one_belief_as_long_as_somebody_holds_it() -> None:
    first = frozen(7)
    assert frozen(7) is first
    assert frozen(7, reach=2.0) is not first
    again = frozen(7)
    assert again is not first  # only the last one is kept in mind
    np.testing.assert_array_equal(again.classes, first.classes)


def test_another_map_makes_another_belief() -> None:
    first, second = frozen(7), frozen(8)
    assert np.count_nonzero(first.classes == FREE) == 35
    assert np.count_nonzero(second.classes == FREE) == 40
