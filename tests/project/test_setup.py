"""The set-up: what a bare machine is told, and the rules that no linter checks."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

from tests.support.places import ROOT

PREFLIGHT = ROOT / "tools" / "preflight.sh"

PYTHON_NEW = """case "$*" in *platform*) echo 3.12.1 ;; esac"""
PYTHON_OLD = """case "$*" in *version_info*) exit 1 ;; *platform*) echo 3.9.2 ;; esac"""
PYTHON_BARE = """case "$*" in *ensurepip*) exit 1 ;; esac"""  # as Debian has it without python3-venv
PYTHON_STUB = "exit 1"  # a shim that only says where to get Python
RUSTC = "echo 'rustc 1.85.0 (4d91de4e4 2025-02-17)'"
READY = {"python3": PYTHON_NEW, "cargo": "echo cargo", "rustc": RUSTC, "cc": "echo cc"}


def preflight(
    machine: Path, programs: dict[str, str], environment: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run the preflight check in ``machine``, on whose PATH are ``programs`` (name -> body) and no others."""
    binaries = machine / "bin"
    binaries.mkdir()
    for name, body in programs.items():
        executable(binaries / name, body)
    return subprocess.run(
        ["/bin/sh", str(PREFLIGHT)],
        cwd=machine,
        env={"PATH": str(binaries), "HOME": str(machine)} | (environment or {}),
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )


def executable(path: Path, body: str) -> None:
    """Write a shell script that can be run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)


def test_a_machine_that_has_all_is_told_only_its_python(tmp_path: Path) -> None:
    result = preflight(tmp_path, READY)
    assert (result.returncode, result.stdout, result.stderr) == (0, "python3\n", "")


@pytest.mark.parametrize("first", [PYTHON_OLD, PYTHON_BARE, PYTHON_STUB])
def test_a_newer_python_is_found_when_python3_will_not_do(tmp_path: Path, first: str) -> None:
    result = preflight(
        tmp_path, READY | {"python3": first, "python3.12": PYTHON_NEW, "python3.11": PYTHON_NEW}
    )
    assert (result.returncode, result.stdout) == (0, "python3.12\n")


def test_the_python_that_the_user_names_is_taken(tmp_path: Path) -> None:
    mine = tmp_path / "mine" / "python"
    executable(mine, PYTHON_NEW)
    assert preflight(tmp_path, READY, {"PYTHON": str(mine)}).stdout == f"{mine}\n"


def test_a_python_that_the_user_names_is_not_replaced_by_another(tmp_path: Path) -> None:
    result = preflight(tmp_path, READY, {"PYTHON": "/no/such/python"})
    assert result.returncode == 1
    assert "Python not found (tried /no/such/python)" in result.stderr


def test_an_environment_of_an_old_python_is_named(tmp_path: Path) -> None:
    executable(tmp_path / ".venv" / "bin" / "python", PYTHON_OLD)
    result = preflight(tmp_path, READY)
    assert result.returncode == 1
    assert "make clean" in result.stderr


WANTING = {
    "python missing": ({"python3": None}, "Python not found", "install Python 3.11"),
    "python is a shim": ({"python3": PYTHON_STUB}, "Python not found", "install Python 3.11"),
    "python too old": ({"python3": PYTHON_OLD}, "Python 3.9.2, too old", "PYTHON=/path/to/python3"),
    "python without venv": ({"python3": PYTHON_BARE}, "venv and ensurepip", "apt install python3-venv"),
    "cargo missing": ({"cargo": None}, "cargo not found", "https://rustup.rs"),
    "cargo without toolchain": ({"cargo": "exit 1"}, "cargo does not run", "rustup default stable"),
    "rustc missing": ({"rustc": None}, "rustc not found", "https://rustup.rs"),
    "rustc too old": (
        {"rustc": "echo 'rustc 1.84.1 (e71f9a9a9 2025-01-27)'"},
        "1.84.1, too old",
        "rustup update",
    ),
    "rustc without toolchain": ({"rustc": "exit 1"}, "rustc does not run", "rustup default stable"),
    "linker missing": ({"cc": None}, "no C linker (cc)", "apt install gcc"),
    "linker is a shim": ({"cc": "exit 1"}, "no C linker (cc)", "apt install gcc"),
}


@pytest.mark.parametrize(("change", "complaint", "remedy"), WANTING.values(), ids=WANTING.keys())
def test_what_is_missing_is_named_in_one_line_with_its_remedy(
    tmp_path: Path, change: dict[str, str | None], complaint: str, remedy: str
) -> None:
    programs = {name: body for name, body in (READY | change).items() if body is not None}
    result = preflight(tmp_path, programs)
    assert result.returncode == 1
    assert result.stdout == ""
    [line] = result.stderr.splitlines()
    assert complaint in line
    assert remedy in line


@pytest.mark.parametrize("release", ["1.85.0", "1.100.2-nightly", "2.0.0-beta.1"])
def test_later_rust_is_accepted(tmp_path: Path, release: str) -> None:
    result = preflight(tmp_path, READY | {"rustc": f"echo 'rustc {release} (0123abcd 2027-01-01)'"})
    assert (result.returncode, result.stderr) == (0, "")


def test_all_that_is_missing_is_named_at_once(tmp_path: Path) -> None:
    result = preflight(tmp_path, {})
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) == 3


def test_rust_that_is_installed_but_not_on_the_path_is_pointed_out(tmp_path: Path) -> None:
    executable(tmp_path / ".cargo" / "bin" / "cargo", "echo cargo")
    result = preflight(tmp_path, {name: READY[name] for name in ("python3", "cc")})
    assert ". ~/.cargo/env" in result.stderr


def test_the_preflight_asks_for_the_versions_that_the_project_declares() -> None:
    text = PREFLIGHT.read_text()
    python = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    rust = tomllib.loads((ROOT / "rust" / "Cargo.toml").read_text())["package"]["rust-version"]
    assert f"PYTHON_MINOR={python.removeprefix('>=3.')}\n" in text
    assert f"RUST_MINOR={rust.removeprefix('1.')}\n" in text


def test_every_requirement_has_a_tested_version() -> None:
    command = [sys.executable, str(ROOT / "tools" / "requirements.py"), "dev"]
    asked = subprocess.run(command, capture_output=True, text=True, check=True, timeout=20).stdout.split()
    pinned = {line.split("==")[0].lower() for line in (ROOT / "constraints.txt").read_text().splitlines()}
    assert {line.split(">=")[0].split("[")[0].lower() for line in asked} <= pinned


def test_one_version_is_stated_everywhere() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    crate = tomllib.loads((ROOT / "rust" / "Cargo.toml").read_text())["package"]["version"]
    citation = (ROOT / "CITATION.cff").read_text()
    assert crate == version
    assert f"\nversion: {version}\n" in citation
    assert f"## [{version}]" in (ROOT / "CHANGELOG.md").read_text()


def test_only_the_kernels_package_opens_the_compiled_module() -> None:
    """The import contracts cannot see this: the compiled module is not in their graph."""
    package = ROOT / "src" / "vedette"
    openers = {path.relative_to(package).parts[0] for path in package.rglob("*.py") if opens_kernels(path)}
    assert openers == {"kernels"}


def opens_kernels(path: Path) -> bool:
    """Say whether a module imports ``vedette._kernels``, in any of the ways there are."""
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return any("_kernels" in name.split(".") for name in names)


def test_make_help_names_every_target_a_reader_needs() -> None:
    result = subprocess.run(
        ["make", "help"],
        cwd=ROOT,
        env=dict(os.environ),
        capture_output=True,
        text=True,
        check=True,
        timeout=20,
    )
    named = {line.split()[1] for line in result.stdout.splitlines()}
    assert named >= {"explore", "test", "test-all", "check", "bench", "missions", "build", "clean", "help"}


def test_the_hooks_that_git_may_call_are_make_targets_that_the_check_calls_too() -> None:
    [local] = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))["repos"]
    entries = [hook["entry"].split() for hook in local["hooks"]]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    [check] = re.findall(r"^check: (.*?) ##", makefile, flags=re.MULTILINE)
    assert entries == [["make", target] for target in check.split()]
    assert all(hook["language"] == "system" and not hook["pass_filenames"] for hook in local["hooks"])


def test_the_hooks_configuration_is_one_that_pre_commit_reads() -> None:
    command = [sys.executable, "-m", "pre_commit", "validate-config", str(ROOT / ".pre-commit-config.yaml")]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
