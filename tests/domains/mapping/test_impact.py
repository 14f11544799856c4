"""Impacts as numbers and as bytes: rounding, the codec, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.domains.mapping.impact import MIN_SHARE, NOTHING, Impact, MapImpactCodec, final_miss, quantise
from vedette.kernels.coverage import LAYERS
from vedette.kernels.reference import coverage as reference

seeds = st.integers(0, 2**32 - 1)


def random_impact(rng: np.random.Generator, cells: int) -> Impact:
    keys = np.flatnonzero(rng.random(cells * LAYERS) < rng.choice([0.0, 0.003, 0.1, 1.0]))
    return Impact(keys.astype(np.uint32), rng.integers(1, 256, len(keys)).astype(np.uint8))


@settings(deadline=None, max_examples=60)
@given(seeds, st.sampled_from([1, 2, 30, 254, 255, 256, 257, 3000]))
def test_the_codec_gives_back_any_impact_within_its_bound(seed: int, cells: int) -> None:
    codec, impact = MapImpactCodec(cells), random_impact(np.random.default_rng(seed), cells)
    payload = codec.encode(Impact(*impact.sparse))  # which nobody holds: it has to be read
    assert len(payload) <= codec.bound
    again = codec.decode(payload)
    assert again == impact
    assert again.keys.dtype == np.uint32
    assert again.misses.dtype == np.uint8


def test_the_fullest_and_the_emptiest_impact_travel() -> None:
    codec = MapImpactCodec(2000)
    rng = np.random.default_rng(0)
    full = Impact(
        np.arange(2000 * LAYERS, dtype=np.uint32), rng.integers(1, 256, 2000 * LAYERS).astype(np.uint8)
    )
    far = Impact(np.array([1999 * LAYERS + 15], np.uint32), np.array([255], np.uint8))
    for impact in (full, far, NOTHING):
        assert codec.decode(codec.encode(Impact(*impact.sparse))) == impact
        assert len(codec.encode(impact)) <= codec.bound


def check_decoded(codec: MapImpactCodec, cells: int, payload: bytes) -> None:
    """Decoding gives a sound impact or ValueError, nothing else."""
    try:
        impact = codec.decode(payload)
    except ValueError:
        return
    assert np.all(np.diff(impact.keys.astype(np.int64)) > 0)
    assert np.all(impact.keys < cells * LAYERS)
    assert np.all(impact.misses > 0)
    assert len(impact.keys) == len(impact.misses)


@settings(deadline=None, max_examples=150)
@given(seeds, st.binary(max_size=40), st.integers(1, 600))
def test_malformed_bytes_are_value_errors_or_sound_impacts(seed: int, junk: bytes, cells: int) -> None:
    rng, codec = np.random.default_rng(seed), MapImpactCodec(cells)
    payload = bytearray(codec.encode(random_impact(rng, cells)))
    for at in rng.integers(0, len(payload), 2):
        payload[at] ^= int(rng.integers(1, 256))
    cut = bytes(payload[: rng.integers(len(payload))])
    for attempt in (bytes(payload), cut, junk, bytes(payload) + junk, b"\x03\0\0\0" + junk):
        check_decoded(codec, cells, attempt)


ONLY = 13  # in a table: the symbol that is next is the only one
ONE = MapImpactCodec(10).encode(Impact(np.array([3 * LAYERS], np.uint32), np.array([9], np.uint8)))


def packed(runs: int, *numbers: tuple[int, int]) -> bytes:
    """Return so many runs' head, and numbers of so many bits each, the lowest bit first."""
    total, width = runs, 32
    for number, bits in numbers:
        total, width = total | number << width, width + bits
    return total.to_bytes(-(-width // 8), "little")


def absent(symbols: int) -> tuple[tuple[int, int], ...]:
    """Return what a table says of one to 16 symbols that do not occur."""
    return ((0, 4), (symbols - 1, 4))


NONE = ((ONLY, 4),)  # of gaps, or of places beside the first
NINE = (*absent(9), (ONLY, 4))  # of log-misses


@pytest.mark.parametrize(
    ("payload", "fault"),
    [
        (b"", "cut short"),
        (ONE[:-1], "cut short"),
        (ONE + b"x", "cut short or too large"),
        (b"\xff" * 20, "no code"),
        (packed(1, *([(0, 4), (15, 4)] * 9)), "no code"),
        (packed(1, (1, 4), (2, 4), (1, 4), *NONE, *NINE), "no code"),
        (packed(2**32 - 1, *NONE, *NONE, *NINE), "outside the map"),
        (packed(1, *absent(9), (ONLY, 4), *NONE, *NINE, (70, 8)), "outside the map"),
        (packed(1, *NONE, *absent(9), (ONLY, 4), *NINE, (70, 8)), "outside the map"),
        (packed(1, *NONE, *NONE, (ONLY, 4)), "empty entry"),
    ],
)
def test_a_malformed_impact_is_refused_with_its_fault(payload: bytes, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        MapImpactCodec(10).decode(payload)


def test_a_share_is_rounded_by_less_than_a_twelfth() -> None:
    share = np.linspace(0, 1, 4001).astype(np.float32)
    seen = 1.0 - np.exp(quantise(share) / -16.0)
    assert np.abs(seen - share).max() < 1 / 12
    assert np.all(np.diff(seen) >= 0)
    assert quantise(np.array([0.0], np.float32))[0] == 0


def test_the_smallest_share_that_is_kept_does_not_round_to_an_empty_entry() -> None:
    assert quantise(np.array([MIN_SHARE], np.float32))[0] > 0


def test_rounding_a_log_miss_costs_at_most_a_32nd_of_a_nat_each() -> None:
    eighths = np.arange(8) / 8
    ratio = np.exp(quantise(eighths.astype(np.float32)) / -16.0) / (1.0 - eighths)
    assert np.abs(np.log(ratio)).max() <= 1 / 32


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_final_miss_is_the_dense_miss_probability_of_the_last_layer(seed: int) -> None:
    impact = random_impact(np.random.default_rng(seed), 50)
    np.testing.assert_allclose(
        final_miss(impact, 50), reference.missed(impact.sparse, 50)[:, -1], rtol=1e-5, atol=1e-30
    )
