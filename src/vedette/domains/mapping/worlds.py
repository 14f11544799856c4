"""Worlds that a team may be in: the known map with what may be unknown of it, in several ways at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.completions import Frontiers, completions
from vedette.domains.mapping.prior import Foresight, PriorMap, Shares, as_told, trust
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.laid import laid

# What is foreseen in each of K equally likely worlds; None: nothing. Planning cell s in world w is s K + w.
Worlds: TypeAlias = tuple[Foresight | None, ...]


def imagine(
    classes: NDArray[np.uint8],
    window: GridFrame,
    factor: int,
    first: tuple[int, int],
    frontiers: Frontiers,
    prior: PriorMap | None,
    worlds: int,
) -> Worlds:
    """Return worlds of which the first goes by no more than the map, the others by what the building showed.

    An old map goes before both: world w of K goes by it where its trust is at least (2 w + 1) / (2 K).
    docs/mapping.md (V200)-(V203)

    Args:
        classes: (R, C) the team map in a window.
        window: where it lies.
        factor: side of a planning cell [cells].
        first: planning cell (row, col) at the window's corner.
        frontiers: of the map.
        prior: an old map; None: there is none.
        worlds: how many.
    """
    told = [np.zeros_like(classes), *completions(classes, factor, first, frontiers, worlds - 1)]
    if prior is not None:
        old = laid(prior.classes, prior.frame, window)
        trusted = 2 * worlds * trust(classes, old, window.resolution)
        for world, said in enumerate(told):
            told[world] = np.where((old != UNKNOWN) & (trusted >= 2 * world + 1), old, said)
    return tuple(as_told(classes, said, 1.0, factor) for said in told)


def to_see(unknown: NDArray[np.uint16], worlds: Worlds) -> NDArray[np.uint16] | NDArray[np.float32]:
    """Return ``(r, c K)`` how many of ``(r, c)`` unknown cells there are to be seen, over K, by worlds."""
    each = [unknown if world is None else world.expected(unknown) for world in worlds]
    return each[0] if len(each) == 1 else (interleaved(each) / len(each)).astype(np.float32)


def trust_in(worlds: Worlds, shape: tuple[int, int]) -> NDArray[np.float32]:
    """Return ``(r, c K)`` with what probability what is foreseen is right, by worlds."""
    return interleaved([np.zeros(shape, np.float32) if each is None else each.trust for each in worlds])


def interleaved(each: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return ``(r, c K)`` of K arrays ``(r, c)``, the worlds of a planning cell side by side."""
    return np.stack(each, axis=-1).reshape(each[0].shape[0], -1)


def in_each(values: NDArray[np.float32], worlds: int) -> NDArray[np.float32]:
    """Return ``(r, c K)`` a K-th of each value in each world."""
    return np.repeat(values / np.float32(worlds), worlds, axis=1)


def over_worlds(each: Sequence[Shares]) -> Shares:
    """Return what looks reveal in all K worlds as one, of planning cells in worlds, from that in each."""
    count = len(each)
    if count == 1:
        return each[0]
    looks = len(each[0][0]) - 1
    look = np.concatenate([np.repeat(np.arange(looks), np.diff(starts)) for starts, _, _ in each])
    keys = np.concatenate([count * cells.astype(np.int64) + k for k, (_, cells, _) in enumerate(each)])
    shares = np.concatenate([shares for _, _, shares in each])
    order = np.lexsort((keys, look))
    starts = np.searchsorted(look[order], np.arange(looks + 1))
    return starts.astype(np.int64), keys[order].astype(np.uint32), shares[order]
