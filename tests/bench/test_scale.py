"""The scale table: teams, trees and counts against ``negotiate`` and brute force; verdicts and files."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.scale import mapping, report, series, trees
from bench.scale.edges import whole_sizes
from bench.scale.post import run_round
from bench.scale.series import (
    DOMAINS,
    FIXED,
    QUICK_SIZES,
    SIZES,
    SQUARE,
    STRIP,
    WHOLE_UP_TO,
    Row,
)
from bench.scale.tables import brief, full
from bench.scale.team import Lots, Team
from bench.scale.verdicts import judge
from tests.support.schemas import valid
from vedette.domains.mapping.objective import MappingObjective
from vedette.negotiation import Tree, negotiate

DENSE = {
    name: domain.dense(Lots.square(8, domain.LOT), np.random.default_rng(3))
    for name, domain in DOMAINS.items()
}
ROW = Row(
    domain="mapping",
    area=FIXED,
    tree="chain",
    clipped=False,
    n=64,
    sweeps=3,
    converged=True,
    value=1.0,
    share=0.9,
    cpu_median=1.0,
    cpu_mean=1.0,
    cpu_hub=1.0,
    messages_mean=1.0,
    messages_most=1.0,
    messages_hub=1.0,
    bytes_mean=1.0,
    bytes_most=1.0,
    bytes_hub=1.0,
    edge_median=100.0,
    edge_largest=200.0,
    bound=1000,
)


# -- teams and trees --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "lots", [Lots.square(8, 2.0), Lots.square(64, 2.0), Lots.strip(32, 2.0), Lots.strip(2, 2.0)]
)
def test_the_serpentine_goes_through_every_lot_and_from_neighbour_to_neighbour(lots: Lots) -> None:
    corners = lots.corners
    assert len(np.unique(corners, axis=0)) == len(corners) == lots.rows * lots.cols
    assert np.all(np.abs(np.diff(corners, axis=0)).sum(axis=1) == 2.0)
    inside = (lots.places(np.random.default_rng(0)) - corners) / 2.0
    assert inside.min() >= 0.1
    assert inside.max() <= 0.9


@pytest.mark.parametrize("n", [2, 3, 8, 37, 64])
def test_the_branches_of_the_balanced_tree_are_apart_in_space(n: int) -> None:
    places = np.random.default_rng(n).uniform(0.0, 10.0, (n, 2))
    tree = trees.balanced_in_space(places)
    assert sorted(len(tree.neighbours(i)) for i in range(n)) == sorted(
        len(Tree.balanced(n).neighbours(i)) for i in range(n)
    )

    for a, b in tree.edges:
        assert any(nobody_else_is_in_the_box_around(behind(tree, *ends), places) for ends in ((a, b), (b, a)))


def nobody_else_is_in_the_box_around(members: list[int], places: NDArray[np.float64]) -> bool:
    low, high = places[members].min(axis=0), places[members].max(axis=0)
    return int(((low <= places) & (places <= high)).all(axis=1).sum()) == len(members)


def behind(tree: Tree, start: int, avoided: int) -> list[int]:
    return [start, *(i for k in tree.neighbours(start) if k != avoided for i in behind(tree, k, start))]


@pytest.mark.parametrize("name", DOMAINS)
def test_a_platform_makes_no_difference_outside_its_reach(name: str) -> None:
    team = DENSE[name]
    for own, reach in zip(team.candidates, team.reaches, strict=True):
        for impact in own:
            left = team.objective.clip(team.belief, impact, reach)  # type: ignore[attr-defined]
            assert team.codec.encode(left) == team.codec.encode(impact)


def test_clipping_a_mapping_impact_changes_no_gain_within_the_boxes() -> None:
    team, objective = DENSE["mapping"], MappingObjective()
    crowd = objective.nothing(team.belief)
    for own in team.candidates:
        crowd = objective.combine(crowd, own[0])
    clipped_some = False
    for own, reach in zip(team.candidates, team.reaches, strict=True):
        clipped = objective.clip(team.belief, crowd, reach)
        clipped_some |= len(clipped.keys) < len(crowd.keys)
        for impact in own:
            gain, same = (
                objective.value(team.belief, objective.combine(base, impact))
                - objective.value(team.belief, base)
                for base in (crowd, clipped)
            )
            assert same == pytest.approx(gain, abs=1e-9)
    assert clipped_some


def test_the_rooms_are_joined_by_doors() -> None:
    solid = mapping.rooms(2, 3)
    assert solid.shape == (100, 150)
    assert not solid[25].any()  # along all doors
    assert not solid[:, 25].any()


# -- counts -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("clipped", [False, True])
@pytest.mark.parametrize("tree", trees.TREES)
@pytest.mark.parametrize("name", DOMAINS)
def test_a_counted_round_is_the_negotiation_to_the_byte(name: str, tree: str, clipped: bool) -> None:
    team = DENSE[name]
    links = trees.make(tree, team.places)
    tally = run_round(team, links, clipped=clipped, max_sweeps=20)
    result = negotiate(
        team.objective,
        team.belief,
        team.candidates,
        links,
        max_sweeps=20,
        codec=team.codec,
        reach=team.reaches if clipped else None,
    )
    assert tally.choice == result.choice
    assert tally.outcome.value == result.value
    assert tally.outcome.sweeps == result.sweeps
    assert tally.messages.sum() == result.messages
    assert tally.bytes.sum() == result.bytes
    assert tally.seconds.min() > 0.0


@pytest.mark.parametrize("name", DOMAINS)
def test_clipping_changes_no_choice_and_saves_bytes(name: str) -> None:
    team = DENSE[name]
    tree = trees.make("chain", team.places)
    whole, clipped = (run_round(team, tree, clipped=c, max_sweeps=20) for c in (False, True))
    assert clipped.choice == whole.choice
    assert clipped.outcome.value == pytest.approx(whole.outcome.value, rel=1e-9)
    assert clipped.edges.sum() < whole.edges.sum()


@pytest.mark.parametrize("tree", ["chain", "star", "random"])
def test_the_whole_sizes_are_those_of_the_median_link_and_of_one_with_most_platforms_behind(
    tree: str,
) -> None:
    team = DENSE["tracking"]
    links = trees.make(tree, team.places)
    choice = run_round(team, links, clipped=True, max_sweeps=20).choice
    sizes = {}
    for a, b in [pair for edge in links.edges for pair in (edge, edge[::-1])]:
        members = behind(links, a, b)
        total = team.objective.nothing(team.belief)
        for i in members:
            total = team.objective.combine(total, team.candidates[i][choice[i] or 0])
        sizes[a, b] = (len(members), len(team.codec.encode(total)))
    median, largest = whole_sizes(team, links, choice)
    most = max(count for count, _ in sizes.values())
    assert largest in [size for count, size in sizes.values() if count == most]
    middle = sorted(sizes.values())[len(sizes) // 2 - 2 : len(sizes) // 2 + 2]
    assert min(size for _, size in middle) <= median <= max(size for _, size in middle)


# -- rows, verdicts, files --------------------------------------------------------------------------


def test_a_row_spreads_a_rounds_figures_over_its_platforms_and_sweeps() -> None:
    table = list(series.rows(["tracking"], (2, 4), lambda _: None))
    assert {(row.area, row.tree, row.clipped, row.n) for row in table} == {
        (area, tree, clipped, n)
        for n in (2, 4)
        for area, names, kinds in (
            (FIXED, trees.TREES, (False,)),
            (SQUARE, trees.TREES, (False, True)),
            (STRIP, ("chain",), (False, True)),
        )
        for tree in names
        for clipped in kinds
    }
    for row in table:
        extra = 2 * (row.n - 1) if row.clipped else 0  # telling the reaches
        a_sweep = 2 * (row.n - 1) + extra / (row.sweeps + 1)  # within a hop or two, for it ends on the way
        assert abs(row.messages_mean * row.n - a_sweep) <= 0.5 * a_sweep
        assert row.messages_hub >= row.messages_mean * 0.5
        assert row.bytes_mean > 0.0
        assert row.cpu_mean > 0.0
        assert 0.0 < row.share <= 1.0
        assert (row.whole_median is None) != row.clipped


def test_a_series_ends_before_a_round_that_would_take_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(series, "LONGEST", 0.0)
    assert {row.n for row in series.rows(["tracking"], (2, 4), lambda _: None)} == {2}


def test_the_worst_tree_is_judged_and_one_that_took_too_long_is_missed() -> None:
    dense = [replace(ROW, area=STRIP, clipped=True, n=n, edge_median=100.0) for n in (16, 256, 512)]
    flat = [replace(ROW, n=n, tree=tree) for n in (16, 512) for tree in ("chain", "star")]
    grown = [replace(row, bytes_mean=1.5) if (row.n, row.tree) == (512, "star") else row for row in flat]
    by_name = {each.criterion.name: each for each in judge(grown + dense)}
    worst = by_name["mapping, fixed area: bytes, n=512 to 16"]
    assert (worst.measured, worst.verdict, worst.note) == (
        1.5,
        "MISSED",
        "chain 1.00, star 1.50; at most 1.50 on the way",
    )
    assert by_name["mapping, fixed area: messages, n=512 to 16"].verdict == "MET"
    assert by_name["mapping, constant density: median link, n=512 to 256"].verdict == "MET"
    short = judge([*flat[:-1], *dense])
    assert short[0].measured is not None
    assert math.isnan(short[0].measured)
    assert (short[0].verdict, short[0].note) == (
        "MISSED",
        "chain 1.00; at most 1.00 on the way; took too long: star",
    )


@pytest.mark.parametrize(
    ("sizes", "open_verdicts"),
    [
        (SIZES, []),
        (QUICK_SIZES, ["constant density: median link, from n=256 on"]),
        (
            (4, 8),
            [
                "fixed area: messages, from n=16 on",
                "fixed area: bytes, from n=16 on",
                "fixed area: CPU, mean, from n=16 on",
                "constant density: median link, from n=256 on",
            ],
        ),
    ],
)
def test_a_verdict_on_sizes_that_were_not_measured_says_so_and_all_others_are_given(
    sizes: tuple[int, ...], open_verdicts: list[str]
) -> None:
    kinds = ((FIXED, "star", False), (SQUARE, "balanced", True), (STRIP, "chain", True))
    judged = judge([replace(ROW, n=n, area=a, tree=tree, clipped=c) for n in sizes for a, tree, c in kinds])
    verdicts = {each.criterion.name.removeprefix("mapping, "): each.verdict for each in judged}
    assert len(verdicts) == 5
    assert [name for name, verdict in verdicts.items() if verdict == "NOT MEASURED"] == open_verdicts
    assert all(verdict == "MET" for name, verdict in verdicts.items() if name not in open_verdicts)


def test_the_tables_hold_every_row_and_say_what_is_not_flat() -> None:
    rows = [replace(ROW, n=n, converged=n < 64) for n in (2, 4, 8, 16, 32, 64)]
    text = full(rows)
    assert [line.split("|")[2].strip() for line in text.splitlines() if line.startswith("| chain")] == [
        str(row.n) for row in rows
    ]
    assert ">= 3" in text
    assert "What does not stay flat" in text
    assert brief(rows).count("| chain") < text.count("| chain")


def test_the_report_is_written_as_json_table_and_picture(tmp_path: Path) -> None:
    text = report.run(tmp_path, {"machine": "m"}, True, lambda _: None, ["tracking"])
    assert "tracking, fixed area: bytes, n=64 to 16" in text
    written = valid("bench-scale", (tmp_path / "scale-quick.json").read_bytes())
    assert written["about"] == {"machine": "m"}
    clipped, whole = len(QUICK_SIZES), sum(n <= WHOLE_UP_TO for n in QUICK_SIZES)
    assert len(written["rows"]) == 4 * clipped + 5 * (clipped + whole)
    assert [each["name"] for each in written["measurements"] if each["verdict"] == "NOT MEASURED"] == [
        "tracking, constant density: median link, from n=256 on"
    ]
    assert (tmp_path / "scale-quick.md").read_text().count("\n| chain") == clipped + 2 * (clipped + whole)
    assert (tmp_path / "scale-quick.png").read_bytes().startswith(b"\x89PNG")


def test_the_first_platforms_of_a_team_are_a_team() -> None:
    team: Team = DENSE["search"].first(3)
    assert len(team) == len(team.places) == len(team.reaches) == 3
    assert negotiate(team.objective, team.belief, team.candidates, Tree.chain(3)).converged
