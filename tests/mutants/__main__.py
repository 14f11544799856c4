"""``python -m tests.mutants``: a random sample of mutants, tested piece by piece; those nobody noticed."""

from __future__ import annotations

import json
import random
import time
from dataclasses import asdict, dataclass, field

import click

from tests.mutants import python, rust, tree

SAMPLE = tree.WORK / "sample.json"
SURVIVORS = tree.WORK / "survivors.txt"
LEAST = 60.0  # below so much time nothing more is begun [s]


@dataclass
class Sample:
    """The mutants drawn, and what became of them."""

    seed: int
    commit: str
    of: int  # mutants in all
    diffs: dict[str, str]  # of the kernels' mutants by name; "" of all others
    verdicts: dict[str, str] = field(default_factory=dict)

    @property
    def left(self) -> list[str]:
        """Those not tested yet."""
        return [name for name in self.diffs if name not in self.verdicts]

    def save(self) -> None:
        """Write it down."""
        SAMPLE.write_text(json.dumps(asdict(self), indent=1), encoding="utf-8")


def draw(seed: int, count: int, commit: str, diffs: dict[str, str]) -> Sample:
    """Draw so many of all mutants, each as likely as any other."""
    names = random.Random(seed).sample(sorted(diffs), min(count, len(diffs)))
    return Sample(seed, commit, len(diffs), {name: diffs[name] for name in names})


def sample_of(seed: int | None, count: int) -> Sample:
    """Go on with the sample there is, or make all mutants and draw one."""
    if SAMPLE.exists():
        sample = Sample(**json.loads(SAMPLE.read_text(encoding="utf-8")))
        if seed in (None, sample.seed) and len(sample.diffs) == min(count, sample.of):
            return sample
    commit = tree.copy()
    diffs = rust.mutants() | dict.fromkeys(python.mutants(), "")
    sample = draw(random.randrange(10**6) if seed is None else seed, count, commit, diffs)
    sample.save()
    return sample


def go_on(sample: Sample, minutes: float) -> None:
    """Test what is left until the time is over, half of it the kernels' mutants, each for itself."""
    end = time.monotonic() + 60.0 * minutes
    kernels = [each for each in sample.left if sample.diffs[each]]
    change = end - LEAST if len(kernels) == len(sample.left) else end - 30.0 * minutes
    for name in kernels:
        if time.monotonic() > change:
            break
        sample.verdicts[name] = rust.run(name, sample.diffs[name])
        sample.save()
    others = [each for each in sample.left if not sample.diffs[each]]
    if others and time.monotonic() < end - LEAST:
        sample.verdicts |= python.run(others, end - time.monotonic())
        sample.save()


def told(sample: Sample) -> str:
    """Say how many were noticed, and write the others down as diffs."""
    tested = {name: verdict for name, verdict in sample.verdicts.items() if verdict != "unbuildable"}
    alive = [name for name, verdict in tested.items() if verdict != "killed"]
    SURVIVORS.write_text(
        "".join(f"{tested[name]}: {sample.diffs[name] or python.shown(name)}\n" for name in alive),
        encoding="utf-8",
    )
    share = 1.0 - len(alive) / max(len(tested), 1)
    return (
        f"seed {sample.seed}, commit {sample.commit}: of {sample.of} mutants {len(sample.diffs)} drawn, "
        f"{len(tested)} tested, {len(tested) - len(alive)} killed ({share:.1%}), {len(sample.left)} left; "
        f"survivors: {SURVIVORS.relative_to(tree.ROOT)}"
    )


@click.command()
@click.option("--seed", type=int, help="Of the sample.  [default: the last sample's, or any]")
@click.option("--count", type=click.IntRange(1), default=300, show_default=True, help="Mutants to draw.")
@click.option("--minutes", type=click.FloatRange(1), default=30.0, show_default=True, help="Then stop.")
def main(seed: int | None, count: int, minutes: float) -> None:
    """Draw mutants and test them, for so long; the same command goes on where it stopped."""
    sample = sample_of(seed, count)
    click.echo(f"seed {sample.seed}: {len(sample.left)} of {len(sample.diffs)} mutants to test")
    go_on(sample, minutes)
    click.echo(told(sample))


if __name__ == "__main__":
    main()
