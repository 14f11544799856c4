"""What an overlay tells: its robot's place on the tree for the agent, the whole state for people."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Place:
    """A robot's place on the tree; messages of other epochs, or from others than the neighbours, are void.

    Within one epoch the parent stays and neighbours are only added; any loss makes a new epoch.
    """

    epoch: int  # the name of the tree's stamp, < 2**53
    parent: int | None  # None at the root
    neighbours: tuple[int, ...]  # ascending
    size: int  # robots on the tree, as far as the count has come round
    distance: int = 0  # to the root: what the links to it cost, one each or more


@dataclass(frozen=True)
class LinkStatus:
    """A neighbour and the link to it, for people."""

    robot: int
    role: str  # "parent", "child", "other", "down", or "left" after its goodbye
    loss: float  # share of hellos from it that do not arrive
    offset: float | None  # its clock minus ours [s]
    round_trip: float | None  # [s]
    silent: float | None  # for how long [s]; None: never heard


@dataclass(frozen=True)
class Status:
    """An overlay, for people."""

    root: int
    epoch: int  # the count, not the stamp
    distance: int  # costs of the links to the root
    place: Place
    age: float  # of the tree, here [s]
    to_root: float  # the root's clock minus ours [s]
    links: tuple[LinkStatus, ...]
