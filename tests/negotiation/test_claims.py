"""Claims: no more than so many robots' sensors can make is taken in, and what honest robots say always is."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import reduce
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support import mapping_scenes, search_scenes, tracking_scenes
from tests.support.agent_team import FloatCodec
from tests.support.search_missions import blind, case
from tests.support.small_missions import robots, run, small_maze
from tests.support.track_scenes import flown, scenario
from vedette import Coverage, InputError
from vedette.domains.mapping import impact as mapping
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import STAY
from vedette.domains.mapping.views import MOST_STOPS
from vedette.domains.search import impact as search
from vedette.domains.search import worth
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.tracking import impact as tracking
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import SparseMisses
from vedette.maps import GridFrame
from vedette.maps.swept import most_cells_swept
from vedette.negotiation import Chooser, Claims, JacobiNode, TokenNode, decode
from vedette.negotiation.messages import Gather, RoundOutcome, Stop, Tally, Token, Up
from vedette.team import Most, PlatformSpec

SEEDS = st.integers(0, 100_000)
Seen = list[tuple[Any, Any]]  # beliefs and impacts


# -- honest robots are never refused ---------------------------------------------------------------------


@settings(deadline=None, max_examples=40)
@given(seed=SEEDS, radius=st.floats(0.1, 8.0), side=st.floats(0.2, 2.0))
def test_no_disc_on_its_way_touches_more_cells(seed: int, radius: float, side: float) -> None:
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(30, 2)) * rng.uniform(0.0, 1.5)
    points = np.vstack([rng.uniform(0, 3, (1, 2)), steps]).cumsum(axis=0)
    way = float(np.hypot(*steps.T).sum())
    low = np.floor((points.min(axis=0) - radius) / side) - 1
    cells = np.ceil((points.max(axis=0) + radius) / side - low).astype(int) + 1
    corner = (low + np.moveaxis(np.indices(cells), 0, -1)) * side  # of each cell, lower left
    away = np.maximum(np.maximum(corner[..., None, :] - points, points - corner[..., None, :] - side), 0.0)
    touched = (np.hypot(away[..., 0], away[..., 1]) <= radius).any(axis=-1)
    assert touched.sum() <= most_cells_swept(radius, way, side)


@settings(deadline=None, max_examples=25)
@given(seed=SEEDS)
def test_no_tour_of_any_robots_claims_too_much(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = mapping_scenes.frozen()
    specs, tours = [], []
    for i in range(rng.integers(1, 4)):
        spec = PlatformSpec(name=f"r{i}", range=rng.uniform(1.0, 6.0), speed=rng.uniform(0.1, 2.0))
        platform = MappingPlatform(spec, measured=str(rng.choice(["unknown", "distance", "beam"])))
        mapping_scenes.placed(platform, belief, *mapping_scenes.CORRIDOR[i % 2])
        assert platform.stops is not None
        order = rng.permutation(len(platform.stops))
        tours.append(platform.impact(belief, platform.tour(order) if len(order) else STAY))
        specs.append(spec)
    team = reduce(MappingObjective().combine, tours)
    side, edges = belief.planning.resolution, belief.layers.edges
    mapping.check_claim(team, len(specs), Most.of(specs), MOST_STOPS, side, edges)


@settings(deadline=None, max_examples=15)
@given(seed=SEEDS, tail=st.sampled_from([0.0, 1.0]))
def test_no_flight_of_any_vehicles_claims_too_much(seed: int, tail: float) -> None:
    rng = np.random.default_rng(seed)
    belief = search_scenes.frozen(search_scenes.MOVING, worth.plain(4, tail))
    team = search_scenes.team(belief)
    most = Most(max(p.detector.range for p in team), max(p.speed for p in team))
    frame, layers, horizon, dt = belief.frame, belief.layers, belief.horizon, belief.dt
    every = []
    for platform in team:
        assert platform.options is not None
        flights = platform.options.flights
        every.append(platform.impact(belief, flights[rng.integers(len(flights))]))
        search.check_claim(every[-1], 1, most, frame.resolution, layers, horizon, dt)
    together = reduce(search_scenes.OBJECTIVE.combine, every)
    search.check_claim(together, len(team), most, frame.resolution, layers, horizon, dt)


@settings(deadline=None, max_examples=40)
@given(seed=SEEDS)
def test_no_course_of_any_trackers_claims_too_much(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = tracking_scenes.random_tracks(rng)
    team = [tracking_scenes.random_platform(rng, belief) for _ in range(rng.integers(1, 4))]
    most = max(platform.sensor.most_evidence(100.0)[0] for platform in team)
    every = [
        platform.impact(belief, platform.courses[rng.integers(len(platform.courses))]) for platform in team
    ]
    tracking.check_claim(reduce(tracking.combine, every), len(team), most)


def recorded(monkeypatch: pytest.MonkeyPatch, kind: type[Any]) -> Seen:
    """Everything that robots with a kind of platform will say of themselves."""
    seen: Seen = []
    honest = kind.impact

    def impact(self: Any, belief: Any, strategy: Any) -> Any:
        seen.append((belief, honest(self, belief, strategy)))
        return seen[-1][1]

    monkeypatch.setattr(kind, "impact", impact)
    return seen


def test_whole_missions_say_nothing_that_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = recorded(monkeypatch, MappingPlatform)
    specs = robots(2)
    simulation, _ = run(small_maze(), specs)
    explorer = simulation.missions[0]
    explorer.most = Most.of(specs)
    for belief, impact in seen:
        explorer.admit(belief, impact, 1)
    assert len(seen) > 20
    seen = recorded(monkeypatch, TrackingPlatform)
    tracker = flown(scenario())[0].missions[0]
    for belief, impact in seen:
        tracker.admit(belief, impact, 1)
    assert len(seen) > 20
    seen = recorded(monkeypatch, SearchPlatform)
    searcher = blind(case()).missions[0]
    searcher.team = replace(searcher.team, most=Most(range=100.0, speed=30.0))
    for belief, impact in seen:
        searcher.admit(belief, impact, 1)
    assert len(seen) > 20


# -- liars are ----------------------------------------------------------------------------------------------


def everywhere(cells: int, layers: int, layer: int) -> SparseMisses:
    """All is seen for certain in a layer: p = 0."""
    keys = np.arange(cells, dtype=np.uint32) * np.uint32(layers) + np.uint32(layer)
    return SparseMisses(keys, np.full(cells, 255, np.uint8))


@pytest.mark.parametrize("layer", [0, 5, LAYERS - 1])
def test_a_robot_that_claims_the_whole_map_is_refused_until_its_team_could_see_it(layer: int) -> None:
    plan = GridFrame(0.2, 1000, 1000)
    edges = mapping_scenes.frozen().layers.edges
    lie, most = everywhere(plan.size, LAYERS, layer), Most(range=8.0, speed=0.5)
    each = math.pi * 8.4**2 * MOST_STOPS / 0.04  # cells
    if layer < LAYERS - 1:
        each = min(each, (math.pi * 8.4**2 + 2 * 8.4 * 0.5 * edges[layer]) / 0.04)
    enough = math.ceil(plan.size / each)
    if layer == LAYERS - 1:
        enough = math.ceil(plan.size * 255 / 64 / each)  # so sure only after four looks
    for count in (1, enough - 1):
        with pytest.raises(ValueError, match="impact claims"):
            mapping.check_claim(lie, count, most, MOST_STOPS, 0.2, edges)
    mapping.check_claim(lie, enough * (1 if layer == LAYERS - 1 else 4), most, MOST_STOPS, 0.2, edges)


def test_a_vehicle_that_claims_the_whole_sea_is_refused() -> None:
    belief = search_scenes.frozen(worths=worth.plain(4))
    most = Most(80.0, 30.0)
    shape = (belief.frame.resolution, belief.layers, belief.horizon, belief.dt)
    for layer in range(belief.layers):
        with pytest.raises(ValueError, match=r"impact (claims|promises)"):
            search.check_claim(everywhere(belief.frame.size, belief.layers, layer), 3, most, *shape)


def test_more_information_than_the_teams_best_sensors_have_is_refused() -> None:
    blocks = np.zeros((1, 3, 3))
    blocks[0, 1] = 8.0, 0.0, 1.0
    claim = tracking.impact_of(blocks)
    tracking.check_claim(claim, 2, 4.0)
    with pytest.raises(ValueError, match="claims 8 / m"):
        tracking.check_claim(claim, 1, 4.0)


def test_without_limits_a_mission_refuses_nothing() -> None:
    belief = mapping_scenes.frozen()
    lie = mapping.Impact(*everywhere(belief.planning.size, LAYERS, 0).sparse)
    mission = run(small_maze(), robots(1), max_time=1.0)[0].missions[0]
    mission.admit(belief, lie, 1)
    mission.most = Most(1.0, 0.1)
    with pytest.raises(ValueError, match="impact claims"):
        mission.admit(belief, lie, 1)


# -- in a round ---------------------------------------------------------------------------------------------


def claims() -> Claims[Any]:
    """One platform misses half of everything at best."""

    def admit(impact: Any, platforms: int) -> None:
        if (impact < 0.5**platforms).any():
            raise ValueError("too much")

    return Claims({1: 2, 2: 1}, admit)


@pytest.mark.parametrize("scheme", [TokenNode, JacobiNode])
def test_a_claim_too_large_is_refused_and_its_sender_can_be_cut(scheme: Any) -> None:
    node = scheme([1, 2], None, Chooser(Coverage(), np.ones(3), [np.full(3, 0.5)]), claims=claims())
    node.start()

    def report(miss: float, size: int) -> Any:
        mu = np.full(3, miss)
        return Gather(mu, size, 3.0, 0.0) if scheme is TokenNode else Up(mu, 3.0, 3.0, (0,))

    with pytest.raises(ValueError, match="too much"):
        node.receive(1, report(0.0, 2))
    with pytest.raises(ValueError, match="too much"):
        node.receive(2, report(0.25, 1))
    assert node.waiting_for == {1, 2}
    node.receive(1, report(0.25, 2))
    if scheme is TokenNode:
        with pytest.raises(InputError, match="2 speaks for 2 platforms, at most 1 behind it"):
            node.receive(2, report(0.5, 2))
    assert node.waiting_for == {2}
    assert node.cut(2)
    assert node.waiting_for == {1}


# -- what can be read is in range ---------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1e200])
def test_values_that_are_no_numbers_do_not_pass(wrong: float) -> None:
    tally = Tally(turns=1, quiet=0, value=1.0, slack=0.0, size=2, ceiling=1.0)
    bad: list[Any] = [
        Gather(None, 1, 0.0, wrong),
        Token(None, msgspec.structs.replace(tally, value=wrong)),
        Stop(RoundOutcome(wrong, None, 1, True)),
        Stop(RoundOutcome(1.0, wrong, 1, True)),
    ]
    if not wrong > 0.0:  # what is not known is infinite
        bad += [
            Gather(None, 1, wrong, 0.0),
            Token(None, msgspec.structs.replace(tally, slack=wrong)),
            Token(None, msgspec.structs.replace(tally, ceiling=wrong)),
            Up(None, wrong, 0.0, ()),
            Up(None, 0.0, wrong, ()),
        ]
    for message in bad:
        with pytest.raises(InputError, match="malformed"):
            decode(msgspec.msgpack.encode(message), FloatCodec())


def test_counts_that_no_round_reaches_do_not_pass() -> None:
    tally = Tally(turns=1, quiet=0, value=1.0, slack=0.0, size=2, ceiling=1.0)
    for field, count in (("turns", 2**60), ("turns", -1), ("quiet", 2**60), ("size", 0), ("size", 2**60)):
        message: Any = Token(None, msgspec.structs.replace(tally, **{field: count}))
        with pytest.raises(InputError, match="malformed"):
            decode(msgspec.msgpack.encode(message), FloatCodec())


@settings(deadline=None, max_examples=300)
@given(data=st.binary(max_size=64))
def test_any_bytes_are_a_message_or_an_input_error(data: bytes) -> None:
    with suppress(InputError):
        decode(data, FloatCodec())


@pytest.mark.parametrize("codec", [mapping.MapImpactCodec(2000), search.SearchImpactCodec(2000, 10)])
def test_what_claims_runs_without_end_is_refused_at_the_end_of_the_map(codec: Any) -> None:
    """2^32 - 1 runs that take no bits: of gap 0, of one place, of log-miss 9, each the only word."""
    data = (2**32 - 1 | (0xD | 0xD << 4 | 8 << 12 | 0xD << 16) << 32).to_bytes(7, "little")
    with pytest.raises(ValueError, match="impact has a cell outside the map"):
        codec.decode(data)
