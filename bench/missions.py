"""``python -m bench.missions``: whole missions beside the yardsticks, in a table that can be gone on with."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from pathlib import Path
from typing import NoReturn, Protocol, TypeVar

import click
from joblib import Parallel, delayed

from bench import command, journal, machine
from bench.cases import Result, map_cases, office_cases, run_case
from bench.criteria import verdicts
from bench.missions_table import JUDGED, judge, missions_table
from vedette.domains.mapping.planners import planner
from vedette.errors import InputError
from vedette.outcome import Outcome
from vedette.record.files import write_text

CaseT = TypeVar("CaseT", bound="Todo")
EndedT = TypeVar("EndedT", bound=journal.Ended)


class Todo(Protocol):
    """A mission to run; as a word, it is named in a line of progress."""

    @property
    def key(self) -> Hashable:
        """What tells it from all others, whatever the commit."""


@click.command()
@click.option("--maps", type=Path, metavar="DIR", help="Run the maps of this folder too.")
@command.seeds_option("0-9", "Of the offices.")
@command.robots_option("1,3,6", "In the offices.")
@command.planners_option(f"{JUDGED},nearest,burgard")
@click.option("--only-offices", is_flag=True, help="Leave the maps out.")
@click.option("--only-maps", is_flag=True, help="Leave the offices out.")
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def missions(
    maps: Path | None,
    seeds: tuple[int, ...],
    robots: tuple[int, ...],
    planners: str,
    only_offices: bool,
    only_maps: bool,
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Run the table of missions; those that are in the results file already are not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    names = [planner_name(name) for name in planners.split(",")]
    cases = [] if only_maps else office_cases(seeds, robots, names)
    cases += [] if only_offices or maps is None else map_cases(maps, names)
    if not cases:
        raise InputError("nothing to run; --only-maps needs --maps DIR, and goes not with --only-offices")
    tabulate(cases, out, "missions", jobs, fresh, run_case, Result, report)


def tabulate(
    cases: Sequence[CaseT],
    out: Path,
    stem: str,
    jobs: int,
    fresh: bool,
    run: Callable[[CaseT, str], EndedT],
    kind: type[EndedT],
    table: Callable[[Sequence[EndedT]], str],
) -> NoReturn:
    """Run missions that ``STEM.jsonl`` does not hold, or all if ``fresh``; write ``STEM.md``; leave."""
    folder = command.results_folder(out)
    path, written = folder / f"{stem}.jsonl", folder / f"{stem}.md"
    if fresh:
        journal.forget(path, {case.key for case in cases}, kind)
    broken = conduct(cases, path, jobs, click.echo, run, kind)
    done = journal.read(path, kind)
    results = [done[case.key] for case in cases if case.key in done]
    if results:
        text = table(results)
        write_text(written, text)
        click.echo(f"\n{text}\nwritten: {written}")
    raise SystemExit(1 if broken else 0)


def planner_name(name: str) -> str:
    """Return the name without blanks around it.

    Raises:
        InputError: there is no such planner.
    """
    planner(name.strip())
    return name.strip()


def conduct(
    cases: Sequence[CaseT],
    path: Path,
    jobs: int,
    echo: Callable[[str], None],
    run: Callable[[CaseT, str], EndedT],
    kind: type[EndedT],
) -> int:
    """Run the missions that ``path`` does not hold yet and add them to it; return how many broke.

    ``run``: of a case and the commit.
    """
    done = journal.read(path, kind)
    left = [case for case in cases if case.key not in done]
    echo(f"{len(cases) - len(left)} of {len(cases)} missions done before; {len(left)} to run")
    began, broken = time.perf_counter(), 0
    for count, (case, end) in enumerate(_ends(left, jobs, run), start=1):
        if isinstance(end, kind):
            journal.append(path, end)
            told = f"{end.outcome} after {end.time_s:.0f} s"
        else:
            broken += 1
            told = f"broke: {end!r}"
        remaining = (time.perf_counter() - began) / count * (len(left) - count)
        echo(f"{count}/{len(left)}, {_minutes(remaining)} left: {case}: {told}")
    return broken


def _ends(
    cases: Sequence[CaseT], jobs: int, run: Callable[[CaseT, str], EndedT]
) -> Iterator[tuple[CaseT, EndedT | Exception]]:
    """Yield the missions as they end, in any order."""
    commit = machine.commit()
    parallel = Parallel(n_jobs=jobs, return_as="generator_unordered")
    yield from parallel(delayed(_guarded)(run, case, commit) for case in cases)


def _guarded(
    run: Callable[[CaseT, str], EndedT], case: CaseT, commit: str
) -> tuple[CaseT, EndedT | Exception]:
    """Run one mission; one that breaks must not take the others with it."""
    try:
        result = run(case, commit)
    except Exception as error:
        return case, error
    if result.outcome == Outcome.INTERRUPTED:
        raise KeyboardInterrupt  # half a mission is no result
    return case, result


def report(results: Sequence[Result]) -> str:
    """Return the two tables, and which commits they stand for."""
    commits = ", ".join(sorted({result.commit for result in results}))
    text = missions_table(results)
    criteria = judge(results)
    if criteria:
        text += f"\nWhat {JUDGED} must reach in every mission:\n\n{verdicts(criteria)}"
    return f"{text}\nCommit: {commits}\n"


def _minutes(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{seconds:.0f} s"


if __name__ == "__main__":
    command.run(missions, "bench.missions")
