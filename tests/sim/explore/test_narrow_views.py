"""Robots that see little look round, and explore a room as others do."""

from __future__ import annotations

import itertools
import os
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from tests.support.small_missions import robots, room_with_a_wall, run, small_office, two_rooms
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.team import PlatformSpec

MAPS = Path(os.environ.get("MAPS", Path(__file__).parents[4] / "shared" / "maps"))


def check_explored(resolution: float, view: float, beams: int, n: int) -> None:
    """A team of such robots knows at least 99 % of the room and says that it is complete."""
    _, report = run(
        room_with_a_wall(resolution), robots(n, view=float(view), beams=beams), seed=1, max_time=3600.0
    )
    summary = report.summary
    assert summary.outcome.value == "complete"
    assert summary.coverage >= 0.99
    assert summary.collisions == 0
    assert {spot.why for spot in summary.left_out} <= {"unseeable"}
    assert any(length > 1.0 for length in summary.path_m.values())


@pytest.mark.parametrize(
    ("resolution", "view", "beams", "n"),
    [
        (0.05, 90, 360, 1),
        (0.05, 180, 360, 1),
        (0.05, 270, 360, 1),
        (0.05, 360, 16, 1),
        (0.03, 30, 64, 3),
        (0.07, 360, 8, 1),
        (0.1, 45, 8, 3),
    ],
)
def test_a_narrow_view_or_few_beams_suffice(resolution: float, view: float, beams: int, n: int) -> None:
    check_explored(resolution, view, beams, n)


def test_what_a_glance_from_afar_does_not_show_is_looked_at_from_close_by() -> None:
    world = two_rooms(0.48, 0.02, bent=True)
    _, report = run(world, [PlatformSpec(start=(1.0, 1.0))], seed=1)
    assert report.summary.completed
    assert report.summary.coverage >= 0.99
    assert report.summary.collisions == 0


@pytest.mark.parametrize("resolution", [0.03, 0.05])
def test_what_a_visit_opens_beside_itself_is_gone_to_before_anything_is_concluded(resolution: float) -> None:
    world = two_rooms(0.45, resolution, bent=True)
    _, report = run(world, [PlatformSpec(start=(1.0, 1.0), beams=16)], seed=1)
    assert report.summary.completed
    assert report.summary.coverage >= 0.99
    assert report.summary.collisions == 0


@pytest.mark.slow
@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("resolution", [0.02, 0.03, 0.05, 0.07, 0.1])
def test_every_view_and_number_of_beams_suffices(resolution: float, n: int) -> None:
    for view, beams in itertools.product((30, 60, 90, 180, 270, 360), (8, 16, 64, 360)):
        check_explored(resolution, view, beams, n)


def finer(world: World, times: int) -> World:
    """The same building in cells so many times smaller."""
    frame, solid = world.frame, world.solid.repeat(times, 0).repeat(times, 1)
    rows, cols = solid.shape
    cells = replace(frame, resolution=frame.resolution / times, rows=rows, cols=cols)
    return World(cells, solid, world.name)


@cache
def building(real: bool) -> World:
    """A generated office, or the west end of a real building: rooms on a corridor, cupboards, a kitchen."""
    if not real:
        return small_office()
    path = MAPS / "kth-50052751.yaml"
    if not path.exists():
        pytest.skip(f"no {path.name} in {MAPS}")
    solid = World.from_map(path).solid[:, :260].copy()
    return World(GridFrame(0.1, *solid.shape), solid, "kth")


@pytest.mark.slow
@pytest.mark.parametrize("j", range(4))
@pytest.mark.parametrize("i", range(7))
def test_an_office_and_a_real_building_are_explored_and_what_is_left_is_said(i: int, j: int) -> None:
    view, beams = (30, 45, 60, 90, 180, 270, 360)[i], (8, 16, 64, 360)[j]
    world = finer(building((i + j // 2) % 2 == 1), 1 + (i + j) % 2)  # Latin squares over these
    n = (1, 3)[(i + j + j // 2) % 2]
    _, report = run(world, robots(n, view=float(view), beams=beams), seed=2, max_time=7200.0)
    summary = report.summary
    assert summary.coverage >= 0.99
    assert summary.collisions == 0
    unreached = any(spot.why == "unreached" for spot in summary.left_out)
    assert summary.outcome.value == ("unreached" if unreached else "complete")
