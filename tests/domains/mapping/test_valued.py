"""Stops whose looks are valued on another drawing of the map: what they show there counts, nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, explored, frozen
from vedette.domains.mapping.belief import Drawing, MapBelief
from vedette.domains.mapping.platform import LEAST_AREA, MappingPlatform
from vedette.domains.mapping.stops import CLEARANCES, Stops, find_stops, survey
from vedette.domains.mapping.views import look
from vedette.maps import OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.transform import IDENTITY, Transform

THERE = Transform(7300, -2100, 0)
MORE = 14, 8  # rows below and columns to the left that the drawing has more


def stops_of(belief: MapBelief, x: float = -0.5, y: float = 7.1) -> Stops:
    ground = survey(belief, SPEC, x, y, [], CLEARANCES[0])
    model = MappingPlatform(SPEC).model(belief)
    return find_stops(belief, ground, SPEC, model, LEAST_AREA, look(belief, ground, SPEC))


def drawn(classes: NDArray[np.uint8]) -> MapBelief:
    """Return a map drawn elsewhere, in a grid that begins elsewhere, too."""
    left, low = FRAME.origin_x + 7.3 - 0.1 * MORE[1], FRAME.origin_y - 2.1 - 0.1 * MORE[0]
    onto = GridFrame(0.1, FRAME.rows + MORE[0], FRAME.cols + MORE[1], left, low)
    return frozen(np.pad(classes, ((MORE[0], 0), (MORE[1], 0))), frame=onto)


def test_looks_show_on_a_drawing_what_looks_from_the_same_places_show_that_are_found_on_it() -> None:
    classes = explored(CORRIDOR)
    there = drawn(classes)
    own = stops_of(replace(frozen(classes), valued=Drawing(there, THERE)))
    found = stops_of(there, -0.5 + 7.3, 7.1 - 2.1)
    assert len(own) >= 4
    assert np.allclose(own.targets + np.array((7.3, -2.1)), found.targets, rtol=0.0, atol=1e-9)
    for one, other in zip(vars(own.footprints).values(), vars(found.footprints).values(), strict=True):
        assert np.array_equal(one, other)
    assert not np.array_equal(own.footprints.cells, stops_of(frozen(classes)).footprints.cells)


def test_where_the_drawing_has_nothing_to_see_is_no_stop_and_elsewhere_all_stay() -> None:
    classes = explored(CORRIDOR)
    east = FRAME.centres(np.arange(FRAME.size))[:, 0].reshape(FRAME.shape) > 1.0
    shut = frozen(np.where(east & (classes == UNKNOWN), np.uint8(OCCUPIED), classes))
    whole = stops_of(frozen(classes)).targets
    left = stops_of(replace(frozen(classes), valued=Drawing(shut, IDENTITY))).targets
    assert (whole[:, 0] > 1.0).any()
    assert (left[:, 0] <= 1.0).all()
    assert {*map(tuple, whole[whole[:, 0] < 0.0])} == {*map(tuple, left[left[:, 0] < 0.0])}
