"""``python -m tests.fuzz [--seconds 60] [TARGET...]``: fuzz targets one by one and say what was found."""

from __future__ import annotations

import argparse
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

from tests.fuzz.engine import fuzz

BUILD = Path("build") / "fuzz"
GRACE = 120  # [s] for a process to start and end


def main() -> int:
    """Return 1 if anything broke, else 0."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument(
        "targets", nargs="*", metavar="TARGET", help="all, unless named; parts of names will do"
    )
    parser.add_argument("--seconds", type=int, default=60, help="for each target (default 60)")
    parser.add_argument("--list", action="store_true", help="list the targets")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if importlib.util.find_spec("atheris") is None and not options.list:
        parser.error("Atheris is not installed; run: pip install -e '.[fuzz]'")
    if options.child:
        fuzz(options.targets[0], options.seconds, BUILD / options.targets[0])
    names = _chosen(options.targets)
    if not names:
        parser.error(f"no such target: {' '.join(options.targets)}; --list lists them")
    if options.list:
        print("\n".join(names))
        return 0
    print(f"{'target':32}{'executions':>12}{'edges':>8}{'inputs':>8}  defects", flush=True)
    return int(sum([_fuzzed(name, options.seconds) for name in names]) > 0)


def _chosen(parts: list[str]) -> list[str]:
    from tests.fuzz.targets import targets  # not on top: the child's imports are instrumented

    return [name for name in targets() if not parts or any(part in name for part in parts)]


def _fuzzed(name: str, seconds: int) -> int:
    """Fuzz one target in a process of its own, which libFuzzer ends; return the number of defects."""
    folder = BUILD / name
    folder.mkdir(parents=True, exist_ok=True)
    told = folder / "defects.txt"
    told.unlink(missing_ok=True)
    (folder / "swept.txt").write_text("0", encoding="utf-8")
    command = [sys.executable, "-m", "tests.fuzz", name, "--child", "--seconds", str(seconds)]
    with (folder / "log.txt").open("wb") as log:
        try:
            code = subprocess.run(command, stderr=log, stdout=log, timeout=seconds + GRACE).returncode
        except subprocess.TimeoutExpired:
            code = -1
    log_text = (folder / "log.txt").read_text(encoding="utf-8", errors="replace")
    defects = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    if code != 0:
        defects.append(f"the process ended with {code}; see {folder / 'log.txt'}")
    edges = re.findall(r"cov: (\d+)", log_text)
    runs = re.findall(r"(?:stat::number_of_executed_units: |^#)(\d+)", log_text, re.MULTILINE)
    executions = int((folder / "swept.txt").read_text(encoding="utf-8")) + int(runs[-1] if runs else 0)
    inputs = len(list((folder / "corpus").glob("*")))
    print(f"{name:32}{executions:>12}{edges[-1] if edges else 0:>8}{inputs:>8}  {len(defects)}")
    for defect in defects:
        print(f"    {defect}", flush=True)
    return len(defects)


if __name__ == "__main__":
    sys.exit(main())
