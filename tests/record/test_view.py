"""Live views at every size of terminal: nothing essential is cut, and the picture uses the room."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from rich.console import Console
from rich.text import Text

from tests.support.search_missions import case
from tests.support.track_scenes import scenario
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.screen import screen as explore_screen
from vedette.record.links import Link
from vedette.record.log import DEAD, LEFT
from vedette.record.search.live import screen as search_screen
from vedette.record.search.log import SearchSample, SearchScene, SearchSnapshot
from vedette.record.track.live import screen as track_screen
from vedette.record.track.log import TrackSample, TrackScene, TrackSnapshot
from vedette.record.view import HINT, flowing, states

SIZES = [(40, 24), (80, 24), (120, 30), (200, 50), (40, 12), (30, 8)]
TEAMS = [1, 3, 8, 20, 40]
NOWHERE = np.empty((0, 2))


def names(count: int, long: bool) -> list[str]:
    return [f"inspection-robot-{i + 1}-of-the-north-wing" if long else f"robot-{i + 1}" for i in range(count)]


def exploring(count: int, long: bool) -> Callable[[Console], object]:
    frame = GridFrame(0.1, 200, 300)
    classes = np.full(frame.shape, FREE, np.uint8)
    classes[::20] = OCCUPIED
    team = tuple(
        RobotSample(
            0.7 * i, 0.5 * i, 0.0, DEAD if i == 1 else "driving", i != 1, NOWHERE, name, (25.5, 12.5), 123.4
        )
        for i, name in enumerate(names(count, long))
    )
    links = tuple(Link(i, i + 1, i > 1, 0.0) for i in range(count - 1))
    snapshot = ExploreSnapshot(1234.5, team, 0.987, 0.654, 12345.0, classes, None, links)
    scene = ExploreScene(
        name="office", vehicles=tuple(names(count, long)), frame=frame, planning=frame.coarse(2)
    )
    return lambda console: explore_screen(scene, console, snapshot)


def tracking(count: int, long: bool) -> Callable[[Console], object]:
    start = {"start": [20, 20, 0], "sensor": {"type": "bearing", "range": 50}}
    scene = TrackScene.of(scenario(vehicles=[start | {"name": name} for name in names(count, long)]), "bay")
    targets = len(scene.targets)
    team = tuple(
        TrackSample(3.0 * i, 20.0, 0.0, DEAD if i == 1 else "flying", i != 1, NOWHERE, tuple(range(targets)))
        for i in range(count)
    )
    means, covariances = np.full((targets, 4), 30.0), np.tile(np.eye(4), (targets, 1, 1))
    snapshot = TrackSnapshot(1234.5, team, 0, means, means, covariances, 123.4, 0.99, 12.0)
    return lambda console: track_screen(scene, console, snapshot)


def searching(count: int, long: bool) -> Callable[[Console], object]:
    found = case(vehicles=[{"start": [100, 100, 60], "name": name} for name in names(count, long)])
    team = tuple(
        SearchSample(30.0 * i, 20.0, 0.0, DEAD if i == 1 else "flying", i != 1, NOWHERE, (1100.0, 700.0))
        for i in range(count)
    )
    mass = np.full(found.pdf.frame.shape, 1.0 / found.pdf.frame.size, np.float32)
    snapshot = SearchSnapshot(1234.5, team, mass, 5.67, 0.987, (1.0, 1.0))
    scene = SearchScene.of(found, 60.0)
    return lambda console: search_screen(scene, console, snapshot)


FIGURES = {
    exploring: ("1234.5 s", "65.4 %", "98.7 %", "12,345 nat"),
    tracking: ("1234.5 s",),
    searching: ("1234.5 s", "98.7 %", "5.67 nat"),
}


def shown(picture: Callable[[Console], object], width: int, height: int, colours: bool = False) -> list[str]:
    console = Console(
        file=io.StringIO(), force_terminal=True, width=width, height=height, legacy_windows=False,
        color_system="truecolor" if colours else None, _environ={"TERM": "xterm-256color"},
    )  # fmt: skip
    console.print(picture(console))
    assert isinstance(console.file, io.StringIO)
    return Text.from_ansi(console.file.getvalue()).plain.splitlines()


@pytest.mark.parametrize("long", [False, True])
@pytest.mark.parametrize("count", TEAMS)
@pytest.mark.parametrize("kind", FIGURES)
def test_a_view_fits_and_says_all_figures_what_everybody_does_and_how_to_stop(
    kind: Callable[[int, bool], Callable[[Console], object]], count: int, long: bool
) -> None:
    for width, height in SIZES:
        lines = shown(kind(count, long), width, height)
        text = "\n".join(lines)
        assert max(map(len, lines)) <= width, (width, height)
        assert len(lines) <= max(height, 12), (width, height, len(lines))
        assert all(figure in text for figure in FIGURES[kind]), (width, height)
        assert HINT in text
        if height >= 24 and width >= 80:
            busy = "driving" if kind is exploring else "flying"
            assert text.count(busy) == count - (count > 1)
            assert text.count(DEAD) == (count > 1)


@pytest.mark.parametrize("count", TEAMS)
def test_the_metres_driven_are_there_in_the_usual_terminal_and_a_narrow_one(count: int) -> None:
    for width, height, most in ((80, 24, 8), (200, 50, 40), (40, 24, 3)):
        if count <= most:
            assert "\n".join(shown(exploring(count, True), width, height)).count("123.4") == count


@pytest.mark.parametrize("count", TEAMS)
def test_the_map_uses_a_large_terminal(count: int) -> None:
    lines = shown(exploring(count, False), 200, 50)
    drawn = [line for line in lines if "·····" in line or "█████" in line or "▀▀▀▀▀" in line]
    assert len(drawn) >= (38 if count < 40 else 30)
    assert max(len(line.strip("│ ").split("   ")[0]) for line in drawn) >= 80


def test_colours_are_explained() -> None:
    text = "\n".join(shown(exploring(3, False), 80, 30, colours=True))
    assert all(f"██ {what}" in text for what in ("free", "wall", "unknown", "about to be seen"))
    assert "the brighter, the likelier" in "\n".join(shown(searching(3, False), 80, 30))
    assert "95 % of where it may be" in "\n".join(shown(tracking(3, False), 80, 30))


def test_one_that_said_goodbye_has_another_sign_than_one_that_was_lost() -> None:
    lost, left = (SearchSample(1.0, 1.0, 0.0, state, False, NOWHERE, None) for state in (DEAD, LEFT))
    assert (lost.fate, left.fate) == ("lost", "left")
    assert states(["a", "b"], [lost, left]) == "a dead  b left"


def _parts() -> Iterator[Text]:
    for length in (3, 9, 4, 30, 1, 12):
        yield Text("x" * length)


@pytest.mark.parametrize("width", [30, 40, 100])
def test_parts_flow_unbroken_and_in_order(width: int) -> None:
    lines = flowing(list(_parts()), width).plain.splitlines()
    assert [len(word) for line in lines for word in line.split()] == [3, 9, 4, 30, 1, 12]
    assert max(map(len, lines)) <= width
