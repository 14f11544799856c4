"""A robot's own map as evidence: laid into the team's grid, and taking the place of what was said before."""

from __future__ import annotations

from math import cos, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import SPEC
from vedette.agent.events import Pose, Sensed
from vedette.agent.mates import Mate
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.fusion import ReplicatedEvidence
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.lattice import Lattice
from vedette.missions.explore.evidence import OwnEvidence
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.own_map import OwnMap
from vedette.missions.explore.passers_by import STILL, PassersBy

FRAME = GridFrame(0.1, 120, 120, -2.0, -3.0)


def room(resolution: float, x: float, y: float, heading: float) -> OwnMap:
    """A free room of 4 x 3 m with walls 0.2 m thick, as a map of its own."""
    rows, cols, wall = round(3.0 / resolution), round(4.0 / resolution), round(0.2 / resolution)
    classes = np.full((rows, cols), OCCUPIED, np.uint8)
    classes[wall:-wall, wall:-wall] = FREE
    return OwnMap(classes, resolution, x, y, heading)


def truth(
    x: NDArray[np.float64], y: NDArray[np.float64], corner: tuple[float, float, float]
) -> NDArray[np.uint8]:
    """The class of points of the team's frame, from the room's dimensions."""
    c, s = cos(corner[2]), sin(corner[2])
    u = c * (x - corner[0]) + s * (y - corner[1])
    v = c * (y - corner[1]) - s * (x - corner[0])
    inside = (u > 0) & (u < 4) & (v > 0) & (v < 3)
    free = (u > 0.2) & (u < 3.8) & (v > 0.2) & (v < 2.8)
    return np.where(free, FREE, np.where(inside, OCCUPIED, UNKNOWN)).astype(np.uint8)


@pytest.mark.parametrize("resolution", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("heading", [0.0, 5.0, 90.0, -37.0])
def test_a_map_is_laid_where_it_lies_and_its_walls_stay_closed(resolution: float, heading: float) -> None:
    corner = (1.03, 0.52, radians(heading))
    laid = room(resolution, *corner).laid(FRAME)
    at = FRAME.centres(np.arange(FRAME.size))
    true = truth(at[:, 0], at[:, 1], corner).reshape(FRAME.shape)
    firm = np.ones(FRAME.shape, np.bool_)  # not within 0.15 m of where the class changes
    for dx, dy in np.array(((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))) * 0.15:
        firm &= truth(at[:, 0] + dx, at[:, 1] + dy, corner).reshape(FRAME.shape) == true
    np.testing.assert_array_equal(laid[firm], true[firm])
    bounds = room(resolution, *corner).bounds(FRAME)
    assert not np.delete(laid, np.arange(bounds.top, bounds.bottom), axis=0).any()
    assert not np.delete(laid, np.arange(bounds.left, bounds.right), axis=1).any()


def explorer() -> Exploring:
    lattice = Lattice(FRAME)
    fusion = ReplicatedEvidence(0, 1, FRAME.shape, ROWS * BINS, mark=lattice.mark)
    return Exploring(lattice, SPEC, planner("tours"), fusion)


def told(mission: Exploring, own_map: OwnMap, mates: list[Mate] | None = None) -> NDArray[np.uint8]:
    """The team's map after the robot's own one came."""
    mission.observe(Sensed(own_map, 0.0), Pose(3.0, 2.0, 0.0), mates or [], 0.0)
    mission.publish(0.0)
    return mission.fusion.classes.window()


def test_a_map_that_jumps_leaves_nothing_of_what_was_said_before() -> None:
    mission = explorer()
    first, then = room(0.05, 1.0, 0.5, 0.0), room(0.05, 1.5, 0.5, radians(5.0))
    np.testing.assert_array_equal(told(mission, first), first.laid(FRAME))
    np.testing.assert_array_equal(told(mission, then), then.laid(FRAME))
    np.testing.assert_array_equal(told(mission, first), first.laid(FRAME))


def test_the_same_map_again_is_no_news() -> None:
    mission, own_map = explorer(), room(0.05, 1.0, 0.5, 0.0)
    told(mission, own_map)
    digest = mission.fusion.digest
    mission.observe(Sensed(own_map, 1.0), Pose(3.0, 2.0, 0.0), [], 1.0)
    assert not len(mission.own.news())
    assert mission.fusion.digest == digest


def test_a_team_mate_in_the_map_is_no_obstacle() -> None:
    own_map = room(0.05, 1.0, 0.5, 0.0)
    own_map.classes[28:32, 38:42] = OCCUPIED
    mate = Mate(1, 3.0, 2.0, 0.0, (), 0.0, 0.2, 0.5, 0.0)
    assert told(explorer(), own_map)[50, 50] == OCCUPIED
    assert told(explorer(), own_map, [mate])[50, 50] == UNKNOWN


def test_a_map_outside_the_teams_grid_says_nothing() -> None:
    assert not told(explorer(), room(0.05, 100.0, 0.5, pi / 3)).any()


class Mapped:
    """What a robot says whose SLAM tells its map once a second, and that knows no mate's place."""

    def __init__(self) -> None:
        lattice = Lattice(FRAME)
        self.own = OwnEvidence(lattice, SPEC, PassersBy(FRAME, SPEC.radius))

    def tell(self, now: float, *solid: tuple[slice, slice], x: float = 0.0) -> NDArray[np.bool_]:
        """Take over the map of a free hall in which that is solid; return which of its cells are occupied."""
        classes = np.full((60, 60), FREE, np.uint8)
        for part in solid:
            classes[part] = OCCUPIED
        self.own.take_over(OwnMap(classes, 0.1, x, 0.0, 0.0), [], now)
        told: NDArray[np.bool_] = self.own.log_odds.window(slice(30, 90), slice(20, 80)) > 0
        return told


MATE = slice(20, 24), slice(30, 34)
WALL = slice(5, 55), slice(10, 12)


def test_a_body_that_comes_into_the_robots_own_map_is_no_wall_until_it_has_stood_still() -> None:
    mapped = Mapped()
    assert not mapped.tell(0.0).any()
    assert not mapped.tell(1.0, MATE).any()
    for now in (2.0, 3.0):  # it drives on
        assert not mapped.tell(now, (slice(20, 24), slice(30 + 3 * round(now), 34 + 3 * round(now)))).any()
    stands = slice(20, 24), slice(50, 54)
    assert not mapped.tell(4.0, stands).any()
    assert not mapped.tell(4.0 + STILL - 0.1, stands).any()
    assert np.count_nonzero(mapped.tell(4.0 + STILL, stands)) == 16
    assert not mapped.tell(8.0).any()  # it has gone


def test_a_body_that_goes_and_comes_again_has_not_stood_still() -> None:
    mapped = Mapped()
    mapped.tell(0.0)
    mapped.tell(1.0, MATE)
    mapped.tell(3.0)
    assert not mapped.tell(4.5, MATE).any()


def test_walls_are_told_at_once_as_they_come_and_as_the_map_shifts() -> None:
    mapped = Mapped()
    mapped.tell(0.0)
    assert np.count_nonzero(mapped.tell(1.0, WALL)) == 100
    assert np.count_nonzero(mapped.tell(2.0, WALL, x=0.5)) == 100  # a loop was closed


def test_what_was_never_seen_free_is_told_at_once() -> None:
    assert np.count_nonzero(Mapped().tell(0.0, MATE)) == 16
