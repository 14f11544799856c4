"""What a team sends and holds as it grows: the bench's robots, and its table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench.city import HOP, PATH, Beaconing, city, city_row, tree_between_near
from vedette.agent import messages
from vedette.agent.messages import Beacon


def test_without_a_bound_on_what_is_near_every_beacon_crosses_every_link_once() -> None:
    places = np.random.default_rng(0).uniform(0.0, 100.0, (9, 2))
    team = Beaconing(tree_between_near(places), np.inf)
    team.beacon(places, 1, 0.0)
    told = len(messages.encode(Beacon(8, 1, 1, 9000, 9000, 0, 0, 20, 50, PATH)))
    assert 9 * 8 * told * 0.95 <= team.size <= 9 * 8 * (told + 3) + 16 * 4
    assert all(len(mates.all()) == 8 for mates in team.mates)


def test_the_tree_between_near_ones_is_shorter_than_a_chain() -> None:
    places = np.random.default_rng(1).uniform(0.0, 100.0, (20, 2))
    along = sum(np.hypot(*(places[a] - places[b])) for a, b in tree_between_near(places).edges)
    assert along < np.hypot(*np.diff(places, axis=0).T).sum()


def test_a_row_is_measured_and_a_larger_team_has_more_of_everything() -> None:
    small, large = city_row(4), city_row(16)
    assert small.sweep == pytest.approx(6 * HOP)
    for name in ("plain", "thinned", "held", "news", "sweep"):
        assert 0.0 < getattr(small, name) < getattr(large, name), name
    assert large.thinned < large.plain


def test_the_table_is_written(tmp_path: Path) -> None:
    done = CliRunner().invoke(city, ["--robots", "3", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "city.md").read_text(encoding="utf-8").splitlines()[2].startswith("|      3 |")
