"""Neighbours that never let a round come to its end, or say what others then could not say any more."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import count, islice
from typing import Any

import numpy as np
import pytest

from tests.support.agent_team import FloatCodec
from vedette import Coverage, InputError
from vedette.negotiation import Chooser, Claims, decode, encode, node_of
from vedette.negotiation.messages import Down, Fork, Gather, Joined, Offer, Tally, Tidings, Token

SWEEPS = 5
LONG = 1000  # messages
BELIEF, NOTHING = np.arange(1.0, 13.0), np.ones(12)


def own() -> Chooser[Any, Any]:
    return Chooser(Coverage(), BELIEF, [np.full(12, miss) for miss in (0.9, 0.5)])


def node(scheme: str, parent: int | None, *neighbours: int) -> Any:
    claims: Claims[Any] = Claims(dict.fromkeys(neighbours, 1), lambda mu, robots: None)
    return node_of(scheme, neighbours, parent, own(), max_sweeps=SWEEPS, claims=claims)


def anew() -> Iterator[Any]:
    """A token on which everything is counted anew."""
    return (Token(NOTHING, Tally(0, 0, 1.0, 0.0, 2, 1e9)) for _ in count())


def worth_more() -> Iterator[Any]:
    """Offers that are each worth more than the last."""
    return (Offer(NOTHING, k, 0, False, True, float(k), 0.0, 1, 1e9, 1, False) for k in count(1))


@pytest.mark.parametrize(
    ("scheme", "parent", "says"),
    [
        pytest.param("token", 0, anew, id="token"),
        pytest.param("jacobi", 0, lambda: (Down(NOTHING) for _ in count()), id="jacobi"),
        pytest.param("fork", 0, lambda: (Fork(NOTHING, True) for _ in count()), id="fork"),
        pytest.param("async", 0, lambda: (Tidings(NOTHING, k, 0, False) for k in count(1)), id="news"),
        pytest.param("async", None, worth_more, id="offers"),
    ],
)
def test_no_neighbour_keeps_a_platform_in_a_round_for_ever(
    scheme: str, parent: int | None, says: Callable[[], Iterator[Any]]
) -> None:
    made = node(scheme, parent, 0)
    made.start()
    messages, said = islice(says(), LONG), 0
    with suppress(InputError):
        for said, message in enumerate(messages):  # noqa: B007
            made.receive(0, message)
            if made.finished is not None:
                break
    assert SWEEPS <= said < LONG - 1


def test_a_bound_beyond_what_can_be_told_is_none() -> None:
    """A root that told it as it was had its word for the round's end refused by all its children."""
    made = node("token", None, 0)
    made.start()
    made.receive(0, Gather(NOTHING, 1, 1e300, 0.0))
    while made.finished is None:
        (sent,) = made.receive(0, Token(None, Tally(2**40, 0, 1.0, 1e300, 2, 1e300)))
    assert made.finished.bound is None
    assert decode(encode(sent.message, FloatCodec()), FloatCodec()) == sent.message


def test_no_more_platforms_have_moved_than_there_are() -> None:
    made = node("fork", None, 0)
    made.start()
    made.receive(0, Gather(NOTHING, 1, 1e9, 0.0))
    with pytest.raises(InputError, match="moved"):
        made.receive(0, Joined(NOTHING, 1.0, 0.0, 1, 1e9, 2**53, False))
