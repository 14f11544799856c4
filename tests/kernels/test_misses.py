"""Sparse log-misses on the wire: the bytes are those that plain loops write, and what is read is checked."""

from __future__ import annotations

import zlib
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette import _kernels
from vedette.kernels.misses import MissesCodec, SparseMisses
from vedette.kernels.reference import misses as reference


def written_by_loops(impact: SparseMisses, cells: int, layers: int, runs: int) -> bytes:
    entries = zip(impact.keys.tolist(), impact.misses.tolist(), strict=True)
    places = sorted((key % layers * cells + key // layers, miss) for key, miss in entries)
    counts, gaps, last = [0] * runs, [], [0] * runs
    for place, _ in places:
        run, within = divmod(place, cells * layers // runs)
        gaps.append(within - last[run])
        counts[run], last[run] = counts[run] + 1, within
    numbers = [n.to_bytes(4, "little") for n in (*counts, *(gap for gap in gaps if gap >= 255))]
    small = bytes(min(gap, 255) for gap in gaps)
    return b"".join((*numbers[:runs], small, bytes(miss for _, miss in places), *numbers[runs:]))


@settings(deadline=None, max_examples=100)
@given(
    seed=st.integers(0, 2**32 - 1),
    cells=st.integers(1, 900),
    layers=st.integers(1, 40),
    share=st.sampled_from([0.0, 0.002, 0.05, 1.0]),
    by_layer=st.booleans(),
)
def test_an_impact_has_the_bytes_that_plain_loops_write_and_comes_back(
    seed: int, cells: int, layers: int, share: float, by_layer: bool
) -> None:
    rng = np.random.default_rng(seed)
    keys = np.flatnonzero(rng.random(cells * layers) < share).astype(np.uint32)
    impact = SparseMisses(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))
    runs = layers if by_layer else 1
    codec = MissesCodec(cells, layers, runs=runs, level=6)
    data = codec.encode(impact)
    assert zlib.decompress(data, wbits=-15) == written_by_loops(impact, cells, layers, runs)
    assert codec.decode(data) == impact
    assert len(data) <= codec.bound


def outcome(unpack: Callable[[], SparseMisses]) -> SparseMisses | str:
    try:
        return unpack()
    except ValueError as error:
        return str(error)


@settings(deadline=None, max_examples=300)
@given(
    seed=st.integers(0, 2**32 - 1),
    cells=st.integers(1, 300),
    layers=st.integers(1, 8),
    share=st.sampled_from([0.01, 0.3]),
    by_layer=st.booleans(),
)
def test_damaged_bytes_are_read_or_refused_as_their_twin_reads_or_refuses_them(
    seed: int, cells: int, layers: int, share: float, by_layer: bool
) -> None:
    rng = np.random.default_rng(seed)
    keys = np.flatnonzero(rng.random(cells * layers) < share).astype(np.uint32)
    impact = SparseMisses(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))
    grid = cells, layers, layers if by_layer else 1
    body = _kernels.pack_misses(*impact.sparse, *grid)
    assert body == reference.pack_misses(impact, *grid)
    for _ in range(8):
        damaged = bytearray(body)
        for at in rng.integers(0, len(damaged), rng.integers(0, 3)):
            damaged[at] = int(rng.choice([0, 1, 254, 255, damaged[at] ^ 1]))
        data = bytes(damaged[: rng.choice([len(damaged), rng.integers(len(damaged) + 1)])])
        read = outcome(lambda data=data: SparseMisses(*_kernels.unpack_misses(data, *grid)))
        assert read == outcome(lambda data=data: reference.unpack_misses(data, *grid))


def test_a_key_outside_the_grid_is_not_packed() -> None:
    with pytest.raises(ValueError, match="outside the map"):
        _kernels.pack_misses(np.array([12], np.uint32), np.array([9], np.uint8), 4, 3, 3)


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
