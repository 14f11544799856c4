"""A study: every combination once, results that survive a stop, and tables that are the same each time."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from rich.console import Console

from tests.support.schemas import valid
from vedette.cli.study import study
from vedette.errors import InputError
from vedette.sim.explore.run import explore
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import maze
from vedette.study import backends
from vedette.study.combinations import runs_of
from vedette.study.conduct import Conducted, conduct
from vedette.study.mission import RunResult, broken, carry_out, prepared
from vedette.study.outputs import write_outputs
from vedette.study.progress import StudyProgress, in_words
from vedette.study.provenance import Provenance, commit_of, fingerprint
from vedette.study.rows import figure_rows
from vedette.study.run import GeneratedWorld, Run, Value
from vedette.study.spec import Spec, find_spec, load_spec, shipped
from vedette.study.store import Store
from vedette.study.workers import Workers
from vedette.team import PlatformSpec

MADE = Provenance("vedette study tiny.yaml", "today", "0", "abc", "a machine", "3")
TINY = """
planners: [nearest, burgard]
worlds: [{kind: maze, seeds: [1, 2], width: 10, height: 10}]
robots: [2]
starts: [apart]
platform: {beams: 90, rate: 2}
setup: {max_time: 25}
"""


def written(tmp_path: Path, text: str = TINY) -> Path:
    path = tmp_path / "tiny.yaml"
    path.write_text(text)
    return path


def runs(tmp_path: Path, text: str = TINY) -> list[Run]:
    path = written(tmp_path, text)
    return runs_of(load_spec(path), path)


def quiet() -> Console:
    return Console(file=StringIO())


def made_up(run: Run) -> RunResult:
    """A result without a mission."""
    time = 10.0 * run.robots + run.setup.seed + len(run.setup.planner)
    figures: dict[str, Value] = {
        "outcome": "complete",
        "completed": True,
        "error": "",
        "coverage": 1.0,
        "time_s": time,
    }
    levels = dict.fromkeys(("t50_s", "t90_s", "t95_s", "t99_s", "auc_s"), time / 2)
    bounds = {f"bound_{name}": 1.0 for name in ("t50_s", "t90_s", "t95_s", "t99_s", "s", "auc_s")}
    costs = dict.fromkeys(("path_m", "path_max_m", "overlap", "seen_std_m2", "bytes_fusion"), 1.0)
    known = {**figures, **levels, **bounds, **costs}
    return RunResult(known, {"wall_s": 1.0}, (0.0, time), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0))


class Counting:
    """Carries out runs without missions, and counts them; breaks or stops where told."""

    def __init__(self, stop_after: int = 10**6, breaking: str = "") -> None:
        self.done: list[Run] = []
        self._stop_after, self._breaking = stop_after, breaking

    def __call__(self, run: Run) -> RunResult:
        """Make a result up."""
        if len(self.done) == self._stop_after:
            raise KeyboardInterrupt
        self.done.append(run)
        return broken(ValueError("no way")) if run.setup.planner == self._breaking else made_up(run)


def conducted(all_runs: list[Run], out: Path, work: Counting) -> Conducted:
    return conduct(all_runs, Store.open(out, "abc"), Workers(1, work=work), quiet())


# -- what is run --------------------------------------------------------------------------------------


def test_a_list_of_platforms_has_the_combinations_of_each(tmp_path: Path) -> None:
    text = """
planners: [tours]
worlds: [{kind: office}]
platform:
  - {view: [360, 180], range: 4}
  - {view: 90}
  - {view: [360, 90], beams: [8, 360]}
"""
    platforms = {(run.platform.view, run.platform.range, run.platform.beams) for run in runs(tmp_path, text)}
    assert platforms == {
        (360.0, 4.0, 360), (180.0, 4.0, 360), (90.0, 8.0, 360),
        (360.0, 8.0, 8), (360.0, 8.0, 360), (90.0, 8.0, 8),
    }  # fmt: skip


def test_every_combination_is_a_run_once(tmp_path: Path) -> None:
    text = """
planners: [tours, nearest, tours]
worlds: [{kind: office, seeds: [0, 1]}, {kind: cave}]
robots: [1, 3]
starts: [together, apart]
seeds: [0, 5]
platform: {range: [4, 8, 12], view: 180}
setup: {link_loss: [0, 0.3], max_time: 100}
"""
    found = runs(tmp_path, text)
    assert len(found) == len(set(found)) == 2 * 3 * 2 * 2 * 2 * 3 * 2
    assert {run.platform.range for run in found} == {4.0, 8.0, 12.0}
    assert {run.platform.view for run in found} == {180.0}
    assert {run.setup.link_loss for run in found} == {0.0, 0.3}
    keys = {run.key("code") for run in found}
    assert len(keys) == len(found)
    for first, second in zip(found[::2], found[1::2], strict=True):
        assert first.case == second.case
        assert {first.setup.planner, second.setup.planner} == {"tours", "nearest"}


def test_the_key_is_of_all_that_decides_a_run_and_of_the_code() -> None:
    run = Run(GeneratedWorld("maze", 1, 10.0, 10.0, 0.1), 2, "apart", PlatformSpec(), ExploreSetup())
    others = [
        replace(run, world=GeneratedWorld("maze", 2, 10.0, 10.0, 0.1)),
        replace(run, robots=3),
        replace(run, starts="together"),
        replace(run, platform=PlatformSpec(range=4.0)),
        replace(run, setup=ExploreSetup(planner="nearest")),
        replace(run, setup=ExploreSetup(kills=((0, 3.0),))),
    ]
    assert len({each.key("a") for each in (run, *others)}) == 7
    assert run.key("a") != run.key("b")
    assert run.case == others[4].case
    assert len({each.case for each in (run, *others)}) == 6


def test_a_map_is_known_by_its_cells_wherever_its_file_is(tmp_path: Path) -> None:
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        maze(np.random.default_rng(0), 10.0, 10.0).save(tmp_path / name)
    here, there = (
        runs(tmp_path, f"planners: [tours]\nmaps: [{{file: {name}/map.yaml}}]")[0]
        for name in ("here", "there")
    )
    assert here.key("a") == there.key("a")
    assert (here.world.name, there.world.name) == ("here", "there")


def test_kills_radio_and_faults_are_read_for_each_team(tmp_path: Path) -> None:
    text = "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {kills: [{}, {1: 60}], radio: [null, '12,3']}"
    found = runs(tmp_path, text)
    assert {run.setup.kills for run in found} == {(), ((0, 60.0),)}
    assert [run.setup.radio and run.setup.radio.range for run in found[:2]] == [None, 12.0]
    (tmp_path / "faults.yaml").write_text("faults: [{at: 5, fault: crash, robot: 2}]")
    (run,) = runs(tmp_path, "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {faults: faults.yaml}")
    assert run.setup.faults is not None
    assert run.setup.faults.faults[0].at == 5.0


MISTAKES = {
    "planners: [turs]\nworlds: [{kind: maze}]": "planners: unknown planner 'turs'; did you mean 'tours'?",
    "planners: []": "planners: must be a list of 1 or more words; got []",
    "planners: [tours]": "nothing to explore; list generated ones under worlds, or files under maps",
    "planners: [tours]\nworlds: [{kind: ofice}]": "worlds[0].kind: unknown kind 'ofice'; did you mean",
    "planners: [tours]\nworlds: [{kind: maze, width: 3}]": "worlds[0]: width of a generated world must be",
    "planners: [tours]\nmaps: [{file: nowhere.yaml}]": "maps[0]: cannot read map",
    "planners: [tours]\nworlds: [{kind: maze}]\nrobots: [0]": "robots[0]: must be a whole number from 1",
    "planners: [tours]\nworlds: [{kind: maze}]\nplatform: {rnage: 3}": "platform: unknown field 'rnage'; did",
    "planners: [tours]\nworlds: [{kind: maze}]\nplatform: []": "platform: lists nothing; give a mapping",
    "planners: [tours]\nworlds: [{kind: maze}]\nplatform: [{}, {rnage: 3}]": "platform[1]: unknown field",
    "planners: [tours]\nworlds: [{kind: maze}]\nplatform: {range: [4, 900]}": "range must be 0.2 to 200 m",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {seed: 3}": "setup: unknown field 'seed'",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {link_loss: 0.95}": "link_loss must be 0 to 0.9;",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {link_loss: 2}": "link_loss must be a number >= 0 and",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {scheme: tokn}": "unknown scheme 'tokn'; did you mean",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {scheme: []}": "scheme lists nothing; give a value",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {kills: {4: 3}}": "there is no robot 4 in a team of 3",
    "planners: [tours]\nworlds: [{kind: maze}]\nsetup: {faults: no.yaml}": "neither a file that is there nor",
    "planners: [tours]\nworlds: [{kind: maze}]\nreference: burgard": "reference 'burgard' is not among",
    "planners: [tours]\nworld: []": "unknown field 'world'; did you mean 'worlds'?",
}


@pytest.mark.parametrize(("text", "told"), MISTAKES.items())
def test_a_mistake_in_a_spec_is_told_in_one_line_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as error:
        study.main([str(written(tmp_path, text))], standalone_mode=False)
    assert told in str(error.value)
    assert "tiny.yaml" in str(error.value)
    assert "\n" not in str(error.value)
    assert not Path("runs").exists()


def test_too_many_runs_are_refused(tmp_path: Path) -> None:
    seeds = list(range(400))
    text = f"planners: [tours]\nworlds: [{{kind: maze, seeds: {seeds}}}]\nseeds: {seeds}"
    with pytest.raises(InputError, match="160000 runs are too many, at most 100000"):
        runs(tmp_path, text)


def test_a_spec_is_a_file_or_the_name_of_one_that_is_shipped() -> None:
    for name, path in shipped().items():
        assert find_spec(name) == path
        assert runs_of(load_spec(path), path)
    with pytest.raises(InputError, match="did you mean 'ten-minutes'"):
        find_spec("ten-minute")


# -- what is kept -------------------------------------------------------------------------------------


def test_a_study_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    all_runs, out = runs(tmp_path), tmp_path / "out"
    first = Counting(stop_after=3)
    stopped = conducted(all_runs, out, first)
    assert (stopped.fresh, len(stopped.missing)) == (3, 1)
    second = Counting()
    whole = conducted(all_runs, out, second)
    assert second.done == [run for run in all_runs if run not in first.done]
    assert list(whole.results) == all_runs
    assert not whole.missing


def test_results_that_are_gone_or_cut_off_are_made_again(tmp_path: Path) -> None:
    all_runs, out = runs(tmp_path), tmp_path / "out"
    conducted(all_runs, out, Counting())
    files = sorted((out / "runs").iterdir())
    assert len(files) == len(all_runs) == 4
    files[0].unlink()
    files[2].write_text(files[2].read_text()[:50])
    again = Counting()
    whole = conducted(all_runs, out, again)
    assert len(again.done) == 2
    assert list(whole.results) == all_runs
    assert all(result == made_up(run) for run, result in whole.results.items())


def test_a_changed_spec_runs_only_what_is_new(tmp_path: Path) -> None:
    out = tmp_path / "out"
    conducted(runs(tmp_path), out, Counting())
    work = Counting()
    conducted(runs(tmp_path, TINY.replace("burgard", "tours, burgard")), out, work)
    assert {run.setup.planner for run in work.done} == {"tours"}


def test_other_code_does_not_reuse_results(tmp_path: Path) -> None:
    all_runs, out = runs(tmp_path), tmp_path / "out"
    conducted(all_runs, out, Counting())
    store = Store.open(out, "def")
    assert all(store.read(run) is None for run in all_runs)
    assert store.others(all_runs) == 4


def test_a_run_that_breaks_is_a_row_and_is_tried_again(tmp_path: Path) -> None:
    all_runs, out = runs(tmp_path), tmp_path / "out"
    broke = conducted(all_runs, out, Counting(breaking="burgard"))
    assert broke.broken == 2
    rows = figure_rows(broke.results)
    assert [row["error"] for row in rows if row["planner"] == "burgard"] == ["ValueError: no way"] * 2
    assert all(row["t90_s"] is None for row in rows if row["planner"] == "burgard")
    again = Counting()
    assert conducted(all_runs, out, again).broken == 0
    assert {run.setup.planner for run in again.done} == {"burgard"}


class Fragile(Workers):
    """Workers that all die with a certain run, without processes; two runs are under way at once."""

    fatal: Run | None = None

    def _parallel(self, jobs: int, runs: Iterable[Run]) -> Iterator[tuple[Run, RunResult]]:
        given: list[Run] = []
        for run in runs:
            given.append(run)
            if self.fatal in given:
                raise MemoryError("a worker died")
            if len(given) == 2:
                yield given[0], self.work(given.pop(0))
        yield from ((run, self.work(run)) for run in given)


def test_a_worker_that_dies_costs_its_own_run_only(tmp_path: Path) -> None:
    all_runs = runs(tmp_path)
    for fatal in all_runs:
        workers = Fragile(2, work=Counting())
        workers.fatal = fatal
        found = list(workers.results(all_runs))
        assert len(found) == len(all_runs)
        assert {run: result.error for run, result in found} == {
            run: "MemoryError: a worker died" if run == fatal else "" for run in all_runs
        }


@pytest.mark.slow
def test_a_process_that_dies_costs_its_own_run_only(tmp_path: Path) -> None:
    all_runs = runs(tmp_path)
    dying = all_runs[1]

    def work(run: Run) -> RunResult:
        if run == dying:
            os._exit(1)
        return made_up(run)

    results = dict(Workers(2, work=work).results(all_runs))
    assert set(results) == set(all_runs)
    assert [run for run, result in results.items() if result.error] == [dying]


def test_a_study_whose_time_is_over_begins_no_run_and_goes_on_later(tmp_path: Path) -> None:
    all_runs, store = runs(tmp_path), Store.open(tmp_path / "out", "abc")
    work = Counting()
    early = Workers(1, work=work, over=lambda: len(work.done) >= 2)
    first = conduct(all_runs, store, early, quiet())
    assert (len(first.results), first.interrupted) == (2, False)
    assert first.missing == [run for run in all_runs if run not in first.results]
    second = conduct(all_runs, store, Workers(1, work=work), quiet())
    assert (list(second.results), second.missing) == (all_runs, [])
    assert len(work.done) == len(all_runs)


def test_no_run_waits_for_a_worker_to_be_begun_when_the_time_is_over(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    begun.mkdir()

    def work(run: Run) -> RunResult:
        (begun / f"{os.getpid()}-{time.monotonic_ns()}").touch()
        return made_up(run)

    early = Workers(2, work=work, over=lambda: any(begun.iterdir()))
    assert len(dict(early.results(runs(tmp_path)))) == len(list(begun.iterdir())) <= 2


def test_a_folder_with_something_else_in_it_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "precious.txt").write_text("mine")
    with pytest.raises(InputError, match="holds something else than a study"):
        Store.open(tmp_path, "abc")
    assert [path.name for path in tmp_path.iterdir()] == ["precious.txt"]


@pytest.mark.parametrize(
    ("missing", "told"),
    [
        ("distributed", r"pip install 'dask\[distributed\]'"),
        ("pyarrow", r"needs pyarrow; .*'vedette\[study\]'"),
    ],
)
def test_what_is_not_installed_is_asked_for_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, missing: str, told: str
) -> None:
    monkeypatch.setattr(backends, "find_spec", lambda name: None if name == missing else name)
    with pytest.raises(InputError, match=told):
        study.main([str(written(tmp_path)), "--backend", "dask"], standalone_mode=False)


# -- what comes out -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Run], Conducted, Path]:
    """Four short missions, conducted and written."""
    folder = tmp_path_factory.mktemp("real")
    spec = written(folder)
    all_runs = runs_of(load_spec(spec), spec)
    found = conduct(all_runs, Store.open(folder / "out", "abc"), Workers(1), quiet())
    write_outputs(found, spec, "nearest", folder / "out", MADE, pictures=True)
    return all_runs, found, folder / "out"


def test_a_run_is_the_same_each_time(real: tuple[list[Run], Conducted, Path]) -> None:
    all_runs, found, _ = real
    again = carry_out(all_runs[0])
    assert replace(again, timing={}) == replace(found.results[all_runs[0]], timing={})
    assert not again.error


def test_a_file_of_a_run_is_by_its_schema_and_no_other_version_is_read(
    real: tuple[list[Run], Conducted, Path], tmp_path: Path
) -> None:
    all_runs, _, out = real
    files = sorted((out / "runs").glob("*.json"))
    assert len(files) == len(all_runs)
    for file in files:
        assert valid("study-run", file.read_bytes())["result"]["figures"]["error"] == ""
    store = Store.open(tmp_path / "old", "abc")
    text = files[0].read_text().replace('"schema_version":3', '"schema_version":2')
    store.path(all_runs[0]).write_text(text)
    assert store.read(all_runs[0]) is None


def test_the_tables_agree_and_wall_clock_figures_are_apart(real: tuple[list[Run], Conducted, Path]) -> None:
    all_runs, _, out = real
    table = pq.read_table(out / "results.parquet")
    with (out / "results.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert table.num_rows == len(lines) == len(all_runs)
    assert table.column_names == list(lines[0])
    assert [float(line["auc_s"]) for line in lines] == table["auc_s"].to_pylist()
    assert {"planner", "world_seed", "t90_s", "bound_s", "seen_std_m2", "bytes_negotiation"} <= set(lines[0])
    assert not {"wall_s", "planning_p95_ms"} & set(lines[0])
    assert {"wall_s", "planning_p95_ms"} <= set(pq.read_schema(out / "timing.parquet").names)
    differences = pq.read_table(out / "differences.parquet").to_pylist()
    assert {row["planner"] for row in differences} == {"burgard"}
    assert pq.read_table(out / "means.parquet").num_rows > 0


def test_no_mission_is_faster_than_any_team_can_be(tmp_path: Path) -> None:
    to_the_end = runs(tmp_path, TINY.replace("max_time: 25", "max_time: 60"))
    found = conduct(to_the_end, Store.open(tmp_path / "out", "abc"), Workers(1), quiet())
    rows = figure_rows(found.results)
    assert len(rows) == 4
    for row in rows:
        for level in ("t50", "t90", "t95", "t99"):
            reached, bound = row[f"{level}_s"], row[f"bound_{level}_s"]
            assert isinstance(bound, float)
            assert isinstance(reached, float)
            assert reached >= bound


def test_the_report_needs_nothing_but_itself(real: tuple[list[Run], Conducted, Path]) -> None:
    text = (real[2] / "report.html").read_text()
    assert text.count('src="data:image/png;base64,') == 3
    for outside in ("http://", "https://", "<script", "<link", "url(", "@import", 'src="/', "href="):
        assert outside not in text, outside
    for told in (MADE.command, MADE.machine, "kind: maze", "Losses", "no team below", "burgard"):
        assert told in text


def test_pictures_are_drawn_if_asked_for_and_none_of_fewer_runs_is_left(
    real: tuple[list[Run], Conducted, Path], tmp_path: Path
) -> None:
    for pictures, count in ((True, 3), (False, 0)):
        write_outputs(real[1], written(tmp_path), "nearest", tmp_path, MADE, pictures=pictures)
        assert len(list(tmp_path.glob("*.png"))) == count
        assert (tmp_path / "report.html").read_text().count("data:image/png") == count


def test_without_pictures_no_library_that_draws_is_imported() -> None:
    code = "import sys, vedette.study.outputs, vedette.study.workers; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_mission_goes_the_same_whether_its_maps_are_recorded_or_not(tmp_path: Path) -> None:
    run = runs(tmp_path)[0]
    full, lean = explore(prepared(run)), explore(prepared(run), curves_only=True)
    assert lean.summary == full.summary
    np.testing.assert_array_equal(lean.log.times, full.log.times)
    np.testing.assert_array_equal(lean.log.coverage, full.log.coverage)
    assert (full.log.stored() > 1, lean.log.stored()) == (True, 0)


@pytest.mark.slow
def test_two_workers_carry_out_all_runs(tmp_path: Path) -> None:
    def work(run: Run) -> RunResult:
        return replace(made_up(run), timing={"process": os.getpid()})

    done = dict(Workers(2, work=work).results(runs(tmp_path, TINY.replace("[1, 2]", str(list(range(20)))))))
    assert len(done) == 40
    assert len({result.timing["process"] for result in done.values()} - {os.getpid()}) <= 2


def test_the_report_counts_what_is_missing_and_names_what_broke(tmp_path: Path) -> None:
    all_runs, out = runs(tmp_path), tmp_path / "out"
    found = conducted(all_runs, out, Counting(stop_after=3, breaking="burgard"))
    write_outputs(found, tmp_path / "tiny.yaml", "nearest", out, MADE)
    text = (out / "report.html").read_text()
    assert "1 run missing" in text
    assert "ValueError: no way" in text
    assert "maze 10x10 1, 2 robots apart, seed 0, burgard" in text


def test_a_study_of_one_planner_in_one_world_or_with_nothing_but_failures_has_a_report(
    tmp_path: Path,
) -> None:
    text = "planners: [tours]\nworlds: [{kind: maze, width: 10, height: 10}]"
    for name, work in (("one", Counting()), ("none", Counting(breaking="tours"))):
        found = conducted(runs(tmp_path, text), tmp_path / name, work)
        write_outputs(found, tmp_path / "tiny.yaml", "tours", tmp_path / name, MADE)
        assert (tmp_path / name / "report.html").is_file()


def test_starts_apart_are_farther_apart_than_starts_together(tmp_path: Path) -> None:
    run = runs(tmp_path)[0]
    apart, together = (
        prepared(replace(run, robots=3, starts=starts)).starts for starts in ("apart", "together")
    )

    def least(starts: object) -> float:
        xy = np.asarray(starts)[:, :2]
        gaps = np.hypot(*(xy[:, None] - xy[None]).transpose(2, 0, 1))
        return float(gaps[np.triu_indices(len(xy), 1)].min())

    assert least(apart) > 3.0 > least(together)


def test_the_command_tells_where_the_report_is_and_ends_with_0(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = TINY.replace("[1, 2]", "[1]").replace("max_time: 25", "max_time: 3").replace("nearest, ", "")
    arguments = [str(written(tmp_path, text)), "--jobs", "1"]
    for told in ("1 run, 0 of them done before", "1 run, 1 of them done before"):
        with pytest.raises(SystemExit) as ended:
            study.main(arguments, standalone_mode=False)
        assert ended.value.code == 0
        said = capsys.readouterr().out
        assert told in said
        assert str(Path("runs") / "study-tiny" / "report.html") in said
    (result,) = (tmp_path / "runs" / "study-tiny" / "runs").iterdir()
    assert json.loads(result.read_text())["run"]["planner"] == "burgard"


# -- small things -------------------------------------------------------------------------------------


def test_the_time_left_is_by_the_work_that_is_left(tmp_path: Path) -> None:
    run = runs(tmp_path)[0]
    small, large = replace(run, robots=1), replace(run, robots=4)
    now = [0.0]
    text = StringIO()
    progress = StudyProgress([small, large], Console(file=text), clock=lambda: now[0])
    with progress:
        now[0] = 30.0
        progress.ended(small, made_up(small))
        assert progress.time_left() == pytest.approx(60.0)  # 3 units of work took 30 s, and 6 are left
    assert text.getvalue().startswith("1/2, 60 s left: maze 10x10 1, 1 robot apart, nearest: complete")


@pytest.mark.parametrize(("seconds", "said"), [(5.4, "5 s"), (300.0, "5 min"), (9000.0, "2.5 h")])
def test_durations_are_said_as_people_do(seconds: float, said: str) -> None:
    assert in_words(seconds) == said


def test_the_fingerprint_changes_with_code_that_matters_and_no_other(tmp_path: Path) -> None:
    package = tmp_path / "package"
    for folder in ("sim", "study"):
        (package / folder).mkdir(parents=True)
        (package / folder / "a.py").write_text("1")
    before = fingerprint(package)
    (package / "study" / "a.py").write_text("2")
    fingerprint.cache_clear()
    assert fingerprint(package) == before
    (package / "sim" / "a.py").write_text("2")
    fingerprint.cache_clear()
    assert fingerprint(package) != before


def test_a_folder_that_no_repository_tracks_has_no_commit(tmp_path: Path) -> None:
    assert commit_of(tmp_path) == "unknown"


def test_a_spec_has_defaults_for_all_but_planners_and_worlds() -> None:
    spec = Spec(planners=("tours",))
    assert (spec.robots, spec.starts, spec.seeds) == ((3,), ("together",), (0,))
    assert spec.platform == spec.setup == {}
