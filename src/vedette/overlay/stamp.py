"""Which tree: stamps, totally ordered, that no two trees share."""

from __future__ import annotations

from typing import NamedTuple

EPOCH_BITS, ROBOT_BITS, RESIDUE_BITS = 24, 16, 13  # 53 in all: exact in every language's numbers
BOOT_BITS = 38


class Stamp(NamedTuple):
    """A tree's name: who started it, in which of its lives, and when in the order of trees.

    Epochs are even for trees and odd for a robot that is alone. So a tree that has closed ranks after a loss
    (epoch + 2) ranks above the robot that it lost (epoch + 1), which joins it again without a new tree.
    """

    epoch: int  # < 2**24
    root: int  # robot, < 2**16
    boot: int  # of the root, < 2**38

    @property
    def number(self) -> int:
        """Return the stamp as one number ``< 2**53``, in the order of stamps.

        Two boots of one root may share a number only at the same epoch and with equal residues (one in
        8,192); they are still two stamps, and nobody moves between stamps of one number.
        """
        residue = self.boot % (1 << RESIDUE_BITS)
        return (self.epoch << ROBOT_BITS | self.root) << RESIDUE_BITS | residue

    @property
    def is_alone(self) -> bool:
        """Tell whether this is one robot on its own, which nobody can join under this stamp."""
        return self.epoch % 2 == 1

    def next_alone(self, robot: int, boot: int) -> Stamp:
        """Return the next stamp of a robot on its own."""
        return Stamp(self.epoch + 1 | 1, robot, boot)

    def next_tree(self, robot: int, boot: int) -> Stamp:
        """Return the next stamp of a tree that this robot starts."""
        return Stamp((self.epoch | 1) + 1, robot, boot)
