"""One worker: puts a mutant into its copy, and runs the tests that come by it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tests.mutants import python, rust, tree
from tests.mutants.cover import Cover
from tests.mutants.trial import Trial, run

_FIRST = 10.0  # the quickest tests, so long together, are run before the others are even collected [s]
_MOST = 60.0  # of tests for a mutant [s]


@dataclass(frozen=True)
class Worker:
    """A copy of the project, and which tests come by what."""

    tree: Path
    cover: Cover

    def test(self, name: str, diff: str) -> Trial:
        """Put one mutant in, test it, and take it out."""
        tests = self._tests(name, diff)
        if not tests:
            return Trial("no tests")
        try:
            if not (rust.put(self.tree, name, diff) if diff else python.put(self.tree, name)):
                return Trial("unbuildable")
            return self._trial(tests)
        finally:
            tree.restore(self.tree, name)

    def _trial(self, tests: list[str]) -> Trial:
        """Run the quickest tests that come by; if none notices, whole files with such tests, for a minute."""
        first = self._until(tests, _FIRST)
        trial = run(self.tree, first, self._seconds(first))
        if trial.verdict != "survived":
            return trial
        rest = self._until(self.cover.whole_files(tests), _MOST)
        return run(self.tree, rest, self._seconds(rest))

    def _until(self, tests: list[str], seconds: float) -> list[str]:
        """Return the first of them that take no longer together, one at least."""
        total, first = 0.0, []
        for test in tests:
            total += self.cover.seconds[test]
            if first and total > seconds:
                break
            first.append(test)
        return first

    def _seconds(self, tests: list[str]) -> float:
        return sum(self.cover.seconds[test] for test in tests)

    def _tests(self, name: str, diff: str) -> list[str]:
        """Return the tests that come by a mutant, the quickest first; those of kernels before all others."""
        places = (
            rust.calls_of(name) if diff else [(name.split(":")[0], line) for line in python.lines_of(name)]
        )
        found = {test for file, line in places for test in self.cover.by(file, line)}
        return sorted(
            found, key=lambda test: (not test.startswith("tests/kernels"), self.cover.seconds[test], test)
        )
