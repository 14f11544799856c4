"""Missions by what may lie behind frontiers: equal maps, equal worlds, and the whole building gets known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.support.small_missions import check_complete, plan, robots, small_maze, small_office
from vedette import run
from vedette.domains.mapping.impact import Impact, MapImpactCodec, cells_missed
from vedette.errors import InputError
from vedette.kernels.coverage import LAYERS
from vedette.maps.lattice import Lattice
from vedette.missions.explore.assemble import assemble, terms_of
from vedette.missions.explore.old_map import read_prior
from vedette.missions.explore.options import ExploreOptions
from vedette.net.explore.content import ExploreTeller, read_content
from vedette.record.explore.observer import ExploreReport
from vedette.team import Most

PREDICTED = ExploreOptions(planner="predicted")


def explored(**how: object) -> ExploreReport:
    return run.explore(small_maze(), team=2, seed=3, planner="predicted", **how).report  # type: ignore[arg-type]


def test_a_team_that_predicts_completes_its_building_and_does_so_the_same_again() -> None:
    one, other = explored(), explored()
    check_complete(one)
    assert one.summary == other.summary


def test_with_a_map_of_another_building_too(tmp_path: Path) -> None:
    check_complete(explored(prior=plan(small_maze(5), tmp_path)))


def test_robots_that_predict_and_robots_that_do_not_agree_on_no_round(tmp_path: Path) -> None:
    world, specs = small_office(), robots(2)
    lattice, most = Lattice(world.frame), Most.of(specs)
    prior = read_prior(plan(world, tmp_path), lattice)
    digests = {
        assemble(lattice, specs[0], options, 0, 1, robots=2, most=most, prior=old).rounds.mandate()
        for options in (ExploreOptions(), PREDICTED)
        for old in (None, prior)
    }
    assert len(digests) == 4
    assert "worlds" not in terms_of(lattice, ExploreOptions())
    assert terms_of(lattice, PREDICTED)["worlds"] == "3"


def test_robots_without_a_common_frame_predict_nothing() -> None:
    with pytest.raises(InputError, match="frames unknown: planner predicted predicts on a map that all have"):
        ExploreOptions(planner="predicted", frames="unknown").check()


def test_what_a_robot_reports_is_over_planning_cells_whatever_the_worlds() -> None:
    world, specs = small_office(), robots(2)
    agent = assemble(Lattice(world.frame), specs[0], PREDICTED, 0, 1, robots=2, most=Most.of(specs))
    planning = world.frame.coarse(2)
    last = 3 * planning.size - 1
    agent.rounds.impact = Impact(np.array([last * LAYERS], np.uint32), np.array([255], np.uint8))
    told = read_content(ExploreTeller(agent).content(0.0))
    assert told.impact is not None
    shown = MapImpactCodec(planning.size).decode(told.impact)
    cells, missed = cells_missed(shown)
    assert cells.tolist() == [planning.size - 1]
    assert missed[0] == pytest.approx(2 / 3, abs=1 / 32)


def test_ground_with_more_cells_in_all_worlds_than_can_be_numbered_is_refused() -> None:
    lattice, specs = Lattice.open(0.2, (0.0, 0.0), None), robots(1)
    with pytest.raises(InputError, match="planner: 67108864 planning cells in 3 worlds are too many"):
        assemble(lattice, specs[0], PREDICTED, 0, 1, robots=2, most=Most.of(specs))
    assemble(lattice, specs[0], ExploreOptions(), 0, 1, robots=2, most=Most.of(specs))
