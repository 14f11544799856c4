"""Connected parts of a grid are those that the usual library labels."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.kernels import components as kernel
from vedette.kernels.reference import components as reference


@settings(deadline=None, max_examples=150)
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(st.integers(1, 40), st.integers(1, 40)),
    share=st.sampled_from([0.0, 0.3, 0.6, 0.9, 1.0]),
)
def test_parts_are_labelled_as_the_usual_library_labels_them(
    seed: int, shape: tuple[int, int], share: float
) -> None:
    cells = np.random.default_rng(seed).random(shape) < share
    assert np.array_equal(kernel.components(cells), reference.components(cells))
    labels = reference.components(cells)
    sizes = [np.count_nonzero(labels == part) for part in range(labels.max() + 1)]
    of_largest = labels == int(np.argmax(sizes)) if sizes else np.zeros(shape, np.bool_)
    assert np.array_equal(kernel.largest(cells), of_largest)
