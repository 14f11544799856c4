"""Which tree: stamps, totally ordered, that no two trees share."""

from __future__ import annotations

import hashlib
import struct
from functools import lru_cache
from typing import NamedTuple

EPOCH_BITS, ROBOT_BITS, BOOT_BITS, NAME_BITS = 63, 16, 38, 53
HALF = 1 << EPOCH_BITS - 1  # to which epochs may be raised at once: as many are left then
STEP = 1 << 32  # by which they may be raised beyond that, and beyond one's own


class Stamp(NamedTuple):
    """A tree's name: who started it, in which of its lives, and when in the order of trees.

    Epochs are even for trees and odd for a robot that is alone. So a tree that has closed ranks after a loss
    (epoch + 2) ranks above the robot that it lost (epoch + 1), which joins it again without a new tree.
    """

    epoch: int  # < 2**63
    root: int  # robot, < 2**16
    boot: int  # of the root, < 2**38

    @property
    def name(self) -> int:
        """Return a number ``< 2**53``, exact in every language's numbers: no two trees have the same."""
        return _name(self)

    @property
    def is_alone(self) -> bool:
        """Tell whether this is one robot on its own, which nobody can join under this stamp."""
        return self.epoch % 2 == 1

    def may_follow(self, epoch: int) -> bool:
        """Tell whether a robot on the tree of this stamp may go over to one of an epoch.

        Epochs grow by two from tree to tree. Whoever says a much higher one raises everybody's, but leaves
        room for as many again; a robot that has just been started takes what it finds.
        """
        fresh = self.epoch == 1
        return epoch <= (2 * HALF - 2 * STEP if fresh else max(self.epoch, HALF) + STEP)

    def next_alone(self, robot: int, boot: int) -> Stamp:
        """Return the next stamp of a robot on its own."""
        return Stamp(self.epoch + 1 | 1, robot, boot)

    def next_tree(self, robot: int, boot: int) -> Stamp:
        """Return the next stamp of a tree that this robot starts."""
        return Stamp((self.epoch | 1) + 1, robot, boot)


@lru_cache(1024)
def _name(stamp: Stamp) -> int:
    digest = hashlib.blake2b(struct.pack("<QQQ", *stamp), digest_size=8).digest()
    return int.from_bytes(digest, "little") >> 64 - NAME_BITS
