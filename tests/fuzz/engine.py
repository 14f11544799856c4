"""Coverage-guided fuzzing of one target, in a process of its own: libFuzzer by way of Atheris.

Only this module needs Atheris, which is in the optional dependencies ``fuzz``.
"""

from __future__ import annotations

import importlib
import itertools
import resource
import sys
import time
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from tests.fuzz.mutation import sweep

MEMORY_MARGIN = 1 << 30  # [bytes] that the process may grow by: an input that asks for more fails at once
TRACED = 16  # the memory of one input in so many is measured: that takes several times as long
NATIVE = 0.25  # share of mutations left to libFuzzer


def fuzz(name: str, seconds: int, folder: Path) -> None:
    """Fuzz a target, half of the time at most with every field at awkward values; does not return.

    New inputs go to ``folder/corpus``, those that break something to ``folder/defects``.
    """
    atheris: Any = importlib.import_module("atheris")
    with atheris.instrument_imports(include=["vedette"]):
        targets = importlib.import_module("tests.fuzz.targets").targets()
    target = targets[name]
    corpus, defects = folder / "corpus", folder / "defects"
    for each in (corpus, defects):
        each.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(target.seeds()):
        (corpus / f"seed-{number}").write_bytes(seed)
    _limit_memory()
    found: set[tuple[str, str]] = set()

    def one(data: bytes) -> None:
        defect = target.check(data, memory=zlib.crc32(data) % TRACED == 0)
        if defect is not None and (defect.kind, defect.place) not in found:
            found.add((defect.kind, defect.place))
            (defects / f"{zlib.crc32(data):08x}").write_bytes(data)
            with (folder / "defects.txt").open("a", encoding="utf-8") as file:
                file.write(f"{zlib.crc32(data):08x} {defect}\n")

    def mutate(data: bytes, most: int, seed: int) -> bytes:
        rng = np.random.default_rng(seed)
        new = atheris.Mutate(data, most) if rng.random() < NATIVE else target.mutate(data, rng)
        return bytes(new[:most])

    began, swept = time.monotonic(), 0
    for data in itertools.chain.from_iterable(map(sweep, target.seeds())):
        if time.monotonic() > began + seconds / 2:
            break
        one(data)
        swept += 1
    (folder / "swept.txt").write_text(str(swept), encoding="utf-8")
    left = max(1, round(seconds - (time.monotonic() - began)))
    options = [
        f"-max_total_time={left}",
        "-max_len=16384",
        "-timeout=60",
        "-print_final_stats=1",
        "-close_fd_mask=1",
    ]
    options += ["-rss_limit_mb=0", "-len_control=0", f"-artifact_prefix={folder}/", str(corpus)]
    atheris.Setup(
        [sys.argv[0], *options, *(str(path.parent) for path in target.kept[:1])], one, custom_mutator=mutate
    )
    atheris.Fuzz()


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MEMORY_MARGIN,) * 2)
