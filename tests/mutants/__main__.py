"""``python -m tests.mutants``: a random sample of mutants, tested piece by piece; those nobody noticed."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import reduce
from operator import or_

import click
from scipy.stats import binomtest

from tests.mutants import python, rust, tree
from tests.mutants.cover import Cover
from tests.mutants.sample import Sample, draw
from tests.mutants.trial import QUIET, Trial
from tests.mutants.worker import Worker

SAMPLE = tree.WORK / "sample.json"
COVER = tree.WORK / "cover"
TESTS = (
    "problem", "negotiation", "fusion", "overlay", "kernels", "agent", "domains", "stonesoup", "missions",
    "sim", "run", "reproduction",
)  # fmt: skip


def sample_of(seed: int | None, count: int) -> Sample:
    """Go on with the sample there is, or make all mutants and draw one."""
    if SAMPLE.exists():
        sample = Sample.load(SAMPLE)
        if seed in (None, sample.seed) and len(sample.diffs) == min(count, sample.of):
            return sample
    commit = tree.copy()
    diffs = rust.mutants() | dict.fromkeys(python.mutants(), "")
    sample = draw(random.randrange(10**6) if seed is None else seed, count, commit, diffs)
    sample.save(SAMPLE)
    return sample


def cover_of() -> Cover:
    """Return which tests come by which line, for which they run once as things are, a folder at a time."""
    COVER.mkdir(exist_ok=True)
    env = os.environ | {"PYTHONPATH": "src:reproduction"}
    for name in TESTS:
        words = [sys.executable, "-m", "tests.mutants.cover", str(COVER / name), *QUIET, f"tests/{name}"]
        if not (COVER / name).exists():
            subprocess.run(words, cwd=tree.TREE, env=env, check=True)
    return reduce(or_, (Cover.load(COVER / name) for name in TESTS))


def go_on(sample: Sample, workers: list[Callable[[str, str], Trial]], minutes: float) -> None:
    """Let the workers test what is left until the time is over; the first has the kernels' mutants first."""
    end = time.monotonic() + 60.0 * minutes
    left = sorted(sample.left, key=lambda name: not sample.diffs[name])
    lock = threading.Lock()

    def work(test: Callable[[str, str], Trial], place: int) -> None:
        while True:
            with lock:
                if not left or time.monotonic() > end:
                    return
                name = left.pop(place)
            trial = test(name, sample.diffs[name])
            with lock:
                sample.trials[name] = trial
                sample.save(SAMPLE)
                click.echo(f"{trial.verdict:8} {name}  {trial.by}")

    with ThreadPoolExecutor(len(workers)) as pool:
        running = [pool.submit(work, test, -min(k, 1)) for k, test in enumerate(workers)]
        try:
            for each in running:
                each.result()
        finally:
            left.clear()  # interrupted: those under way are the last


def told(sample: Sample) -> str:
    """Say how many were noticed, and which were not."""
    killed, tested = len(sample.tested) - len(sample.alive), len(sample.tested)
    low, high = binomtest(killed, tested).proportion_ci(method="wilson") if tested else (0.0, 1.0)
    return "\n".join(
        [f"{sample.trials[name].verdict}: {name}" for name in sample.alive]
        + [
            f"seed {sample.seed}, commit {sample.commit}: of {sample.of} mutants {len(sample.diffs)} drawn, "
            f"{tested} tested, {killed} killed (the rate is between {low:.1%} and {high:.1%}), "
            f"{len(sample.left)} left"
        ]
    )


@click.command()
@click.option("--seed", type=int, help="Of the sample.  [default: the last sample's, or any]")
@click.option("--count", type=click.IntRange(1), default=300, show_default=True, help="Mutants to draw.")
@click.option(
    "--minutes", type=click.FloatRange(0), default=30.0, show_default=True, help="Then begin no more."
)
def main(seed: int | None, count: int, minutes: float) -> None:
    """Draw mutants and test them, for so long; the same command goes on where it stopped."""
    sample = sample_of(seed, count)
    click.echo(f"seed {sample.seed}: {len(sample.left)} of {len(sample.diffs)} mutants to test")
    cover = cover_of()
    count = len(os.sched_getaffinity(0))
    go_on(sample, [Worker(tree.of_worker(k), cover).test for k in range(count)], minutes)
    click.echo(told(sample))


if __name__ == "__main__":
    main()
