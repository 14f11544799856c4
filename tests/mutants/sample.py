"""The sample of mutants: drawn once, tested piece by piece, and what became of each."""

from __future__ import annotations

import json
import random
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Self

from tests.mutants.trial import Trial
from vedette.record.files import write_text


@dataclass
class Sample:
    """The mutants drawn, and what became of them."""

    seed: int
    commit: str
    of: int  # mutants in all
    diffs: dict[str, str]  # of the kernels' mutants by name; "" of all others
    trials: dict[str, Trial] = field(default_factory=dict)

    @property
    def left(self) -> list[str]:
        """Those not tested yet."""
        return [name for name in self.diffs if name not in self.trials]

    @property
    def tested(self) -> dict[str, Trial]:
        """Those of which a trial says something."""
        return {
            name: each for name, each in self.trials.items() if each.verdict not in ("unbuildable", "unended")
        }

    @property
    def alive(self) -> list[str]:
        """Those tested that no test noticed."""
        return [name for name, each in self.tested.items() if each.verdict in ("survived", "no tests")]

    def save(self, path: Path) -> None:
        """Write it down, so that whoever is interrupted has the last that was written."""
        write_text(path, json.dumps(asdict(self), indent=1))

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read what :meth:`save` wrote."""
        read = json.loads(path.read_text(encoding="utf-8"))
        read["trials"] = {name: Trial(**each) for name, each in read["trials"].items()}
        return cls(**read)


def draw(seed: int, count: int, commit: str, diffs: dict[str, str]) -> Sample:
    """Draw so many of all mutants, each as likely as any other."""
    names = random.Random(seed).sample(sorted(diffs), min(count, len(diffs)))
    return Sample(seed, commit, len(diffs), {name: diffs[name] for name in names})
