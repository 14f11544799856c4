"""Links that come and go all the time."""

from __future__ import annotations

import pytest

from tests.support.small_missions import robots, run, small_office
from vedette.outcome import Outcome
from vedette.sim.faults import Schedule
from vedette.sim.faults.kinds import Cut

AS_LONG = 400.0  # [s]
WRONG = 0.005  # of the cells: where a mate out of reach was seen, whom nobody can tell from a wall


def chain_with_a_flapping_end(up: float, down: float) -> Schedule:
    """Robot 3 reaches robot 2 alone, and that for ``up`` seconds after each ``down`` seconds."""
    cuts = [Cut(at=0.0, robots=(1, 3))]
    at = 1.0
    while at < AS_LONG:
        cuts.append(Cut(at=at, robots=(2, 3), lasts=down))
        at += down + up
    return Schedule(tuple(cuts))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("up", "down"),
    [
        (3.0, 3.0),
        *(pytest.param(*each, marks=pytest.mark.slow) for each in ((2.0, 4.0), (1.0, 1.0), (5.0, 5.0))),
    ],
)
def test_a_team_whose_only_link_flaps_ends_with_one_map(up: float, down: float, seed: int) -> None:
    _, report = run(small_office(), robots(3), seed=seed, faults=chain_with_a_flapping_end(up, down))
    summary = report.summary
    print(
        f"\nup {up:g} s, down {down:g} s: {summary.outcome} after {summary.time_s:.0f} s, apart for "
        f"{summary.apart_s:.0f} s, {summary.map_errors} wrong cells"
    )
    assert summary.outcome is Outcome.COMPLETE
    assert summary.coverage is not None
    assert summary.coverage >= 0.995
    assert len(summary.maps) == 1
    assert summary.map_error_share <= WRONG
