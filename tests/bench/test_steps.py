"""What was tried of the planner does what it says, whatever it brings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.steps.late import LatePlatform
from bench.steps.regions import TO_LEAVE, RegionPlatform, regions
from bench.steps.sure import SurePlatform, beside
from bench.steps.way import WayPlatform
from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, explored, frozen, placed
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import Stops
from vedette.kernels.misses import CERTAIN
from vedette.maps import FREE, OCCUPIED, UNKNOWN


def stops_of(kind: type[MappingPlatform], belief: MapBelief, x: float, y: float) -> Stops:
    robot = kind(SPEC)
    placed(robot, belief, x, y)
    assert robot.stops is not None
    return robot.stops


def reached(kind: type[MappingPlatform], belief: MapBelief, x: float, y: float) -> list[tuple[float, ...]]:
    robot = kind(replace(SPEC, radius=0.22))
    placed(robot, belief, x, y)
    assert robot.stops is not None
    return [tuple(target) for target in robot.stops.targets[np.isfinite(robot.stops.first_leg)].tolist()]


def test_a_frontier_behind_a_narrow_way_is_a_stop_at_once_while_others_are_left() -> None:
    classes = np.full(FRAME.shape, OCCUPIED, np.uint8)
    classes[40:70, 40:70], classes[45:60, 70:80] = FREE, UNKNOWN  # a room that leads on
    classes[50:55, 25:40], classes[30:58, 15:25], classes[20:30, 15:25] = (
        FREE,
        FREE,
        UNKNOWN,
    )  # a narrow way out
    belief = frozen(classes)
    usual, late = (reached(kind, belief, 2.5, 7.0) for kind in (MappingPlatform, LatePlatform))
    assert len(usual) == 1
    assert len(late) == len(belief.frontier_starts) - 1 == 2
    assert set(usual) < set(late)


def test_who_visits_a_frontier_surely_sees_what_touches_it() -> None:
    belief = frozen(explored(CORRIDOR))
    usual, sure = (stops_of(kind, belief, *CORRIDOR[0]) for kind in (MappingPlatform, SurePlatform))
    cells, of = beside(belief)
    owners = np.repeat(np.arange(len(belief.frontier_starts) - 1), np.diff(belief.frontier_starts))
    for k, (x, y) in enumerate(sure.targets):
        own = owners[belief.frontier_cells == belief.frame.flat(x, y)]
        row, before = (slice(*each.footprints.starts[k : k + 2]) for each in (sure, usual))
        seen = dict(
            zip(sure.footprints.cells[row].tolist(), sure.footprints.misses[row].tolist(), strict=True)
        )
        touching = set(cells[of == own[0]].tolist())
        assert touching
        assert all(seen[cell] == CERTAIN for cell in touching)
        marks = usual.footprints.cells[before].tolist(), usual.footprints.misses[before].tolist()
        assert all(seen[cell] == miss for cell, miss in zip(*marks, strict=True) if cell not in touching)


def test_a_stop_shows_what_is_seen_on_the_way_and_no_less_than_before() -> None:
    belief = frozen(explored(CORRIDOR))
    usual, along = (stops_of(kind, belief, *CORRIDOR[0]) for kind in (MappingPlatform, WayPlatform))
    more = 0
    for k in range(len(usual)):
        row, longer = (slice(*each.footprints.starts[k : k + 2]) for each in (usual, along))
        seen = dict(
            zip(
                along.footprints.cells[longer].tolist(), along.footprints.misses[longer].tolist(), strict=True
            )
        )
        marks = usual.footprints.cells[row].tolist(), usual.footprints.misses[row].tolist()
        assert all(seen[cell] >= miss for cell, miss in zip(*marks, strict=True))
        assert list(seen) == sorted(seen)
        more += len(seen) - len(marks[0])
    assert more > 0


def test_two_rooms_joined_by_a_door_are_two_regions_and_to_change_them_counts_as_seconds() -> None:
    classes = np.full((40, 81), OCCUPIED, np.uint8)
    classes[1:-1, 1:40], classes[1:-1, 41:-1], classes[16:24, 40] = FREE, FREE, FREE
    rooms = regions(classes, 0.1)
    assert rooms[20, 10] == rooms[5, 35] != rooms[20, 70] == rooms[35, 45]
    belief = frozen(explored(CORRIDOR))
    usual, kept = (stops_of(kind, belief, *CORRIDOR[0]) for kind in (MappingPlatform, RegionPlatform))
    labels = regions(belief.classes, FRAME.resolution)
    of = np.array([labels[belief.frame.cell(y=y, x=x)] for x, y in usual.views])
    own = labels[belief.frame.cell(*CORRIDOR[0])]
    finite = np.isfinite(usual.first_leg)
    longer = (kept.first_leg - usual.first_leg)[finite]
    assert np.allclose(longer, np.where(of != own, TO_LEAVE, 0.0)[finite], atol=1e-3)
    assert (belief.classes == UNKNOWN).any()
