"""``vedette new domain``: what it writes runs as it is, in the simulator and as two processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.commands import Command, refused, start
from tests.support.net_team import real_time
from tests.support.places import ROOT
from tests.support.schemas import valid

PATIENCE = 240.0  # for what takes some ten seconds on an idle machine [s]


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, "new", "domain")


def test_a_new_domain_runs_in_the_simulator_and_passes_its_own_tests(vedette: Command) -> None:
    made = vedette("wild_geese")
    assert made.out == ("cd wild_geese && vedette wild_geese:WildGeese wild_geese.yaml && python -m pytest\n")
    folder = Path("wild_geese")
    assert {path.name for path in folder.iterdir()} == {
        "wild_geese.py",
        "wild_geese.yaml",
        "test_wild_geese.py",
    }
    assert "keleton" not in (folder / "wild_geese.py").read_text()
    process = start(
        ["wild_geese:WildGeese", "wild_geese.yaml", "--no-compare", "--json", "--out", "out"], folder
    )
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    summary = valid("own-summary", out)
    assert (summary["domain"], summary["scenario"]) == ("wild_geese:WildGeese", "wild_geese")
    assert summary["figures"] == {"unseen": 0.0}
    assert {"ways.png", "curves.png", "run.mcap"} <= {path.name for path in (folder / "out").iterdir()}
    tested = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:randomly"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": ""},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert "2 passed" in tested.stdout, tested.stdout


@real_time
@pytest.mark.parametrize("of", ["skeleton", "example"])
def test_a_domain_of_ones_own_runs_on_two_processes(vedette: Command, of: str) -> None:
    if of == "skeleton":
        vedette("geese")
        folder, name, limit = Path("geese"), "geese:Geese", "88"
    else:
        folder, name, limit = Path(), "sound:Sound", "38"
        Path("sound.py").write_text((ROOT / "examples" / "sound.py").read_text(encoding="utf-8"))
    process = start(["team", name, "--speed", "5", "--max-time", limit, "--json", "--out", "out"], folder)
    out, err = process.communicate(timeout=PATIENCE)
    summary = json.loads(out)
    assert summary["lost"] == [], err
    assert summary["rounds"] > 2, "they have negotiated"
    assert min(sent["fusion"] for sent in summary["messages"].values()) > 0, "they have told each other"
    if of == "skeleton":
        assert summary["figures"]["unseen"] < 3.0
    else:
        assert summary["figures"]["deviation_m"] < 120.0  # of some 180 m without a sound


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("Geese",), "NAME must be a word in small letters, as my_domain; got 'Geese'"),
        (("class",), "NAME must be a word in small letters"),
        (("9geese",), "NAME must be a word in small letters"),
        (("json",), "there is a module json already, which would be found first; take another name"),
        (("none",), "NAME none would make a class None, which is something else"),
        (("theory",), "NAME theory would make a class Theory, which is something else"),
        (("geese", "--out", "there"), "there exists; choose another folder with --out"),
    ],
)
def test_what_cannot_be_a_new_domain_is_told_in_a_line(
    vedette: Command, words: tuple[str, ...], said: str
) -> None:
    Path("there").mkdir()
    refused(vedette(*words), said)
    assert list(Path("there").iterdir()) == []
