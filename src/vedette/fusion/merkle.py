"""A Merkle tree over numbered leaves, most of them empty: one short root that stands for all of them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

ROOT_BYTES = 16
WIDTH = 16  # of a node: each level costs a hash, whatever its length
_EMPTY = b""  # the hash of a leaf that says nothing, and of a node above nothing else

Nodes = dict[tuple[int, int], bytes]  # by level, 0 the leaves', and number


class Merkle:
    """``node = hash(its WIDTH children)`` of a tree over ``WIDTH**depth`` leaves; equal roots, equal leaves.

    Only what is not empty is held, and a changed leaf costs the hashes on its way to the root.
    """

    def __init__(self, leaves: int) -> None:
        """Hold nothing but empty leaves, at least so many."""
        self._depth = -(-max(leaves - 1, 0).bit_length() // (WIDTH - 1).bit_length())
        self._nodes: Nodes = {}

    def with_leaves(self, leaves: Mapping[int, bytes]) -> tuple[bytes, Nodes]:
        """Return the root that there would be with some leaves replaced, and the nodes to ``put`` for it."""
        nodes: Nodes = {(0, number): _hash(data) if data else _EMPTY for number, data in leaves.items()}
        above = set(leaves)
        for level in range(1, self._depth + 1):
            above = {number // WIDTH for number in above}
            for number in above:
                first = WIDTH * number
                children = [self._at(nodes, level - 1, child) for child in range(first, first + WIDTH)]
                nodes[level, number] = _hash(b"".join(map(_framed, children))) if any(children) else _EMPTY
        return self._at(nodes, self._depth, 0), nodes

    def put(self, nodes: Nodes) -> None:
        """Replace nodes, as ``with_leaves`` returned them for this tree."""
        self._nodes |= nodes

    def _at(self, nodes: Nodes, level: int, number: int) -> bytes:
        found = nodes.get((level, number))
        return self._nodes.get((level, number), _EMPTY) if found is None else found


def _hash(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=ROOT_BYTES).digest()


def _framed(child: bytes) -> bytes:
    return child or bytes(ROOT_BYTES)
