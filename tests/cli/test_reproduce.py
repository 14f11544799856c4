"""``vedette reproduce``: where it writes, how it ends, and what it says where the reproduction is missing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.reproductions import interrupted, some_section
from vedette.cli.reproduce import reproduce as command
from vedette.errors import InputError
from vedette_reproduction import reproduce as module

# As if the package were not installed.
WITHOUT = "import sys; sys.modules['vedette_reproduction'] = None; from vedette.cli import main; main()"


def test_the_command_writes_where_it_is_told_and_ends_with_130_when_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "CONTENTS", {"Some": some_section, "C9": interrupted})
    monkeypatch.setattr(sys, "argv", ["vedette", "reproduce", "--quick"])
    out = tmp_path / "out"

    def status(*arguments: str) -> object:
        with pytest.raises(SystemExit) as ended:
            command.main(args=["--quick", "--out", str(out), *arguments], standalone_mode=False)
        return ended.value.code

    assert status() == 130
    said = capsys.readouterr()
    assert "1 claim tried: 1 hold in part" in said.out
    assert "missing: C9" in said.out
    assert "[ 1/2]" in said.err
    monkeypatch.setattr(module, "CONTENTS", {"Some": some_section})
    with pytest.raises(InputError, match="--force"):
        command.main(args=["--out", str(out)], standalone_mode=False)
    assert status("--force") == 0
    assert "Incomplete" not in (out / "report.html").read_text(encoding="utf-8")


def test_a_bad_seed_is_refused() -> None:
    with pytest.raises(InputError, match=r"^--seed must be a whole number, 0 or more; got '-1'$"):
        command.main(args=["--seed", "-1"], standalone_mode=False)


def vedette_without(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the command line where the reproduction is not installed."""
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, *arguments],
        cwd=cwd, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def test_where_it_is_not_installed_one_line_says_what_to_install(tmp_path: Path) -> None:
    done = vedette_without("reproduce", "--quick", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    [line] = done.stderr.splitlines()
    assert "pip install ./reproduction" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [("--help",), ("reproduce", "--help"), ("study", "--help")])
def test_where_it_is_not_installed_help_still_helps(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    done = vedette_without(*arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: " in done.stdout
