"""The copy of the project that faults are put into, so that work on the project itself can go on."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
WORK = ROOT / "build" / "mutants"
TREE = WORK / "tree"
CRATE_AS_IT_WAS = WORK / "rust"
TESTS = [
    f"tests/{name}" for name in ("problem", "negotiation", "fusion", "overlay", "agent", "domains", "kernels")
]


def copy() -> str:
    """Copy what git knows, as it stands, and the compiled kernels; return the commit."""
    shutil.rmtree(TREE, ignore_errors=True)
    for line in git("ls-files").splitlines():
        if (ROOT / line).is_file():
            (TREE / line).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / line, TREE / line)
    shutil.copy2(ROOT / "src/vedette/_kernels.abi3.so", TREE / "src/vedette")
    shutil.rmtree(CRATE_AS_IT_WAS, ignore_errors=True)
    shutil.copytree(TREE / "rust", CRATE_AS_IT_WAS)
    return git("rev-parse", "--short", "HEAD").strip()


def git(*words: str) -> str:
    """Return what git says of the project."""
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout
