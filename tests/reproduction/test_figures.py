"""The reproduction's figures, and what it finds of missions, against other computations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.support.reproductions import SMALL, named, silent
from vedette.domains.mapping.planners import DEFAULT
from vedette.problem import exhaustive
from vedette_reproduction.claims import mapping
from vedette_reproduction.claims.mapping import c11, c12
from vedette_reproduction.content import Verdict
from vedette_reproduction.contest import OBJECTIVE, make_scenes, selfish_choice
from vedette_reproduction.figures.figure_1 import figure_1
from vedette_reproduction.figures.figure_2 import MOST, NOISY, PERFECT, PRIOR, figure_2, posteriors
from vedette_reproduction.figures.figure_3 import analytic, figure_3
from vedette_reproduction.figures.figure_4 import figure_4
from vedette_reproduction.figures.figure_6 import figure_6
from vedette_reproduction.missions import Missions
from vedette_reproduction.run import ReproductionRun


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> ReproductionRun:
    """A reproduction in a very small office; its missions are run once."""
    return ReproductionRun(SMALL, 0, tmp_path_factory.mktemp("figures"), Missions(silent), silent)


def is_picture(path: Path) -> bool:
    """Tell whether a file is a PNG of some size that is not of one colour."""
    with Image.open(path) as image:
        return image.format == "PNG" and min(image.size) > 300 and bool(np.ptp(np.asarray(image)) > 0)


def test_figure_1_shows_what_the_paper_says_each_message_holds(run: ReproductionRun) -> None:
    section = figure_1(run)
    rows = named(section, "figure_1_messages").rows
    steps = [(row[2], row[3], row[5]) for row in rows]
    up = [(1, 2, "1"), (2, 3, "1,2")]
    assert steps[:4] == [*up, (3, 2, "1,2,3"), (2, 1, "1,2,3")]
    assert steps[4:] == [*up, (3, 2, "3"), (2, 1, "2,3")]
    for row in named(section, "figure_1_division").rows:
        assert row[1] == pytest.approx(row[2], abs=1e-12)
        assert row[3] == "0/0" or row[3] == pytest.approx(row[1])
    assert is_picture(run.figures / section.pictures[0])


def test_figure_2_has_three_posteriors_or_one_for_every_count_of_reports(run: ReproductionRun) -> None:
    for n in range(1, MOST + 1):
        assert posteriors(PERFECT, n) == pytest.approx([0.0, PRIOR, 1.0])
        odds = {
            round(PRIOR / (1 - PRIOR) * 4.0**a * (0.1 / 0.55) ** b, 9)
            for a in range(n + 1)
            for b in range(n + 1 - a)
        }
        assert len(posteriors(NOISY, n)) == len(odds)
    section = figure_2(run)
    assert all(row[1] == row[2] and row[3] == row[4] for row in named(section, "figure_2_counts").rows)
    assert is_picture(run.figures / section.pictures[0])


def test_figure_3_sees_far_more_than_the_grid_predicts_and_counts_it(run: ReproductionRun) -> None:
    assert analytic(np.array([0.1, 1.0])) == pytest.approx([0.5, 2.0**-10])
    section = figure_3(run)
    rows = named(section, "figure_3").rows
    assert len(rows) == 32
    for row in rows:
        assert row[4] == pytest.approx(float(row[2] or 0) / float(row[3] or 1))
    at_one_metre = rows[4]
    assert float(at_one_metre[4] or 0) > 100 * float(at_one_metre[1] or 0)
    shares = [float(row[2]) for row in named(section, "figure_3_models").rows if row[2] is not None]
    assert np.all(np.diff(shares) <= 1e-12)
    assert is_picture(run.figures / section.pictures[0])


def test_figure_4_compares_with_the_optimum_over_all_joint_choices(run: ReproductionRun) -> None:
    section = figure_4(run)
    rows = named(section, "figure_4_schemes").rows
    assert max(float(row[3] or 0) for row in rows) <= 1.0 + 1e-6
    scene = next(iter(make_scenes(run)))
    values = [
        OBJECTIVE.value(scene.belief, OBJECTIVE.combine(a, b))
        for a in scene.candidates[0]
        for b in scene.candidates[1]
    ]
    assert exhaustive(OBJECTIVE, scene.belief, scene.candidates).value == pytest.approx(max(values))
    assert selfish_choice(scene)[1] <= max(values) + 1e-9
    assert is_picture(run.figures / section.pictures[0])


def test_figure_6_shows_growing_coverage_and_both_planners(run: ReproductionRun) -> None:
    section = figure_6(run)
    assert [row[0] for row in named(section, "figure_6_missions").rows] == ["rate", DEFAULT]
    log = run.mission().report.log
    covered = [stage.coverage for stage in log.stages()]
    assert covered == sorted(covered)
    assert covered[-1] == log.last.coverage
    assert is_picture(run.figures / section.pictures[0])


@pytest.mark.parametrize(("left", "verdict"), [(0, Verdict.HOLDS), (1, Verdict.IN_PART)])
def test_missions_that_leave_something_to_do_have_not_ended_as_the_claim_says(
    run: ReproductionRun, left: int, verdict: Verdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mapping, "left_to_do", lambda mission: (9, left))
    assert c12(run).verdict is verdict


def test_missions_end_and_leave_little(run: ReproductionRun) -> None:
    section = c12(run)
    left = sum(int(row[6] or 0) for row in section.tables[0].rows)
    assert section.verdict is (Verdict.IN_PART if left else Verdict.HOLDS)
    assert f"{left} promising frontiers" in section.but
    assert all(float(row[4] or 0) > 0.99 for row in section.tables[0].rows)
    assert c11(run).verdict is Verdict.HOLDS
