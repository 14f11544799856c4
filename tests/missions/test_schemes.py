"""Whole missions by two orders, by forks and without a barrier, over links that lose messages."""

from __future__ import annotations

import pytest

from tests.support.small_missions import check_complete, robots, run, small_maze


@pytest.mark.parametrize("scheme", ["multistart", "fork", "async"])
def test_a_team_maps_a_maze_over_lossy_links_by_any_scheme(scheme: str) -> None:
    _, report = run(small_maze(), robots(3), seed=2, scheme=scheme, link_loss=0.1)
    check_complete(report)
    assert report.summary.scheme == scheme
    assert report.summary.sweeps > 0
