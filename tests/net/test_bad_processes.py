"""Real processes, one of which is slow, mute or worse: the others finish, in about the time without it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.net_processes import misbehaving, plan_of, run
from tests.support.small_missions import small_office
from vedette.net.names import robot_name

ROBOTS, BAD = 3, 2  # the one with the highest number becomes the root


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["slow=0.7", "slow=3", "slow=100000", "mute", "wrong map", "echo", "epoch"])
def test_a_member_that_misbehaves_stops_nobody(mode: str, tmp_path: Path) -> None:
    team = misbehaving(mode, BAD)
    mission = run(plan_of(small_office(), ROBOTS), tmp_path, team=team, max_time=600.0)
    summary, diary = mission.report.summary, mission.diary
    honest = [i for i in range(ROBOTS) if i != BAD]
    known = [diary.last(i).known for i in honest]
    named = {each.robot for i in honest for told in diary.by_robot[i] for each in told.said.complaints}
    print(
        f"\n{mode}: {summary.outcome} after {summary.time_s:.0f} s; {known} known, "
        f"rounds {[diary.last(i).rounds for i in range(ROBOTS)]}, {robot_name(BAD)} named: {BAD in named}"
    )
    assert all(diary.last(i).state == "done" for i in honest)
    assert diary.agree(honest)
    assert all(share is not None and share > 0.9 * max(known) for share in known)
