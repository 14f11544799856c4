"""Looking for each other: (V211) by brute force, and what guesses mean on a plane."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.layers import plain
from vedette.domains.mapping.sightings import empty_counts
from vedette.errors import InputError
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.maps import FREE, UNKNOWN, GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.frames.rendezvous import MORE, Guess, chances, guessed, worth_more
from vedette.missions.explore.options import ExploreOptions

FRAME = GridFrame(0.1, 80, 160, -8.0, -4.0)


def belief() -> MapBelief:
    """Two components: what one knows about (-6, 0), and the other about (5, 0)."""
    classes = np.full(FRAME.shape, UNKNOWN, np.uint8)
    classes[30:50, 10:30] = FREE  # x -7 to -5, y -1 to 1
    classes[20:60, 120:140] = FREE  # x 4 to 6, y -2 to 2
    about = {"reach": 1.0, "extent": 2.5, "hidden": 0.0, "layers": plain(), "counts": empty_counts()}
    return freeze(classes, FRAME, **about)  # type: ignore[arg-type]


def worth(of: MapBelief, sets: list[set[int]], team: tuple[int, ...]) -> float:
    """What some strategies that see whole planning cells are worth together, by the definition."""
    seen = (
        np.array(sorted(set().union(*(sets[i] for i in team))), np.uint32) if team else np.empty(0, np.uint32)
    )
    return float(of.weights.of(seen).sum(dtype=np.float64))


def test_the_term_is_a_coverage_of_expected_overlap_monotone_and_submodular() -> None:
    rng, plane = np.random.default_rng(2), belief()
    q = chances(plane, [Guess((3.0, -3.0, 7.0, 3.0), Transform(-8000, 0, 0), 0.4)])
    more = worth_more(plane, q)
    cells = plane.planning_cells(np.flatnonzero(plane.unknown >= 0).astype(np.uint32))
    sets = [set(rng.choice(cells, 400).tolist()) for _ in range(4)]
    chance = dict(zip(cells.tolist(), q.ravel().tolist(), strict=True))
    for k in range(5):
        for team in combinations(range(4), k):
            seen = sorted(set().union(*(sets[i] for i in team))) if team else []
            overlap = sum(chance[c] * float(plane.weights.of(np.array([c], np.uint32))[0]) for c in seen)
            assert worth(more, sets, team) == pytest.approx(
                worth(plane, sets, team) + MORE * overlap, rel=1e-4
            )
            for i in set(range(4)) - set(team):
                gain = worth(more, sets, (*team, i)) - worth(more, sets, team)
                assert gain >= 0.0
                for j in set(range(4)) - {i, *team}:
                    assert worth(more, sets, (*team, j, i)) - worth(more, sets, (*team, j)) <= gain + 1e-6


def test_only_ground_that_the_guess_lays_what_another_knows_on_is_worth_more() -> None:
    plane = belief()
    there = Transform(-9000, 0, 0)  # from x 4 to 6 to x -5 to -3
    more = worth_more(plane, chances(plane, [Guess((3.0, -3.0, 7.0, 3.0), there, 0.5)]))
    rows, cols = plane.unknown.shape
    middles = plane.planning.centres(
        plane.planning_cells(np.arange(rows * cols, dtype=np.uint32)).astype(np.int64)
    )
    ratio = np.divide(
        more.weights.window,
        plane.weights.window,
        where=plane.weights.window > 0.0,
        out=np.ones_like(plane.weights.window),
    ).ravel()
    x, y = middles.T
    inside = (x > -4.9) & (x < -3.1) & (abs(y) < 1.9)
    outside = (x < -5.3) | (x > -2.7) | (abs(y) > 2.3)
    assert np.allclose(ratio[inside], 1.0 + MORE * 0.5, atol=1e-6)
    assert np.allclose(ratio[outside], 1.0, atol=1e-6)


def test_two_guesses_of_one_place_are_independent_of_each_other() -> None:
    plane = belief()
    guess = Guess((3.0, -3.0, 7.0, 3.0), Transform(-9000, 0, 0), 0.5)
    assert chances(plane, [guess, guess]).max() == pytest.approx(0.75)
    assert chances(plane, []).max() == 0.0


def test_a_guess_between_components_counts_both_ways_and_one_within_a_component_does_not() -> None:
    keys = [(0, 1), (1, 1), (2, 1)]
    plane = {keys[0]: IDENTITY, keys[1]: Transform(30_000, 0, 0), keys[2]: Transform(100, 0, 0)}
    near, far = (-5.0, -5.0, 5.0, 5.0), (25.0, -5.0, 35.0, 5.0)
    parts = {keys[0]: near, keys[1]: far, keys[2]: near}
    edges = [
        FrameEdge(keys[0], keys[1], Transform(2000, 0, 0), 40, EdgeKind.GUESS),
        FrameEdge(keys[0], keys[2], Transform(9000, 0, 0), 40, EdgeKind.GUESS),
        FrameEdge(keys[0], (7, 1), Transform(9000, 0, 0), 40, EdgeKind.GUESS),
    ]
    one, other = guessed(edges, plane, parts)
    assert (one.ground, one.there.place(30.0, 1.0)) == (far, (2.0, 1.0))
    assert (other.ground, other.there.place(2.0, 1.0)) == (near, (30.0, 1.0))
    assert one.chance == other.chance == 0.4


def test_a_rendezvous_in_a_frame_that_all_share_is_refused_not_ignored() -> None:
    ExploreOptions(frames="unknown", rendezvous=True).check()
    with pytest.raises(InputError, match="rendezvous looks for robots of unknown frames; add frames unknown"):
        ExploreOptions(rendezvous=True).check()
