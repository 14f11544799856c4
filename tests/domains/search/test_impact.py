"""Impacts of searching: rounded once, exact in sum, and small and checked on the wire."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.search_scenes import OBJECTIVE, frozen, random_impact, team
from vedette.domains.search.impact import NOTHING, Impact, SearchImpactCodec, quantise
from vedette.domains.search.paths import impact_of, shared_paths

CELLS, LAYERS = 700, 5


def impact_from(rng: np.random.Generator, share: float) -> Impact:
    keys = np.flatnonzero(rng.random(CELLS * LAYERS) < share).astype(np.uint32)
    return Impact(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.001, 0.05, 1.0]))
def test_an_impact_survives_the_wire_within_its_bound(seed: int, share: float) -> None:
    codec = SearchImpactCodec(CELLS, LAYERS)
    impact = impact_from(np.random.default_rng(seed), share)
    data = codec.encode(Impact(*impact.sparse))  # which nobody holds: it has to be read
    assert codec.decode(data) == impact
    assert len(data) <= codec.bound


def test_what_is_not_an_impact_over_this_area_is_refused() -> None:
    rng = np.random.default_rng(0)
    codec = SearchImpactCodec(CELLS, LAYERS)
    data = codec.encode(impact_from(rng, 0.2))
    for broken in (b"", b"\x00", data[:-4], data + b"x", bytes(rng.bytes(50))):
        with pytest.raises(ValueError, match="impact"):
            codec.decode(broken)
    with pytest.raises(ValueError, match="impact"):
        SearchImpactCodec(CELLS // 2, LAYERS).decode(data)
    empty_entry = Impact(np.array([3], np.uint32), np.array([0], np.uint8))
    with pytest.raises(ValueError, match="empty"):
        codec.decode(codec.encode(Impact(*empty_entry.sparse)))


@given(st.lists(st.floats(0, 1), min_size=1))
def test_rounding_costs_at_most_a_32nd_of_a_nat(chances: list[float]) -> None:
    probability = np.array(chances)
    levels = quantise(probability)
    certain = probability >= 1 - np.exp(-255.5 / 16)
    assert (levels[certain] == 255).all()
    exact = -np.log1p(-probability[~certain])
    assert np.abs(levels[~certain] / 16 - exact).max(initial=0.0) <= 1 / 32 + 1e-12


def test_combining_in_any_grouping_gives_the_same_bits_even_where_it_saturates() -> None:
    rng = np.random.default_rng(1)
    a, b, c = (impact_from(rng, 0.5) for _ in range(3))
    combine = OBJECTIVE.combine
    assert combine(combine(a, b), c) == combine(a, combine(c, b))


def test_impacts_that_begin_alike_share_looks_and_are_recovered() -> None:
    belief = frozen()
    platform = team(belief, size=1)[0]
    assert platform.options is not None
    impacts = [platform.impact(belief, flight) for flight in platform.options.flights]
    paths, ends = shared_paths(impacts, belief.layers)
    alone = [shared_paths([impact], belief.layers)[0] for impact in impacts]
    assert len(paths.parents) < 0.8 * sum(len(path.parents) for path in alone)
    for impact, end in zip(impacts, ends, strict=True):
        assert impact_of(paths, int(end), belief.layers) == impact


def test_a_message_costs_little_more_than_its_footprint() -> None:
    belief = frozen()
    platform = team(belief, size=1)[0]
    impact = platform.impact(belief, platform.reply(belief, NOTHING, platform.start))
    data = SearchImpactCodec(belief.frame.size, belief.layers).encode(impact)
    assert len(data) < len(impact.keys)
    scattered = random_impact(belief, np.random.default_rng(2))
    assert len(SearchImpactCodec(belief.frame.size, belief.layers).encode(scattered)) < 3 * len(
        scattered.keys
    )
