"""The live view: pictures in a terminal, lines elsewhere, silence when asked."""

from __future__ import annotations

import io
import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from tests.support.record_mission import frames, mission, rooms, scene
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.live import explore_display
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.screen import HalfBlocks, screen
from vedette.record.links import Link
from vedette.record.marks import together
from vedette.team import PlatformSpec

SOLID = rooms(80, 120)
SPECS = [PlatformSpec(name=name, range=2.5) for name in ("ada", "bob")]
SCENE = scene("rooms", *frames(SOLID, 0.1, (0.0, 0.0)), ("ada", "bob"))


@pytest.fixture(scope="module")
def snapshots() -> list[ExploreSnapshot]:
    run = mission(SOLID, SPECS, np.random.default_rng(4), (3.0, 3.0), limit=23.0, kill=(1, 15.0))
    return [ExploreSnapshot(**(vars(s) | {"classes": s.classes.copy()})) for s in run]


def _terminal(width: int = 100, height: int = 40, colours: bool = True) -> Console:
    return Console(
        file=io.StringIO(), force_terminal=True, width=width, height=height, legacy_windows=False,
        color_system="truecolor" if colours else None, _environ={"TERM": "xterm-256color"},
    )  # fmt: skip


def _text(console: Console) -> str:
    """Return what the console was sent, without colours and cursor moves."""
    assert isinstance(console.file, io.StringIO)
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", console.file.getvalue())


def _picture(console: Console, snapshot: ExploreSnapshot) -> list[str]:
    console.print(screen(SCENE, console, snapshot))
    return _text(console).splitlines()


def test_without_a_terminal_there_is_a_line_every_ten_seconds_and_at_last(
    snapshots: list[ExploreSnapshot],
) -> None:
    console = Console(file=io.StringIO(), width=40)
    with explore_display(SCENE, console=console) as view:
        for snapshot in snapshots:
            view.update(snapshot)
    lines = _text(console).splitlines()
    assert [float(line.split()[0]) for line in lines] == [0.0, 10.0, 20.0, 23.0]
    assert f"known {100 * snapshots[10].known_fraction:5.1f} %" in lines[1]
    assert f"entropy {snapshots[10].entropy:.0f} nat" in lines[1]
    assert "ada driving" in lines[1]
    assert "bob dead" in lines[3]


@pytest.mark.parametrize("terminal", [True, False])
def test_of_ground_that_nobody_knows_the_view_tells_area_rate_and_frontiers_and_no_share(
    snapshots: list[ExploreSnapshot], terminal: bool
) -> None:
    nobody_knows = {"coverage": None, "known_fraction": None, "entropy": None}
    shown = replace(snapshots[10], **nobody_knows, known_m2=45.0, frontiers=7)
    console = _terminal() if terminal else Console(file=io.StringIO(), width=200)
    with explore_display(SCENE, console=console) as view:
        view.update(shown)
    text = _text(console)
    for said in ("known 45.0 m²", "rate 4.50 m²/s", "frontiers left 7"):
        assert said in text
    assert "%" not in text


def _with_links(snapshot: ExploreSnapshot, *links: Link) -> ExploreSnapshot:
    return ExploreSnapshot(**(vars(snapshot) | {"links": links}))


def test_a_team_is_named_by_its_parts() -> None:
    assert together(((0, 1, 2),)) == together(()) == "together"
    assert together(((0, 1), (2,), (9, 10))) == "apart: {1,2} {3} {A,B}"


@pytest.mark.parametrize("terminal", [True, False])
def test_the_view_says_whether_the_team_is_together_where_links_are_simulated(
    snapshots: list[ExploreSnapshot], terminal: bool
) -> None:
    ideal, alone = snapshots[0], _with_links(snapshots[0])
    linked, beside = (_with_links(snapshots[0], Link(0, 1, on_tree, 0.0)) for on_tree in (True, False))
    for snapshot, team in ((ideal, None), (linked, "together"), (beside, "apart"), (alone, "apart")):
        console = _terminal() if terminal else Console(file=io.StringIO(), width=200)
        with explore_display(SCENE, console=console) as view:
            view.update(snapshot)
        said = re.findall(r"together|apart: \{1\} \{2\}|apart", _text(console))
        assert set(said) == ({team.replace("apart", "apart: {1} {2}")} if team else set())


@pytest.mark.parametrize("terminal", [True, False])
def test_the_view_says_whose_maps_are_joined_where_frames_are_unknown(
    snapshots: list[ExploreSnapshot], terminal: bool
) -> None:
    found = FramesFound((), 0, {}, (("robot-1", "robot-3"), ("robot-2",)), 0.1, 1.0)
    for snapshot, told in ((snapshots[0], False), (replace(snapshots[0], frames=found), True)):
        console = _terminal() if terminal else Console(file=io.StringIO(), width=200)
        with explore_display(SCENE, console=console) as view:
            view.update(snapshot)
        assert ("maps 1+3 | 2" in _text(console)) == told


@pytest.mark.parametrize("terminal", [True, False])
def test_a_quiet_view_prints_nothing(snapshots: list[ExploreSnapshot], terminal: bool) -> None:
    console = Console(file=io.StringIO(), force_terminal=terminal)
    with explore_display(SCENE, quiet=True, console=console) as view:
        for snapshot in snapshots:
            view.update(snapshot)
    assert _text(console) == ""


def test_a_terminal_gets_at_most_ten_pictures_a_second_and_the_last(
    snapshots: list[ExploreSnapshot],
) -> None:
    console = _terminal()
    ticks = itertools.count()
    with explore_display(SCENE, console=console, clock=lambda: next(ticks) / 1000) as view:
        for snapshot in snapshots:  # 24 snapshots in less than 0.1 s
            view.update(snapshot)
    pictures = _text(console).count("covered")
    assert pictures <= 3
    assert f"{snapshots[-1].t:.1f} s" in _text(console).split("covered")[-2]


def test_an_interruption_leaves_the_last_picture_and_the_cursor(snapshots: list[ExploreSnapshot]) -> None:
    console = _terminal()

    def interrupted() -> None:
        with explore_display(SCENE, console=console) as view:
            view.update(snapshots[3])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert isinstance(console.file, io.StringIO)
    assert "\x1b[?25h" in console.file.getvalue()
    assert "3.0 s" in _text(console)


@pytest.mark.parametrize("size", [(200, 60), (130, 40), (80, 24), (60, 10), (30, 5)])
def test_the_picture_never_exceeds_the_terminal_width_and_shows_every_robot(
    snapshots: list[ExploreSnapshot], size: tuple[int, int]
) -> None:
    lines = _picture(_terminal(*size), _with_links(snapshots[-1]))
    assert max(len(line) for line in lines) <= size[0]
    if size[0] >= 60:
        text = "\n".join(lines)
        ways = [f"{robot.driven:.1f}" for robot in snapshots[-1].robots]
        for word in ("ada", "driving", "bob", "dead", *ways):
            assert word in text
    if size[1] >= 24:
        assert len(lines) <= size[1]


def test_without_colours_walls_and_robots_are_drawn_with_characters(snapshots: list[ExploreSnapshot]) -> None:
    text = "\n".join(_picture(_terminal(colours=False), snapshots[-1]))
    for glyph in ("█", "·", "1", "×"):
        assert glyph in text


def test_the_map_has_the_building_the_right_way_up(snapshots: list[ExploreSnapshot]) -> None:
    console = _terminal(130, 40, colours=False)
    console.print(HalfBlocks.of(console, SCENE, snapshots[0], (24, 70)))
    building = _text(console).splitlines()
    robot = snapshots[0].robots[0]
    row = next(i for i, line in enumerate(building) if "1" in line)
    assert (len(building), len(building[0])) == (24, 70)
    assert row == pytest.approx((1 - robot.y / 8.0) * len(building), abs=1)
    assert building[row].index("1") == pytest.approx(robot.x / 12.0 * 70, abs=1)
