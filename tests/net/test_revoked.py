"""Certificates that are revoked: who makes the list, who believes it, how all of a team get it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from click.testing import CliRunner

from tests.support.net_processes import Diary, Fault, plan_of, run
from tests.support.net_team import TEAM, issue, issue_for
from tests.support.small_missions import small_office
from vedette.cli.keys import keys as keys_command
from vedette.errors import InputError
from vedette.net.access import access_control
from vedette.net.credentials import CA, credentials, load_certificate, load_key
from vedette.net.keys import CA_KEY, add_robots
from vedette.net.launch import TEAM as LAUNCHED
from vedette.net.launch import TeamProcesses
from vedette.net.names import Names, robot_name
from vedette.net.revocations import AGAIN, ANSWERS, ASKS, KIND, LOOK, Revocations
from vedette.net.revoke import revoke
from vedette.net.revoked import REVOKED, checked, load_revoked, signed

NOW = datetime.now(UTC)


@pytest.fixture
def team(tmp_path: Path) -> Path:
    return issue(tmp_path / "keys", 4)


def quiet(line: str) -> None:
    """Say nothing."""


def revocations(team: Path, robot: int, say: Callable[[str], None] = quiet) -> Revocations:
    """What a robot knows, by its folder."""
    return Revocations(credentials(team / robot_name(robot), NOW), say)


# -- the list --------------------------------------------------------------------------------------------


def test_a_list_grows_and_lies_beside_every_key_also_of_robots_that_join_later(team: Path) -> None:
    assert load_revoked(team, load_certificate(team / CA), TEAM).number == 0
    revoke(TEAM, team, [1], NOW)
    revoke(TEAM, team, [3], NOW)
    add_robots(TEAM, team, 1, NOW, days=1)
    for name in ("robot-1", "robot-3", "robot-5", "operator"):
        listed = credentials(team / name, NOW).revoked
        assert (listed.number, listed.robots) == (2, {1, 3})


def test_a_robot_whose_certificate_is_revoked_cannot_start(team: Path) -> None:
    revoke(TEAM, team, [1], NOW)
    with pytest.raises(InputError, match=r"robot-2.cert\.pem has been revoked; ask"):
        credentials(team / "robot-2", NOW)


@pytest.mark.parametrize(("robots", "said"), [([], "whose certificate"), ([4], "robot-5 was never issued")])
def test_nobody_and_who_was_never_issued_cannot_be_revoked(team: Path, robots: list[int], said: str) -> None:
    with pytest.raises(InputError, match=said):
        revoke(TEAM, team, robots, NOW)
    assert not (team / REVOKED).exists()


def test_a_list_counts_by_its_signature_alone(team: Path, tmp_path: Path) -> None:
    authority = load_certificate(team / CA)
    revoke(TEAM, team, [1], NOW)
    text = (team / REVOKED).read_bytes()
    assert checked(text, authority, TEAM).robots == {1}
    foreign = load_key(issue(tmp_path / "foreign") / CA_KEY)
    forged = [
        text.replace(b"[2]", b"[3]"),
        text.replace(b":1,", b":9,"),
        signed(TEAM, 9, frozenset({2}), foreign).text,
        signed("another", 9, frozenset({2}), load_key(team / CA_KEY)).text,
        signed(TEAM, 9, frozenset({2}), load_key(team / "robot-1" / "key.pem")).text,
        text[:-1],
        text.splitlines()[0],
        b"",
        b"\xff" * 100,
    ]
    for each in forged:
        with pytest.raises(ValueError, match=r"a list that the team|a list of team|no list of revoked"):
            checked(each, authority, TEAM)
        robot = revocations(team, 0)
        with suppress(ValueError):  # one that is no longer than its own changes nothing in any case
            robot.hear(2, ASKS + each)
        assert robot.latest.robots == {1}
    (team / "robot-1" / REVOKED).write_bytes(forged[0])
    with pytest.raises(InputError, match="has not signed; copy it again"):
        credentials(team / "robot-1", NOW)


def test_the_command_says_where_the_list_goes(team: Path) -> None:
    ran = CliRunner().invoke(keys_command, ["revoke", TEAM, str(team), "2"])
    assert ran.exit_code == 0, ran
    assert f"{team / REVOKED}: copy it beside the keys of one robot at least" in ran.output
    assert credentials(team / "robot-1", NOW).revoked.robots == {1}


# -- who has it ------------------------------------------------------------------------------------------


def test_a_session_lets_nobody_in_whose_certificate_was_revoked_before_it_began() -> None:
    names = Names(TEAM)
    for robot in (0, None):
        let_in = {each["id"] for each in access_control(names, robot, 4, frozenset({2}))["subjects"]}
        assert names.certificate(1) in let_in
        assert names.certificate(2) not in let_in


def test_a_list_put_beside_one_robots_keys_goes_round_and_is_kept(team: Path) -> None:
    robots = [revocations(team, i) for i in range(3)]
    shutil.copytree(team, elsewhere := team.parent / "elsewhere")
    revoke(TEAM, elsewhere, [3], NOW)
    shutil.copy(elsewhere / REVOKED, team / "robot-1")
    robots[0].look(LOOK)
    assert robots[0].complaints == {3: "its certificate has been revoked"}
    pass_on(robots, LOOK, lost=0)
    assert [robot.latest.number for robot in robots] == [1, 1, 1]
    assert credentials(team / "robot-3", NOW).revoked.robots == {3}
    assert pass_on(robots, LOOK + 10 * AGAIN, lost=0) == 0  # everybody knows that everybody knows


def test_a_list_that_gets_lost_is_told_again_and_a_shorter_one_never_comes_back(team: Path) -> None:
    revoke(TEAM, team, [3], NOW)
    old = (team / REVOKED).read_bytes()
    robots = [revocations(team, i) for i in range(2)]
    revoke(TEAM, team, [2], NOW)
    robots[0].look(LOOK)
    pass_on(robots, LOOK, lost=2)
    assert robots[1].latest.robots == {3}
    pass_on(robots, LOOK + AGAIN, lost=0)
    assert robots[1].latest.robots == {2, 3}
    ((to, answer),) = robots[1].hear(0, ASKS + old)
    assert to == 0
    assert answer == KIND + ANSWERS + robots[1].latest.text
    assert robots[1].latest.robots == {2, 3}


def pass_on(robots: list[Revocations], now: float, lost: int) -> int:
    """Let robots in a row tell each other, the first ``lost`` datagrams apart; return how many they sent."""
    sent = 0
    ahead = True
    while ahead:
        ahead = False
        for i, robot in enumerate(robots):
            near = [k for k in (i - 1, i + 1) if 0 <= k < len(robots)]
            post = [(i, *each) for each in robot.tell(near, now)]
            while post:
                ahead, sent = True, sent + 1
                sender, to, payload = post.pop()
                if sent > lost:
                    post += [(to, *answer) for answer in robots[to].hear(sender, payload[1:])]
    return sent


# -- real processes --------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_running_team_goes_on_without_who_is_revoked(tmp_path: Path) -> None:
    def strike(diary: Diary) -> None:
        team = diary.team.folder / "keys"
        shutil.copytree(team, tmp_path / "authority")
        revoke(LAUNCHED, tmp_path / "authority", [2], datetime.now(UTC))
        shutil.copy(tmp_path / "authority" / REVOKED, team / "robot-1")

    plan = plan_of(small_office(), 3)
    mission = run(plan, tmp_path / "logs", [Fault(0.2, "revoke", strike)], max_time=300.0)
    said = {
        (i, each.robot): each.what
        for i in range(3)
        for told in mission.diary.by_robot[i]
        for each in told.said.complaints
    }
    for i in range(3):  # who is revoked hears of it too
        assert said[i, 2] == "its certificate has been revoked", said
    assert {mission.diary.last(i).size for i in (0, 1)} == {2}
    assert all(mission.diary.last(i).state == "done" for i in (0, 1))
    assert mission.diary.agree([0, 1])


@pytest.mark.slow
def test_a_robot_whose_certificate_expires_on_the_way_is_gone_and_the_others_finish(tmp_path: Path) -> None:
    class Expiring(TeamProcesses):
        """The last robot's certificate lasts for some seconds more."""

        def _write(self, i: int, pose: object = None) -> None:
            super()._write(i)
            if i == 2:
                shutil.rmtree(folder := self.folder / "keys" / robot_name(2))
                issue_for(self.folder / "keys", folder, timedelta(seconds=15), LAUNCHED)

    mission = run(plan_of(small_office(), 3), tmp_path, team=Expiring, max_time=300.0)
    assert {mission.diary.last(i).size for i in (0, 1)} == {2}
    assert all(mission.diary.last(i).state == "done" for i in (0, 1))
    assert mission.diary.agree([0, 1])
