"""The live view of a search: the likelier the darker, everybody where they are, and it fits the terminal."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from tests.support.search_missions import case
from vedette.record.board import fitted
from vedette.record.search.live import line, screen
from vedette.record.search.log import SearchSample, SearchScene, SearchSnapshot

CASE = case(vehicles=[{"start": [200 + 500 * i, 100, 60], "speed": 30, "turn_rate": 0.4} for i in range(2)])
SCENE = SearchScene.of(CASE, 60.0)


def snapshot() -> SearchSnapshot:
    """The target is in the north-east corner; one vehicle flies there, one is lost in the south-west one."""
    mass = np.zeros(CASE.pdf.frame.shape, np.float32)
    mass[-5:, -5:] = 1.0 / 25.0
    path = np.array([(600.0, 400.0), (700.0, 450.0), (800.0, 500.0)])
    flying = SearchSample(600.0, 400.0, 0.5, "flying", True, path, (1100.0, 700.0))
    lost = SearchSample(20.0, 20.0, 0.0, "dead", False, np.empty((0, 2)), None)
    return SearchSnapshot(12.0, (flying, lost), mass, 3.2, 0.25, (1150.0, 750.0))


def lines(width: int, height: int) -> list[str]:
    """What a terminal of this size shows."""
    console = Console(file=io.StringIO(), width=width, height=height, color_system=None, _environ={})
    console.print(screen(SCENE, console, snapshot()))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue().splitlines()


@pytest.mark.parametrize("size", [(100, 40), (60, 16), (20, 10), (200, 60)])
def test_a_picture_fits_its_terminal(size: tuple[int, int]) -> None:
    shown = lines(*size)
    assert max(map(len, shown)) <= size[0]
    assert len(shown) <= max(size[1], 9)
    assert any("Ctrl-C" in row for row in shown)


def test_the_picture_has_north_up_and_the_likeliest_darkest() -> None:
    shown = lines(100, 40)
    text = "\n".join(shown)
    assert all(said in text for said in ("12.0 s", "3.20 nat", "25.0 %", "vehicle-1", "flying", "1100, 700"))
    x0, x1, y0, y1 = SCENE.frame.extent
    height, width = fitted((x0, y0, x1, y1), (29, 96))
    area = [row[2:-2].rstrip() for row in shown[3 : 3 + height]]
    edge = width - width // 6  # a sixth of the columns, a quarter of the lines
    assert {row[edge:] for row in area[: height // 4]} == {"█" * (width // 6)}
    assert not any("█" in row for row in area[height // 4 + 1 :])
    assert [k for k, row in enumerate(area) if "×" in row] == [len(area) - 1]
    row, column = next((k, row.index("1")) for k, row in enumerate(area) if "1" in row)
    assert row == pytest.approx(len(area) / 2, abs=1)
    assert column == pytest.approx(max(map(len, area)) / 2, abs=1)
    assert sum(row.count("∙") for row in area) == 2


def test_a_line_tells_how_far_it_is() -> None:
    said = line(SCENE, snapshot())
    assert said == "   12.0 s  detection  25.0 %  entropy  3.20 nat  vehicle-1 flying  vehicle-2 dead"


def test_with_false_alarms_a_line_tells_of_true_reports_and_how_probably_a_target_has_left() -> None:
    said = line(replace(SCENE, false_alarms=True), replace(snapshot(), outside=0.125))
    assert "true report  25.0 %  has left  12.5 %  entropy" in said
