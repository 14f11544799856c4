"""A folder is one run's at a time, and the next one's however that run ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from vedette.errors import InputError
from vedette.record.lock import LOCK, locked

HOLD = """
import sys
from pathlib import Path
from vedette.record.lock import locked
with locked(Path(sys.argv[1])):
    print("in", flush=True)
    sys.stdin.read()
"""


def test_a_second_run_is_refused_while_the_first_lives_and_told_which_that_is(tmp_path: Path) -> None:
    with locked(tmp_path):
        assert (tmp_path / LOCK).read_text() == f"{os.getpid()}\n"
        with (
            pytest.raises(
                InputError, match=f"in use by another run, process {os.getpid()}; let it end or take"
            ),
            locked(tmp_path),
        ):
            pytest.fail("both are in")
        assert (tmp_path / LOCK).exists()
    assert not list(tmp_path.iterdir())
    with locked(tmp_path):
        pass


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM, None])
def test_a_process_that_ends_in_whatever_way_leaves_the_folder_free(
    tmp_path: Path, end: signal.Signals | None
) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == b"in\n"
        with pytest.raises(InputError, match=f"process {other.pid};"), locked(tmp_path):
            pytest.fail("both are in")
        if end is not None:
            other.send_signal(end)
        other.communicate()
    assert (tmp_path / LOCK).exists() == (end is not None)
    with locked(tmp_path):
        assert (tmp_path / LOCK).read_text() == f"{os.getpid()}\n"


def test_who_leaves_a_folder_that_is_anothers_by_now_takes_nothing_away(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    with locked(folder):
        folder.rename(tmp_path / "moved")
        folder.mkdir()
        (folder / LOCK).write_text("1\n")
    assert (folder / LOCK).read_text() == "1\n"


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs Linux")
def test_a_folder_that_takes_no_file_is_bad_input() -> None:
    with pytest.raises(InputError, match=r"cannot write /proc/self/\.lock"), locked(Path("/proc/self")):
        pytest.fail("that cannot be")
