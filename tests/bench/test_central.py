"""The centralised greedy that negotiations are held against, and its table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench.central import central, lazy_greedy, problem


@pytest.mark.parametrize("seed", range(10))
def test_the_lazy_greedy_chooses_what_one_that_looks_at_everything_chooses(seed: int) -> None:
    weights, candidates = problem(5, 3.0, np.random.default_rng(seed))
    left, free, value = weights.copy(), set(range(5)), 0.0
    while free:
        gains = {(i, k): weights_seen(left, own) for i in free for k, own in enumerate(candidates[i])}
        (i, k), gain = max(gains.items(), key=lambda each: each[1])
        free.remove(i)
        value += gain
        left *= candidates[i][k]
    assert lazy_greedy(weights, candidates) == pytest.approx(value, rel=1e-12)


def weights_seen(left: np.ndarray, misses: np.ndarray) -> float:
    return float((left * (1.0 - misses)).sum())


def test_the_table_is_written(tmp_path: Path) -> None:
    done = CliRunner().invoke(central, ["--platforms", "3", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    lines = (tmp_path / "central.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 5
    assert all(float(line.split("|")[6]) > 0.5 for line in lines[2:])
