"""A team's keys: what is made, what is refused, and what is said of a folder that does not admit anybody."""

from __future__ import annotations

import re
import shutil
import stat
import subprocess
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from click.testing import CliRunner
from cryptography import x509

from tests.support.net_team import TEAM, issue
from vedette.cli.keys import keys as keys_command
from vedette.errors import InputError
from vedette.net import Credentials, credentials
from vedette.net.keys import add_robots, issue_team

NOW = datetime(2026, 11, 22, 12, 0, tzinfo=UTC)
DAY = timedelta(days=1)


@pytest.fixture
def team(tmp_path: Path) -> Path:
    issue_team(TEAM, tmp_path / "keys", 2, NOW, days=30)
    return tmp_path / "keys"


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# -- what is made ----------------------------------------------------------------------------------------


def test_every_folder_admits_its_robot_to_the_team_until_it_expires(team: Path) -> None:
    expires = NOW + 30 * DAY
    assert credentials(team / "robot-1", NOW) == Credentials(team / "robot-1", TEAM, 0, expires)
    assert credentials(team / "robot-2", NOW).name == f"{TEAM}/robot-2"
    assert credentials(team / "operator", expires).robot is None


def test_openssl_agrees_that_the_certificates_are_the_authoritys_and_serve_both_ends(tmp_path: Path) -> None:
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("no openssl on this machine")
    folder = issue(tmp_path / "keys")
    for name in ("robot-1", "operator"):
        for purpose in ("sslclient", "sslserver"):
            command = [
                openssl,
                "verify",
                "-x509_strict",
                "-purpose",
                purpose,
                "-CAfile",
                str(folder / "ca.pem"),
            ]
            result = subprocess.run(
                [*command, str(folder / name / "cert.pem")], capture_output=True, text=True
            )
            assert result.returncode == 0, result.stderr


def test_secrets_are_readable_by_the_owner_alone(team: Path) -> None:
    secret = [path for path in (team, *team.rglob("*")) if path.is_dir() or "key" in path.name]
    assert {path.is_dir() for path in secret} == {False, True}
    for path in secret:
        assert stat.S_IMODE(path.stat().st_mode) & 0o077 == 0, path


def test_a_robots_folder_holds_what_it_needs_and_not_the_authoritys_key(team: Path) -> None:
    assert sorted(path.name for path in team.iterdir()) == [
        "ca-key.pem",
        "ca.pem",
        "issued.txt",
        "operator",
        "robot-1",
        "robot-2",
    ]
    for name in ("robot-1", "robot-2", "operator"):
        assert sorted(path.name for path in (team / name).iterdir()) == ["ca.pem", "cert.pem", "key.pem"]
        assert (team / "ca-key.pem").read_bytes() not in files(team / name).values()


def test_serial_numbers_are_random_and_keys_all_different(team: Path, tmp_path: Path) -> None:
    issue_team(TEAM, tmp_path / "twin", 2, NOW)
    certificates = [*team.rglob("cert.pem"), *(tmp_path / "twin").rglob("cert.pem")]
    serials = {x509.load_pem_x509_certificate(path.read_bytes()).serial_number for path in certificates}
    secrets = {path.read_bytes() for folder in (team, tmp_path / "twin") for path in folder.rglob("*key.pem")}
    assert (len(serials), len(secrets)) == (6, 8)
    assert min(serials) > 1 << 100


# -- adding ----------------------------------------------------------------------------------------------


def test_robots_that_are_added_have_new_numbers_and_leave_the_others_alone(team: Path) -> None:
    before = files(team)
    made = add_robots(TEAM, team, 2, NOW + 100 * DAY, days=10)
    assert made == [team / "robot-3", team / "robot-4"]
    assert credentials(team / "robot-4", NOW + 100 * DAY).robot == 3
    after = files(team)
    assert {name: after[name] for name in before if name != "issued.txt"} == {
        name: text for name, text in before.items() if name != "issued.txt"
    }
    assert after["issued.txt"].startswith(before["issued.txt"])


def test_a_number_is_never_given_twice_even_if_its_folder_has_been_moved_away(team: Path) -> None:
    add_robots(TEAM, team, 1, NOW)
    shutil.rmtree(team / "robot-3")
    shutil.rmtree(team / "robot-2")
    assert add_robots(TEAM, team, 1, NOW) == [team / "robot-4"]


def test_the_record_lists_every_certificate_with_its_serial_number(team: Path) -> None:
    add_robots(TEAM, team, 1, NOW, days=1)
    record = [line.split() for line in (team / "issued.txt").read_text().splitlines()]
    assert sorted(name for name, *_ in record) == ["operator", "robot-1", "robot-2", "robot-3"]
    for name, serial, expires in record:
        certificate = x509.load_pem_x509_certificate((team / name / "cert.pem").read_bytes())
        assert (certificate.serial_number, str(certificate.not_valid_after_utc.date())) == (
            int(serial, 16),
            expires,
        )


# -- what is refused -------------------------------------------------------------------------------------


def test_nothing_that_exists_is_overwritten(team: Path, tmp_path: Path) -> None:
    before = files(team)
    with pytest.raises(InputError, match="exists; nothing was changed"):
        issue_team(TEAM, team, 2, NOW)
    (team / "robot-3").mkdir()
    with pytest.raises(InputError, match="exists, though never issued"):
        add_robots(TEAM, team, 1, NOW)
    assert files(team) == before
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match="exists"):
        issue_team(TEAM, tmp_path / "link", 1, NOW)


def test_keys_that_cannot_be_written_whole_leave_nothing_behind(
    team: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, written = sorted(team.parent.rglob("*")), 0
    write = Path.write_bytes

    def fail_in_the_end(path: Path, data: bytes) -> int:
        nonlocal written
        written += 1
        if written % 5 == 0:
            raise OSError(28, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", fail_in_the_end)
    with pytest.raises(InputError, match="No space left"):
        issue_team(TEAM, team.parent / "new", 3, NOW)
    with pytest.raises(InputError, match="No space left"):
        add_robots(TEAM, team, 3, NOW)
    assert sorted(team.parent.rglob("*")) == before


@pytest.mark.parametrize("name", ["", "a b", "a/b", "**", "x" * 33, "büro", "a\n"])
def test_a_team_that_cannot_be_part_of_a_key_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="team must be"):
        issue_team(name, tmp_path / "keys", 1, NOW)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("robots", "days"), [(0, 1), (-1, 1), (1025, 1), (1, 0), (1, 36501)])
def test_numbers_out_of_range_are_refused(robots: int, days: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must lie in"):
        issue_team(TEAM, tmp_path / "keys", robots, NOW, days)


def test_adding_needs_the_teams_own_authority_and_its_time(team: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is the authority of 'office'"):
        add_robots("other", team, 1, NOW)
    with pytest.raises(InputError, match="fewer --days"):
        add_robots(TEAM, team, 1, NOW, days=3651)
    with pytest.raises(InputError, match="cannot read"):
        add_robots(TEAM, tmp_path, 1, NOW)
    other = issue(tmp_path / "other")
    shutil.copy(other / "ca-key.pem", team / "ca-key.pem")
    with pytest.raises(InputError, match="is not the key of"):
        add_robots(TEAM, team, 1, NOW)


def test_a_record_that_was_tampered_with_stops_adding(team: Path) -> None:
    with (team / "issued.txt").open("a") as file:
        file.write("robot-x\n")
    with pytest.raises(InputError, match="not the record"):
        add_robots(TEAM, team, 1, NOW)


# -- a folder that admits nobody -------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["ca.pem", "cert.pem", "key.pem"])
@pytest.mark.parametrize("content", [None, b"", b"\x00\xff", b"-----BEGIN CERTIFICATE-----\nAAAA\n"])
def test_a_file_that_is_missing_or_damaged_is_named(team: Path, name: str, content: bytes | None) -> None:
    path = team / "robot-1" / name
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    reason = f"cannot read {path}: No such file" if content is None else f"{path} is not a"
    with pytest.raises(InputError, match=re.escape(reason)) as caught:
        credentials(team / "robot-1", NOW)
    assert "\n" not in str(caught.value)


def test_times_before_and_after_are_refused(team: Path) -> None:
    with pytest.raises(InputError, match="expired on 2026-12-22"):
        credentials(team / "robot-1", NOW + 30 * DAY + timedelta(seconds=1))
    with pytest.raises(InputError, match="the clock says 1970-01-01"):
        credentials(team / "robot-1", datetime.fromtimestamp(0, UTC))


def test_files_of_different_holders_do_not_go_together(team: Path, tmp_path: Path) -> None:
    other = issue(tmp_path / "other")
    shutil.copy(team / "robot-2" / "key.pem", team / "robot-1" / "key.pem")
    with pytest.raises(InputError, match="is not the key of"):
        credentials(team / "robot-1", NOW)
    shutil.copy(other / "ca.pem", team / "robot-2" / "ca.pem")
    with pytest.raises(InputError, match="was not issued by"):
        credentials(team / "robot-2", NOW)


def test_the_authority_itself_admits_nobody(team: Path) -> None:
    for source, target in (("ca.pem", "cert.pem"), ("ca-key.pem", "key.pem")):
        shutil.copy(team / source, team / "robot-1" / target)
    with pytest.raises(InputError, match="neither a robot nor the operator"):
        credentials(team / "robot-1", NOW)


# -- the command -----------------------------------------------------------------------------------------


def test_the_command_makes_keys_and_says_what_goes_where(tmp_path: Path) -> None:
    folder = str(tmp_path / "keys")
    made = CliRunner().invoke(keys_command, [TEAM, folder, "--robots", "3"], catch_exceptions=False)
    assert "robot-1 to robot-3: copy" in made.output
    assert "ca-key.pem: keep it here" in made.output
    added = CliRunner().invoke(keys_command, [TEAM, folder, "--add", "1"], catch_exceptions=False)
    assert "robot-4: copy" in added.output
    assert "operator" not in added.output.replace(str(tmp_path), "")
    assert credentials(Path(folder) / "robot-4", datetime.now(UTC)).robot == 3


@pytest.mark.parametrize("options", [[], ["--robots", "1", "--add", "1"]])
def test_the_command_wants_either_a_new_team_or_more_robots(options: list[str], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="either"):
        CliRunner().invoke(keys_command, [TEAM, str(tmp_path / "keys"), *options], catch_exceptions=False)
