"""Sparse log-misses on the wire: the bytes are those that plain loops write, and what is read is checked."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette import _kernels
from vedette.kernels.misses import MissesCodec, SparseMisses
from vedette.kernels.reference import misses as reference


def drawn(seed: int, cells: int, layers: int, share: float, levels: int) -> SparseMisses:
    """Return an impact in patches: runs, and few log-misses if so many levels are few."""
    rng = np.random.default_rng(seed)
    keys = np.flatnonzero(rng.random(cells * layers) < share).astype(np.uint32)
    return SparseMisses(keys, rng.choice(rng.integers(1, 256, levels), len(keys)).astype(np.uint8))


def copied(impact: SparseMisses) -> SparseMisses:
    """Return an impact that nobody else holds: who holds what was written need not read it."""
    return SparseMisses(*impact.sparse)


def test_what_this_process_has_written_is_read_once_as_long_as_somebody_holds_it() -> None:
    impact, codec = drawn(0, 30, 3, 0.5, 9), MissesCodec(30, 3)
    data = codec.encode(impact)
    assert codec.decode(data) is impact
    assert MissesCodec(15, 6).decode(data) is not impact
    copy = copied(impact)
    del impact
    assert codec.decode(data) == copy


IMPACTS = {
    "seed": st.integers(0, 2**32 - 1),
    "cells": st.integers(1, 300),
    "layers": st.integers(1, 40),
    "share": st.sampled_from([0.0, 0.002, 0.05, 0.7, 1.0]),
    "levels": st.sampled_from([1, 2, 9, 255]),
}


@settings(deadline=None, max_examples=200)
@given(**IMPACTS)
def test_an_impact_has_its_twins_bytes_and_comes_back(
    seed: int, cells: int, layers: int, share: float, levels: int
) -> None:
    impact = drawn(seed, cells, layers, share, levels)
    codec = MissesCodec(cells, layers)
    data = codec.encode(copied(impact))
    assert data == reference.pack_misses(impact, cells, layers)
    assert codec.decode(data) == impact
    assert len(data) <= codec.bound


def outcome(unpack: Callable[[], SparseMisses]) -> SparseMisses | str:
    try:
        return unpack()
    except ValueError as error:
        return str(error)


@settings(deadline=None, max_examples=200)
@given(**IMPACTS)
def test_damaged_bytes_are_read_or_refused_as_their_twin_reads_or_refuses_them(
    seed: int, cells: int, layers: int, share: float, levels: int
) -> None:
    rng = np.random.default_rng(seed)
    body = _kernels.pack_misses(*drawn(seed, cells, layers, share, levels).sparse, cells, layers)
    limits = cells, layers, 3000
    for _ in range(8):
        damaged = bytearray(body)
        for at in rng.integers(0, len(damaged), rng.integers(0, 3)):
            damaged[at] = int(rng.choice([0, 1, 254, 255, damaged[at] ^ 1]))
        data = bytes(damaged[: rng.choice([len(damaged), rng.integers(len(damaged) + 1)])])
        read = outcome(lambda data=data: SparseMisses(*_kernels.unpack_misses(data, *limits)))
        assert read == outcome(lambda data=data: reference.unpack_misses(data, *limits))


@pytest.mark.parametrize("seed", range(20))
def test_codes_are_huffmans_where_no_word_is_too_long(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = Counter(dict(enumerate((rng.pareto(1.0, rng.integers(2, 200)) + 1.0).astype(int).tolist())))
    lengths = reference.code_lengths(counts)
    assert sum(2.0**-length for length in lengths.values()) == 1.0
    assert max(lengths.values()) <= reference.LONGEST
    least, heap = 0, sorted(counts.values())
    while len(heap) > 1:
        least += (joined := heapq.heappop(heap) + heapq.heappop(heap))
        heapq.heappush(heap, joined)
    bits = sum(lengths[symbol] * count for symbol, count in counts.items())
    assert bits == least or (
        max(reference.depths(counts).values()) > reference.LONGEST and bits < 1.05 * least
    )


def test_words_are_cut_to_twelve_bits_where_counts_grow_like_fibonaccis() -> None:
    rng, counts = np.random.default_rng(0), [1, 1]
    while len(counts) < 20:
        counts.append(counts[-1] + counts[-2])
    misses = rng.permutation(np.repeat(np.arange(1, 21), counts)).astype(np.uint8)
    impact = SparseMisses(np.arange(len(misses), dtype=np.uint32), misses)
    data = MissesCodec(len(misses), 1).encode(copied(impact))
    assert data == reference.pack_misses(impact, len(misses), 1)
    assert MissesCodec(len(misses), 1).decode(data) == impact


def test_a_key_outside_the_grid_is_not_packed() -> None:
    with pytest.raises(ValueError, match="outside the map"):
        _kernels.pack_misses(np.array([12], np.uint32), np.array([9], np.uint8), 4, 3)


@pytest.mark.parametrize("seed", range(20))
def test_cells_within_boxes_are_those_found_one_by_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, cols, layers = 9, 13, 3
    keys = np.flatnonzero(rng.random(rows * cols * layers) < 0.3).astype(np.uint32)
    impact = SparseMisses(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))
    corners = np.sort(rng.integers(-3, 16, (2, 2, 2)), axis=1).tolist()
    boxes = [((low[0], low[1]), (high[0], high[1])) for low, high in corners]
    kept = [
        key
        for key in keys.tolist()
        for row, col in [divmod(key // layers, cols)]
        if any(low[0] <= row <= high[0] and low[1] <= col <= high[1] for low, high in boxes)
    ]
    clipped = impact.within(layers, cols, boxes)
    assert clipped.keys.tolist() == kept
    assert clipped.misses.tolist() == impact.misses[np.isin(keys, kept)].tolist()
