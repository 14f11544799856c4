"""``vedette`` as users run it: in this process or one of its own, what it refuses, the files it leaves."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from mcap.reader import make_reader
from PIL import Image

from tests.support.schemas import valid
from vedette.cli import main
from vedette.maps import read_map

FILES = {  # by the command that leaves them
    "explore": {
        "summary.json", "timing.json", "map.yaml", "map.pgm", "progress.png", "curves.png", "run.mcap"
    },
    "monitor": {"summary.json", "timing.json", "field.png", "curves.png", "run.mcap"},
    "search": {"summary.json", "timing.json", "pdf.png", "detection.png", "run.mcap"},
    "track": {"summary.json", "timing.json", "tracks.png", "entropy.png", "run.mcap"},
}  # fmt: skip


@dataclass(frozen=True)
class Ran:
    """What a command did."""

    status: int
    out: str
    err: str


class Command:
    """Runs ``vedette``, or one of its commands, in this process."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *command: str
    ) -> None:
        self._monkeypatch = monkeypatch
        self._capsys = capsys
        self._command = command

    def __call__(self, *arguments: object) -> Ran:
        """Run it with these arguments."""
        self._monkeypatch.setattr(sys, "argv", ["vedette", *self._command, *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        captured = self._capsys.readouterr()
        code = ended.value.code
        return Ran(code if isinstance(code, int) else 0, captured.out, captured.err)


def start(arguments: list[str], folder: Path, **environment: str) -> subprocess.Popen[bytes]:
    """Start ``vedette`` in a process of its own, in a folder."""
    return subprocess.Popen(
        [sys.executable, "-c", "from vedette.cli import main; main()", *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | environment,
    )


def refused(ran: Ran, *words: str) -> None:
    """One line on stderr with these words, status 2, nothing else said, nothing written."""
    assert ran.status == 2, ran
    assert ran.out == ""
    assert len(ran.err.splitlines()) == 1, ran.err
    assert ran.err.startswith("vedette: ")
    for word in words:
        assert word in ran.err, ran.err
    assert not Path("out").exists()
    assert not Path("runs").exists()


def check_files(folder: Path, command: str) -> None:
    """Everything that the command leaves is there and loads."""
    assert {path.name for path in folder.iterdir()} >= FILES[command]
    for name in FILES[command]:
        if name.endswith(".png"):
            with Image.open(folder / name) as image:
                image.load()
                assert min(image.size) > 100
        elif name.endswith(".json"):
            valid("timing" if name == "timing.json" else f"{command}-summary", (folder / name).read_bytes())
        elif name == "map.yaml":
            read_map(folder / name)
    with (folder / "run.mcap").open("rb") as file:
        assert sum(1 for _ in make_reader(file).iter_messages()) > 0
