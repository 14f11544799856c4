"""``python -m tests.mutants.cover FILE WORDS...``: runs pytest once, writes which test comes by what."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

import coverage
import pytest

if TYPE_CHECKING:
    from collections.abc import Generator

NO_TEST = ""  # coverage's word for what ran outside of tests: while modules were imported


@dataclass(frozen=True)
class Cover:
    """Which tests come by which lines, and how long they take."""

    seconds: dict[str, float]  # by test; only those that passed
    lines: dict[str, dict[int, list[str]]]  # tests by file and line

    def by(self, file: str, line: int) -> set[str]:
        """Return the tests that come by a line; those that come by any of the file if importing it does."""
        known = self.lines.get(file, {})
        found = set(known.get(line, ()))
        if NO_TEST in found:
            found = {test for tests in known.values() for test in tests}
        return found & self.seconds.keys()

    def whole_files(self, tests: list[str]) -> list[str]:
        """Return all tests of these tests' files, as they ran, the quickest file first.

        For what one of them prepares may be looked at by another.
        """
        total: dict[str, float] = dict.fromkeys(map(_file, tests), 0.0)
        chosen = [test for test in self.seconds if _file(test) in total]
        for test in chosen:
            total[_file(test)] += self.seconds[test]
        return sorted(chosen, key=lambda test: (total[_file(test)], _file(test)))

    def __or__(self, other: Cover) -> Cover:
        """Return what both tell."""
        lines = {
            file: {line: list(tests) for line, tests in known.items()} for file, known in self.lines.items()
        }
        for file, known in other.lines.items():
            for line, tests in known.items():
                lines.setdefault(file, {}).setdefault(line, []).extend(tests)
        return Cover(self.seconds | other.seconds, lines)

    def save(self, path: Path) -> None:
        """Write it down, each test's name once."""
        names = sorted(
            {NO_TEST, *self.seconds, *(t for ls in self.lines.values() for ts in ls.values() for t in ts)}
        )
        number = {name: k for k, name in enumerate(names)}
        lines = {
            file: {line: [number[test] for test in tests] for line, tests in known.items()}
            for file, known in self.lines.items()
        }
        path.write_text(
            json.dumps({"names": names, "seconds": self.seconds, "lines": lines}), encoding="utf-8"
        )

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read what :meth:`save` wrote."""
        read = json.loads(path.read_text(encoding="utf-8"))
        lines = {
            file: {int(line): [read["names"][k] for k in tests] for line, tests in known.items()}
            for file, known in read["lines"].items()
        }
        return cls(read["seconds"], lines)


def _file(test: str) -> str:
    return test.split("::")[0]


@dataclass
class Recorder:
    """A plugin for pytest: tells coverage which test runs, and keeps how long each took."""

    measured: coverage.Coverage
    seconds: dict[str, float] = field(default_factory=dict)
    failed: set[str] = field(default_factory=set)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Measure one test, what is prepared for it included."""
        self.measured.switch_context(item.nodeid)
        try:
            return (yield)
        finally:
            self.measured.switch_context(NO_TEST)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add up one test's parts; one that fails as things are tells nothing of a mutant."""
        self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration
        if not report.passed:
            self.failed.add(report.nodeid)

    def cover(self, root: Path) -> Cover:
        """Return what was recorded, files named from the root."""
        data = self.measured.get_data()
        lines = {
            str(Path(file).relative_to(root)): data.contexts_by_lineno(file) for file in data.measured_files()
        }
        return Cover({test: s for test, s in self.seconds.items() if test not in self.failed}, lines)


def main(path: Path, words: list[str]) -> None:
    """Run the tests in this folder and write what they come by."""
    measured = coverage.Coverage(data_file=None, source=["src/vedette"], config_file=False)
    recorder = Recorder(measured)
    measured.start()
    code = pytest.main([*words, "-p", "no:cacheprovider", "-p", "no:randomly"], plugins=[recorder])
    measured.stop()
    print(f"pytest ended with {code}; not used: {sorted(recorder.failed) or 'none'}")
    recorder.cover(Path.cwd()).save(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
