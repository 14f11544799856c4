"""Anything that a caller may give by mistake."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st

from vedette import Coverage, InputError, LogDet

ARRAYS: list[Any] = [
    np.array(0.5),
    np.empty((0, 3)),
    np.ones(2),
    np.ones((3, 3)),
    np.array([0.5, np.nan, 1.0]),
    np.array([0.5, np.inf, 1.0]),
    np.array([0.5, -0.5, 1.5]),
    np.array([0.5, None, "x"], dtype=object),
    np.array(["a", "b", "c"]),
    np.array([1j, 0.0, 0.0]),
    np.array([True, False, True]),
    np.array([1, 0, 300], dtype=np.uint16),
    np.array([0.5, 0.25, 1.0], dtype=np.float16),
    np.array(["2026-01-01"] * 3, dtype="datetime64[D]"),
    np.zeros(3, dtype=[("x", float)]),
    np.ma.masked_array([0.5, 0.5, 0.5], mask=[True, False, False]),
    np.broadcast_to(np.float64(0.5), (3,)),  # read-only, one number under three indexes
    np.arange(6.0)[::-2],
]

PLAIN: list[Any] = [
    Coverage,
    LogDet(),
    len,
    object(),
    range(3),
    {0: 1},
    {1, 2},
    bytearray(b"ab"),
    1j,
    10**400,
]

JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.floats(allow_nan=True, allow_infinity=True),
    st.text(max_size=3),
    st.binary(max_size=3),
    st.sampled_from(ARRAYS),
    st.sampled_from(PLAIN),
    st.builds(iter, st.just([0, 1])),
    st.recursive(
        st.one_of(st.none(), st.integers(-2, 2), st.floats(), st.just(np.ones(3)), st.text(max_size=1)),
        lambda inner: st.lists(inner, max_size=3),
        max_leaves=6,
    ),
)
"""Wrong types, wrong shapes, wrong numbers; some of it may do."""


def assert_done_or_refused(call: Callable[[], object]) -> None:
    """Call it; what it refuses must be told in one line, and nothing else may be raised."""
    refused = None
    try:
        call()
    except InputError as error:
        refused = str(error)
    assert refused is None or (refused and "\n" not in refused)
