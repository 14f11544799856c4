"""Tiles of which equal ones are held once, by whoever in a process holds them."""

from __future__ import annotations

import gc
import tracemalloc

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.fusion_network import COUNTS, Network, ring
from vedette.fusion import ReplicatedEvidence, shared
from vedette.fusion.shared import SharedTiles
from vedette.kernels.tiles import CELLS

TILES = 40


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_what_is_written_is_what_an_array_would_hold_whoever_else_holds_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    holders = [SharedTiles(np.uint8) for _ in range(3)]
    plain = np.zeros((3, TILES, CELLS), np.uint8)
    kinds = rng.integers(0, 5, (4, CELLS)).astype(np.uint8)  # so that many tiles are alike
    for _ in range(12):
        who, tiles = int(rng.integers(3)), np.flatnonzero(rng.random(TILES) < 0.2)
        cells = kinds[rng.integers(0, 4, len(tiles))]
        holders[who].write(tiles, cells)
        plain[who, tiles] = cells
        cells[:] = 9  # the caller's own from now on
        for holder, expected in zip(holders, plain, strict=True):
            np.testing.assert_array_equal(holder.read(np.arange(TILES)), expected)
    for holder, expected in zip(holders, plain, strict=True):
        written = np.flatnonzero(holder.holds(np.arange(TILES)))
        np.testing.assert_array_equal(holder.held, written)
        assert set(np.flatnonzero(expected.any(axis=1)).tolist()) <= set(written.tolist())


def test_cells_that_are_read_are_the_readers_own() -> None:
    one, other = SharedTiles(np.uint16), SharedTiles(np.uint16)
    cells, tile = np.ones((1, CELLS), np.uint16), np.array([3])
    for holder in (one, other):
        holder.write(tile, cells)
    one.read(tile)[:] = 7
    assert (other.read(tile) == 1).all()


def test_many_who_hold_the_same_take_hardly_more_memory_than_one() -> None:
    cells = np.random.default_rng(0).integers(0, 5, (200, CELLS)).astype(np.uint8)
    tracemalloc.start()
    first = SharedTiles(np.uint8)
    first.write(np.arange(200), cells)
    alone = tracemalloc.get_traced_memory()[0]
    others = [SharedTiles(np.uint8) for _ in range(20)]
    for holder in others:
        holder.write(np.arange(200), cells)
    together = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert alone >= 200 * CELLS
    assert together < 1.0 * alone + 20 * 200 * 120  # a number and a reference each


def test_what_nobody_holds_any_more_is_gone() -> None:
    gc.collect()
    before = len(shared._SHARED)
    holder = SharedTiles(np.uint8)
    holder.write(np.arange(50), np.random.default_rng(1).integers(0, 5, (50, CELLS)).astype(np.uint8))
    assert len(shared._SHARED) == before + 50
    holder.write(np.arange(50), np.zeros((50, CELLS), np.uint8))
    assert len(shared._SHARED) <= before + 1
    del holder
    gc.collect()
    assert len(shared._SHARED) == before


def test_a_team_on_good_links_holds_everybodys_evidence_once() -> None:
    rng = np.random.default_rng(3)
    net = Network(lambda i: ReplicatedEvidence(i, 1 + i, (200, 300), COUNTS), 6, ring(6), rng)
    for i in net.robots:
        own = np.zeros((200, 300), np.int8)
        own[10 * i : 10 * i + 60, 20 * i : 20 * i + 90] = rng.integers(-12, 13, (60, 90))
        net.own[i] = np.zeros((200, 300), np.int8)
        net.observe(i, own)
    net.run(20)
    copies = [list(each._contributors.copies.items()) for each in net.robots.values()]
    tiles = {id(block) for held in copies for _, copy in held for block in copy.values._tiles.values()}
    distinct = {
        block.tobytes() for held in copies for _, copy in held for block in copy.values._tiles.values()
    }
    assert len(tiles) == len(distinct)
    assert sum(len(copy.values.held) for held in copies for _, copy in held) == 6 * len(distinct)
