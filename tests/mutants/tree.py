"""Copies of the project that faults are put into, so that work on the project itself can go on."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
WORK = ROOT / "build" / "mutants"
TREE = WORK / "tree"  # stays as it was copied
KERNELS = "src/vedette/_kernels.abi3.so"


def copy() -> str:
    """Copy what git knows, as it stands, and the compiled kernels; return the commit."""
    shutil.rmtree(WORK, ignore_errors=True)
    for line in git("ls-files").splitlines():
        if (ROOT / line).is_file():
            (TREE / line).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / line, TREE / line)
    shutil.copy2(ROOT / KERNELS, TREE / KERNELS)
    return git("rev-parse", "--short", "HEAD").strip()


def of_worker(k: int) -> Path:
    """Return a copy of the copy for one worker, as the copy is."""
    return Path(shutil.copytree(TREE, WORK / f"worker-{k}", dirs_exist_ok=True))


def restore(copy: Path, name: str) -> None:
    """Take a mutant out of a worker's copy; times stay, so what was compiled of the file holds again."""
    for file in (name.split(":")[0], KERNELS):
        (copy / file).unlink()
        shutil.copy2(TREE / file, copy / file)


def git(*words: str) -> str:
    """Return what git says of the project."""
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout
