"""Mutants of the kernels, listed by cargo-mutants; Python tests are run on each, the kernels' own first."""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
from typing import Any

from tests.mutants.tree import CRATE_AS_IT_WAS, TREE, WORK

_CRATE = TREE / "rust"
_KERNELS = TREE / "src/vedette/_kernels.abi3.so"
_TOOL = WORK / "cargo/bin/cargo-mutants"
_CPU = 240  # seconds of it: a mutant that takes more has no end
_FASTER_BUILD = {
    "CARGO_TARGET_DIR": str(WORK / "target"),
    "CARGO_INCREMENTAL": "1",
    "CARGO_PROFILE_RELEASE_LTO": "off",
    "CARGO_PROFILE_RELEASE_CODEGEN_UNITS": "16",
}


def mutants() -> dict[str, str]:
    """Return each mutant's name and diff; bindings that return some other array do not compile."""
    words = [
        str(_TOOL),
        "mutants",
        "--list",
        "--json",
        "--diff",
        "--exclude-re=PyResult",
        "--manifest-path",
        str(_CRATE / "Cargo.toml"),
    ]
    listed: list[dict[str, Any]] = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    return {f"rust/{each['name']}": str(each["diff"]) for each in listed}


def run(name: str, diff: str) -> str:
    """Put one mutant into the copy, build it and test it; return what became of it."""
    shutil.rmtree(_CRATE)
    shutil.copytree(CRATE_AS_IT_WAS, _CRATE)
    subprocess.run(["patch", "--quiet", name.split(":")[0]], cwd=TREE, input=diff, text=True, check=True)
    env = {**os.environ, "PYTHONPATH": "src"}
    build = ["cargo", "build", "--release", "--quiet", "--features", "extension-module"]
    if subprocess.run(build, cwd=_CRATE, env=env | _FASTER_BUILD, capture_output=True).returncode:
        return "unbuildable"
    _KERNELS.unlink()
    shutil.copy2(WORK / "target/release/lib_kernels.so", _KERNELS)
    tests = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-q",
        "-m",
        "not slow",
        "-p",
        "no:randomly",
        "--hypothesis-profile=ci",
    ]
    for folder in ("tests/kernels", "tests/domains"):
        done = subprocess.run([*tests, folder], cwd=TREE, env=env, capture_output=True, preexec_fn=_limit)
        if done.returncode:
            return "killed"
    return "survived"


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (_CPU, _CPU))
