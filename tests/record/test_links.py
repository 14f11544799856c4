"""Links as seen from outside: which robots a tree holds together, and what overlays report."""

from __future__ import annotations

from itertools import product

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.overlay.status import LinkStatus, Place, Status
from vedette.record.links import Link, links_of, parts


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 7), st.integers(0, 2**32 - 1))
def test_parts_are_the_components_of_the_living_on_tree_links(n: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    alive = (rng.random(n) < 0.8).tolist()
    pairs = [(a, b) for a in range(n) for b in range(a + 1, n) if rng.random() < 0.3]
    links = [Link(a, b, bool(rng.random() < 0.6), 0.0) for a, b in pairs]
    reach = np.diag(alive)
    for link in links:
        if link.on_tree and alive[link.a] and alive[link.b]:
            reach[link.a, link.b] = reach[link.b, link.a] = True
    together = np.linalg.matrix_power(reach.astype(int), n) > 0
    expected = {tuple(np.flatnonzero(together[i]).tolist()) for i in range(n) if alive[i]}
    assert parts(alive, links) == tuple(sorted(expected))


def test_on_an_ideal_network_the_living_are_together_and_without_links_everybody_is_alone() -> None:
    assert parts([True, False, True], None) == ((0, 2),)
    assert parts([True, False, True], ()) == ((0,), (2,))
    assert parts([False, False], None) == parts([False, False], ()) == ()


def _status(epoch: int, links: dict[int, tuple[str, float]]) -> Status:
    told = tuple(LinkStatus(k, role, loss, 0.0, 0.0, 0.0) for k, (role, loss) in links.items())
    return Status(0, epoch, 0, Place(epoch, None, (), 1), 0.0, 0.0, told)


def test_a_link_is_up_if_both_ends_say_so_and_on_the_tree_if_both_hold_it_in_the_same_epoch() -> None:
    statuses = [
        _status(7, {1: ("child", 0.1), 2: ("child", 0.0), 3: ("other", 0.0), 4: ("down", 0.0)}),
        _status(7, {0: ("parent", 0.3), 2: ("other", 0.0), 5: ("child", 0.0)}),
        _status(6, {0: ("parent", 0.0), 1: ("other", 0.2)}),  # has not heard of the new tree yet
        _status(7, {0: ("parent", 0.0)}),  # takes for its parent one that does not know yet
        _status(7, {0: ("other", 0.0)}),
        None,  # dead
    ]
    assert links_of(statuses) == (
        Link(0, 1, True, 0.3),
        Link(0, 2, False, 0.0),
        Link(0, 3, False, 0.0),
        Link(1, 2, False, 0.2),
    )


def test_links_come_once_each_in_order() -> None:
    everybody = [_status(1, {k: ("other", 0.0) for k in range(5) if k != i}) for i in range(5)]
    assert [(link.a, link.b) for link in links_of(everybody)] == [
        (a, b) for a, b in product(range(5), repeat=2) if a < b
    ]
