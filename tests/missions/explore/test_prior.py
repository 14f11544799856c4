"""Missions with an old map: it saves ways where it is right, and does no harm to the map where it is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.support.small_missions import check_complete, plan, robots, small_maze, small_office
from vedette import run
from vedette.agent import Agent
from vedette.domains.mapping.prior import PriorMap
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, write_map
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble, terms_of
from vedette.missions.explore.old_map import read_prior
from vedette.missions.explore.options import ExploreOptions
from vedette.team import Most


@pytest.mark.parametrize("seed", [1, 5])
def test_a_team_with_a_map_of_this_building_or_of_another_completes_its_own(
    seed: int, tmp_path: Path
) -> None:
    result = run.explore(small_maze(), team=2, seed=3, prior=plan(small_maze(seed), tmp_path))
    check_complete(result.report)


def test_rooms_that_the_old_map_does_not_have_are_found(tmp_path: Path) -> None:
    """Its walls run on where there are doors by now: whoever sees them open looks behind."""
    world = small_office()
    walled = world.solid.copy()
    walled[:, walled.shape[1] // 2 :] = True
    old = World(world.frame, walled, "half")
    check_complete(run.explore(world, team=2, seed=3, prior=plan(old, tmp_path)).report)


def agent(prior: PriorMap | None) -> Agent:
    world, specs = small_maze(), robots(2)
    most = Most.of(specs)
    return assemble(Lattice(world.frame), specs[0], ExploreOptions(), 0, 1, robots=2, most=most, prior=prior)


def test_robots_with_different_old_maps_freeze_different_beliefs_and_refuse_each_others_links(
    tmp_path: Path,
) -> None:
    lattice = Lattice(small_maze().frame)
    first, second = (read_prior(plan(small_maze(seed), tmp_path), lattice) for seed in (1, 2))
    digests = [agent(prior).rounds.mandate() for prior in (None, first, first, second)]
    assert digests[1] == digests[2]
    assert len(set(digests)) == 3
    told = [terms_of(lattice, ExploreOptions(), prior) for prior in (None, first, second)]
    assert "prior" not in told[0]
    assert told[1]["prior"] != told[2]["prior"]


def test_an_old_map_of_finer_cells_keeps_its_walls_closed(tmp_path: Path) -> None:
    frame = small_maze().frame
    fine = GridFrame(frame.resolution / 2, 2 * frame.rows, 2 * frame.cols)
    classes = np.full(fine.shape, FREE, np.uint8)
    classes[:, 101] = OCCUPIED
    write_map(tmp_path / "fine", fine, classes)
    prior = read_prior(tmp_path / "fine.yaml", Lattice(frame))
    assert prior.frame == frame
    assert (prior.classes[:, 50] == OCCUPIED).all()
    assert (prior.classes[:, 51:] == FREE).all()


@pytest.mark.parametrize(
    ("pair", "remedy"),
    [
        (None, r"an image alone has no resolution; write old\.yaml, which says it, and give that"),
        ("resolution: 0.1\n", r"an image alone has no resolution; give old\.yaml instead"),
    ],
)
def test_an_old_map_without_a_resolution_is_told_of_with_what_its_option_takes(
    pair: str | None, remedy: str, tmp_path: Path
) -> None:
    write_map(tmp_path / "old", GridFrame(0.1, 20, 20), np.full((20, 20), FREE, np.uint8))
    (tmp_path / "old.yaml").unlink()
    if pair is not None:
        (tmp_path / "old.yaml").write_text(pair)
    with pytest.raises(InputError, match=f"^prior: .*old\\.pgm: {remedy}$"):
        read_prior(tmp_path / "old.pgm", Lattice(small_maze().frame))


@pytest.mark.parametrize("what", [UNKNOWN, FREE])
def test_an_old_map_that_knows_nothing_of_the_ground_is_refused(what: int, tmp_path: Path) -> None:
    away = 0.0 if what == UNKNOWN else 500.0
    write_map(tmp_path / "old", GridFrame(0.1, 20, 20, away, away), np.full((20, 20), what, np.uint8))
    with pytest.raises(InputError, match=r"prior: .*old\.yaml: nothing of the team's ground is known in it"):
        run.Explore(small_maze(), prior=tmp_path / "old.yaml")
