"""What search teams bring becomes probability: rings, searched tracks, no-go areas, against points drawn."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from vedette.domains.search.clues import SearchedTrack, disc_share, missed_by, rings, without
from vedette.errors import InputError, InputWarning
from vedette.maps import GridFrame

FRAME = GridFrame(20.0, 60, 80, 500_000.0, 5_000_000.0)  # 1600 m by 1200 m, in UTM
CENTRE = (500_790.0, 5_000_610.0)
POINTS = 400_000


def drawn(rng: np.random.Generator) -> NDArray[np.float64]:
    """Places anywhere in the area alike."""
    return np.asarray(rng.uniform((500_000, 5_000_000), (501_600, 5_001_200), (POINTS, 2)))


@pytest.mark.parametrize("distances", [(100.0, 300.0, 500.0), (3.0, 7.0, 580.0), (9.0,)])
def test_as_many_are_within_each_ring_as_the_statistics_say(distances: tuple[float, ...]) -> None:
    within = np.linspace(0.3, 0.9, len(distances))
    mass = rings(FRAME, CENTRE, distances, within.tolist())
    assert mass.sum() == pytest.approx(1.0)
    for distance, share in zip(distances, within, strict=True):
        told = (mass * (disc_share(FRAME, CENTRE, distance) > 0)).sum()
        assert told >= share / within[-1] - 0.01  # whole cells at the edge hold more
        inside = np.hypot(*(FRAME.centres(np.arange(FRAME.size)) - CENTRE).T) < distance - 15.0
        assert mass.ravel()[inside].sum() <= share / within[-1] + 0.01


@pytest.mark.parametrize("radius", [1.0, 12.0, 250.0, 900.0])
def test_a_disc_covers_of_each_cell_what_points_say(radius: float) -> None:
    share = disc_share(FRAME, CENTRE, radius)
    places = np.random.default_rng(0).uniform(-10.0, 10.0, (4000, 2))
    edge = np.flatnonzero((share > 0.0).ravel() & (share < 1.0).ravel())
    for cell in np.random.default_rng(1).choice(edge, min(len(edge), 12), replace=False):
        near = FRAME.centres(np.array([cell]))[0] + places - CENTRE
        assert share.ravel()[cell] == pytest.approx((np.hypot(*near.T) <= radius).mean(), abs=0.03)
    if radius < 500.0:
        assert share.sum() * 400.0 == pytest.approx(np.pi * radius**2, rel=0.02)


def test_rings_beyond_the_area_are_told_and_keep_their_densities() -> None:
    with pytest.warns(InputWarning, match=r"rings: 50% of it is outside the area"):
        mass = rings(FRAME, (500_000.0, 5_000_600.0), (200.0, 400.0), (0.5, 0.8))
    inner, outer = mass[30, 2], mass[30, 15]
    assert inner / outer == pytest.approx((0.5 / 200**2) / (0.3 / (400**2 - 200**2)))


@pytest.mark.parametrize(("width", "detection"), [(6.0, 0.5), (45.0, 0.8), (300.0, 1.0)])
def test_a_searched_track_leaves_what_points_drawn_beside_it_say(width: float, detection: float) -> None:
    path = np.array([(500_205.0, 5_000_310.0), (500_700.0, 5_000_633.0), (500_710.0, 5_000_200.0)])
    missed = missed_by(FRAME, [SearchedTrack(path, width, detection)])
    assert missed.min() >= 1.0 - detection - 1e-12
    assert missed[-1, -1] == 1.0
    places = drawn(np.random.default_rng(0))
    steps = np.concatenate([np.linspace(a, b, 1500) for a, b in pairwise(path)])
    seen = cKDTree(steps).query(places)[0] <= width / 2.0
    assert (1.0 - missed).mean() == pytest.approx(detection * seen.mean(), rel=0.05)


def test_two_tracks_at_one_place_miss_what_both_miss_and_two_at_two_places_do_not() -> None:
    def along(y: float) -> SearchedTrack:
        return SearchedTrack(np.array([(500_100.0, y), (500_500.0, y)]), 10.0, 1.0)

    once = missed_by(FRAME, [along(5_000_105.0)])[5, 15]
    again = missed_by(FRAME, [along(5_000_105.0), along(5_000_105.0)])[5, 15]
    beside = missed_by(FRAME, [along(5_000_105.0), along(5_000_115.0)])[5, 15]
    assert (once, again, beside) == (pytest.approx(0.5), pytest.approx(0.5), pytest.approx(0.0))


def test_no_go_areas_leave_the_share_of_each_cell_that_is_in_none_of_them() -> None:
    lake = [(500_100, 5_000_100), (500_300, 5_000_100), (500_300, 5_000_210), (500_100, 5_000_210)]
    left = without(FRAME, [lake])
    assert left[5:10, 5:15].max() == 0.0
    assert left[10, 5:15].tolist() == [0.5] * 10
    assert left.sum() == FRAME.size - 55.0


@pytest.mark.parametrize(
    ("distances", "within", "words"),
    [
        ([], [], "distances must rise"),
        ([300, 200], [0.2, 0.4], r"distances must rise from above 0; got \[300.0, 200.0\]"),
        ([0, 200], [0.2, 0.4], "distances must rise"),
        ([100, 200], [0.4, 0.4], "within must rise"),
        ([100, 200], [0.4], "a share for each of 2 distances; got 1"),
        ([100, 200], [0.4, 1.4], "shares of 1; got 1.4"),
    ],
)
def test_rings_that_make_no_sense_are_refused(
    distances: list[float], within: list[float], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        rings(FRAME, CENTRE, distances, within)


def test_tracks_and_areas_beside_the_area_are_refused_by_number() -> None:
    away = SearchedTrack(np.array([(0.0, 0.0), (100.0, 0.0)]), 50.0, 0.5)
    near = SearchedTrack(np.array([CENTRE, CENTRE]), 50.0, 0.5)
    with pytest.raises(InputError, match=r"searched\[1\]: nothing of the track"):
        missed_by(FRAME, [near, away])
    with pytest.raises(InputError, match=r"no_go\[0\]: nothing of the polygon"):
        without(FRAME, [[(0, 0), (9, 0), (9, 9)]])
