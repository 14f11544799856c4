"""Mutants of the kernels, listed by cargo-mutants; each is built on what the last build left."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

from tests.mutants import tree

_TOOL = tree.WORK.parent / "cargo-mutants/bin/cargo-mutants"
_FASTER_BUILD = {
    "CARGO_INCREMENTAL": "1",
    "CARGO_PROFILE_RELEASE_LTO": "off",
    "CARGO_PROFILE_RELEASE_CODEGEN_UNITS": "64",
}


def mutants() -> dict[str, str]:
    """Return each mutant's name and diff; bindings that return some other array do not compile."""
    manifest = str(tree.TREE / "rust/Cargo.toml")
    words = [
        _TOOL,
        "mutants",
        "--list",
        "--json",
        "--diff",
        "--exclude-re=PyResult",
        "--manifest-path",
        manifest,
    ]
    listed: list[dict[str, Any]] = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    return {f"rust/{each['name']}": str(each["diff"]) for each in listed}


def put(copy: Path, name: str, diff: str) -> bool:
    """Put one mutant into a worker's copy and build it; return whether it can be built."""
    subprocess.run(["patch", "--quiet", name.split(":")[0]], cwd=copy, input=diff, text=True, check=True)
    build = ["cargo", "build", "--release", "--quiet", "--features", "extension-module"]
    env = os.environ | _FASTER_BUILD | {"CARGO_TARGET_DIR": str(copy / "target")}
    if subprocess.run(build, cwd=copy / "rust", env=env, capture_output=True).returncode:
        return False
    (copy / tree.KERNELS).unlink()
    shutil.copy2(copy / "target/release/lib_kernels.so", copy / tree.KERNELS)
    return True


def calls_of(name: str) -> list[tuple[str, int]]:
    """Return file and line of each call of a kernel that a mutant can make a difference to.

    Those are the kernels of its topic, and of topics that use it, themselves or by way of others.
    """
    sources: dict[str, str] = {}
    for path in sorted((tree.TREE / "rust/src").rglob("*.rs")):
        topic = _topic(str(path.relative_to(tree.TREE)))
        sources[topic] = sources.get(topic, "") + path.read_text(encoding="utf-8")
    topics, grown = set[str](), {_topic(name.split(":")[0])}
    while topics != grown:
        topics = grown
        grown = topics | {
            each for each, text in sources.items() if any(f"crate::{t}::" in text for t in topics)
        }
    kernels = {
        each for topic in topics for each in re.findall(r'#\[pyfunction\(name = "(\w+)"', sources[topic])
    }
    return [
        (str(path.relative_to(tree.TREE)), number)
        for path in sorted((tree.TREE / "src/vedette/kernels").glob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if kernels.intersection(re.findall(r"_kernels\.(\w+)", line))
    ]


def _topic(file: str) -> str:
    return Path(file).relative_to("rust/src").parts[0].removesuffix(".rs")
