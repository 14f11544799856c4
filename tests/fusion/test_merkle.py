"""Merkle roots against a tree that is built anew each time."""

from __future__ import annotations

import hashlib

import numpy as np

from vedette.fusion.merkle import ROOT_BYTES, Merkle


def rebuilt(leaves: dict[int, bytes], count: int) -> bytes:
    """The definition, level by level, over all leaves."""

    def digest(data: bytes) -> bytes:
        return hashlib.blake2b(data, digest_size=ROOT_BYTES).digest() if data else b""

    size = 1
    while size < count:
        size *= 16
    level = [digest(leaves.get(i, b"")) for i in range(size)]
    while len(level) > 1:
        blank = bytes(ROOT_BYTES)
        groups = [level[i : i + 16] for i in range(0, len(level), 16)]
        level = [digest(b"".join(each or blank for each in group)) if any(group) else b"" for group in groups]
    return level[0]


def test_a_root_kept_up_by_changes_is_that_of_the_whole_tree() -> None:
    rng = np.random.default_rng(1)
    for count in (1, 2, 3, 16, 17, 64, 300):
        tree, leaves = Merkle(count), dict[int, bytes]()
        for _ in range(30):
            some = rng.choice(count, min(3, count), replace=False).tolist()
            changes = {i: rng.bytes(4) if rng.random() < 0.7 else b"" for i in some}
            root, nodes = tree.with_leaves(changes)
            leaves |= changes
            assert root == rebuilt(leaves, count)
            tree.put(nodes)


def test_asking_for_a_root_changes_nothing() -> None:
    tree = Merkle(8)
    tree.put(tree.with_leaves({1: b"a"})[1])
    before, _ = tree.with_leaves({})
    assert tree.with_leaves({1: b"b"})[0] != tree.with_leaves({1: b"c"})[0]
    assert tree.with_leaves({1: b"a"})[0] == tree.with_leaves({5: b""})[0]
    assert tree.with_leaves({})[0] == before


def test_no_leaf_can_be_changed_moved_or_left_out_under_a_root() -> None:
    leaves = {i: bytes([i]) for i in range(6)}
    root, _ = Merkle(8).with_leaves(leaves)
    for i in leaves:
        assert Merkle(8).with_leaves(leaves | {i: b"x"})[0] != root
        assert Merkle(8).with_leaves(leaves | {i: b"", 7: leaves[i]})[0] != root
        assert Merkle(8).with_leaves({k: v for k, v in leaves.items() if k != i})[0] != root
