"""The ablation: a part is exchanged at a time, in the same missions; the ratios are those of the figures."""

from __future__ import annotations

from dataclasses import fields

import pytest

from bench.ablation import WHOLE, cases, table, variants
from vedette.domains.mapping.planners import PLANNERS
from vedette.team import PlatformSpec


def row(planner: str, seed: int, factor: float) -> dict[str, object]:
    figures = {"auc_s": 60.0, "t90_s": 100.0, "t99_s": 200.0, "time_s": 300.0}
    return {
        "planner": planner,
        "case": f"case {seed}",
        "world_id": f"world {seed}",
        "seed": 0,
        "completed": True,
        **{name: factor * value for name, value in figures.items()},
    }


def test_a_variant_differs_from_the_planner_in_something_that_decides() -> None:
    whole = PLANNERS[WHOLE]
    decides = [field.name for field in fields(whole) if field.name not in ("summary", "platform")]
    for name, variant in variants().items():
        own, other = variant.platform(PlatformSpec("a")), whole.platform(PlatformSpec("a"))
        kinds = [(type(robot), robot.max_stops, robot.measured) for robot in (own, other)]
        differs = [field for field in decides if getattr(variant, field) != getattr(whole, field)]
        assert differs or kinds[0] != kinds[1], name


def test_every_variant_goes_through_the_same_missions() -> None:
    runs = cases((5, 6), 3, (WHOLE, "rate"))
    assert len(runs) == 2 * 3 * 2  # seeds, kinds of worlds, planners
    assert len({run.case for run in runs}) == 2 * 3
    assert {run.robots for run in runs} == {3}
    first = [(run.world.seed, run.setup.planner) for run in runs[:6]]
    assert first == [(5, WHOLE), (5, "rate")] * 3  # a study that is stopped has whole comparisons


def test_the_table_shows_the_planners_means_and_the_ratios_of_the_others() -> None:
    rows = [row(WHOLE, 0, 1.0), row(WHOLE, 1, 3.0), row("slower", 0, 2.0), row("slower", 1, 6.0)]
    header, _, whole, slower = table(rows).splitlines()
    assert [cell.strip() for cell in header.strip("|").split("|")][1:] == [
        "AUC [s]", "T90 [s]", "T99 [s]", "total [s]",
    ]  # fmt: skip
    assert [cell.strip() for cell in whole.strip("|").split("|")] == ["nothing", "120", "200", "400", "600"]
    cells = [cell.strip() for cell in slower.strip("|").split("|")]
    assert cells[0] == "slower"
    assert [float(cell.split()[0]) for cell in cells[1:]] == pytest.approx([2.0] * 4)


def test_a_ratio_of_one_draw_has_no_interval_and_what_nobody_reached_has_no_ratio() -> None:
    rows = [row(WHOLE, 0, 1.0), row("slower", 0, 2.0) | {"t99_s": None}]
    slower = table(rows).splitlines()[-1]
    assert [cell.strip() for cell in slower.strip("|").split("|")] == ["slower", "2.00", "2.00", "-", "2.00"]
