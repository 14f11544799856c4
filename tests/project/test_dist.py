"""What ``make dist`` builds: the wheels hold what their names say, and work in environments of their own."""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.support.places import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TESTED = (ROOT / "constraints.txt").read_text(encoding="utf-8")
LOWEST = "\n".join(  # NumPy 1.26.4 among them: what Ubuntu 24.04, and ROS Jazzy with it, has
    re.sub(r"^([\w-]+)>=([\d.]+).*$", r"\1==\2", line) for line in PROJECT["dependencies"]
)
MACHINES = {"x86_64": 62, "aarch64": 183}  # e_machine of an ELF file
MISSION = ("explore", "--robots", "2", "--seed", "1", "--max-time", "20", "--out", "short", "--json")
README = (ROOT / "README.md").read_text(encoding="utf-8")
NEGOTIATION = re.search(r"```python\n((?:(?!```).)*)```\n\n```text\n(.*?)```", README, re.DOTALL)


def run(*command: str | Path, cwd: Path = ROOT, status: int = 0) -> str:
    """Run a command that knows nothing of this environment, and return what it prints."""
    hidden = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
    done = subprocess.run(
        command,
        cwd=cwd,
        env={name: value for name, value in os.environ.items() if name not in hidden},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=3600,
        check=False,
    )
    assert done.returncode == status, f"{command}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with all that ``make dist`` builds here."""
    folder = tmp_path_factory.mktemp("dist")
    run("make", "dist", f"DIST={folder}")
    return folder


@pytest.mark.slow
def test_there_are_an_sdist_and_wheels_for_the_processors_that_they_are_named_after(built: Path) -> None:
    version = PROJECT["version"]
    assert (built / f"vedette-{version}.tar.gz").is_file()
    wheels = list(built.glob("*.whl"))
    assert os.uname().machine in {processor(wheel) for wheel in wheels}
    for wheel in wheels:
        assert wheel.name.startswith(f"vedette-{version}-cp311-abi3-manylinux_2_28_")
        with zipfile.ZipFile(wheel) as files:
            module = files.read("vedette/_kernels.abi3.so")
        assert module[:4] == b"\x7fELF"
        assert struct.unpack_from("<H", module, 18) == (MACHINES[processor(wheel)],)


def processor(wheel: Path) -> str:
    """Return the processor that a wheel's name ends with."""
    return wheel.stem.partition("manylinux_2_28_")[2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "constraints"),
    [("*.whl", TESTED), ("*.whl", LOWEST), ("*.tar.gz", TESTED)],
    ids=["wheel, tested versions", "wheel, lowest versions", "source, tested versions"],
)
def test_it_works_in_an_environment_of_its_own(
    built: Path, tmp_path: Path, what: str, constraints: str
) -> None:
    [package] = [path for path in built.glob(what) if processor(path) in ("", os.uname().machine)]
    (tmp_path / "constraints.txt").write_text(constraints)
    run(sys.executable, "-m", "venv", tmp_path / "venv")
    binaries = tmp_path / "venv" / "bin"
    run(binaries / "pip", "install", "-q", "-c", tmp_path / "constraints.txt", package, cwd=tmp_path)

    assert PROJECT["version"] in run(binaries / "vedette", "--version", cwd=tmp_path)
    assert "explore" in run(binaries / "vedette", "--help", cwd=tmp_path)
    assert NEGOTIATION is not None
    assert run(binaries / "python", "-c", NEGOTIATION[1], cwd=tmp_path) == NEGOTIATION[2]
    here = run(sys.executable, "-m", "vedette", *MISSION[:-3], "--json", cwd=tmp_path, status=1)
    assert run(binaries / "vedette", *MISSION, cwd=tmp_path, status=1) == here


def executable(path: Path, body: str) -> None:
    """Write a shell script that can be run."""
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)


@pytest.mark.skipif(Path("/usr/bin/rustc").exists(), reason="that one may have what is to be missing")
def test_a_processor_that_rust_has_no_standard_library_for_gets_no_wheel_and_one_line_says_so(
    tmp_path: Path,
) -> None:
    (tmp_path / "x86_64-unknown-linux-gnu").mkdir()
    executable(tmp_path / "rustc", f'echo "{tmp_path}/$4"')  # rustc --print target-libdir --target TARGET
    executable(tmp_path / "maturin", 'echo "$*"')
    done = subprocess.run(
        [ROOT / "tools" / "dist.sh", "folder"],
        env={"PATH": f"{tmp_path}{os.pathsep}{os.defpath}"},
        capture_output=True,
        text=True,
        timeout=20,
        check=True,
    )
    sdist, wheel = done.stdout.splitlines()
    assert sdist.startswith("sdist ")
    assert "--target x86_64-unknown-linux-gnu" in wheel
    [line] = done.stderr.splitlines()
    assert "no wheel for aarch64" in line
    assert (ROOT / line.split("; ")[1].split()[0]).is_file()
