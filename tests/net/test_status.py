"""What ``vedette status`` tells of what robots told."""

from __future__ import annotations

import json
import re

import pytest
from msgspec.structs import replace
from rich.console import Console

from tests.fuzz.decoders import conditions
from tests.support.schemas import valid
from vedette.missions.explore.expected import Expected, Span
from vedette.net.report import Condition
from vedette.net.status import status_table, team_status

(FIRST,) = conditions()  # robot 0, root, with the neighbours 1 and 2
SECOND = replace(FIRST, robot=1, parent=0, neighbours=(0,), size=1)
CONSOLE = Console(width=300)


def said(told: dict[int, Condition | None]) -> list[str]:
    """Lines of the table."""
    with CONSOLE.capture() as shown:
        CONSOLE.print(status_table(told))
    return shown.get().splitlines()


@pytest.mark.parametrize(
    ("told", "verdict"),
    [
        ({0: FIRST, 1: SECOND}, "2 of 2 answered; they are on one tree and hold the same map"),
        ({0: FIRST, 1: SECOND, 2: None}, "2 of 3 answered; these are on one tree and hold the same map"),
        (
            {0: FIRST, 1: replace(SECOND, number=9, digest=1)},
            "2 of 2 answered; they are on 2 trees and hold 2 different maps",
        ),
        ({0: FIRST, 1: None}, "1 of 2 answered"),
        ({0: FIRST}, "1 of 1 answered"),
        ({0: None, 1: None}, "none answered"),
    ],
)
def test_agreement_is_told_of_two_that_answered_or_more(
    told: dict[int, Condition | None], verdict: str
) -> None:
    assert said(told)[-1].strip() == verdict


def test_a_robot_that_said_goodbye_is_told_from_one_that_does_not_answer() -> None:
    (link,) = FIRST.links
    knows = replace(FIRST, links=(replace(link, robot=2, role="left"), replace(link, robot=3, role="down")))
    told = {0: knows, 1: SECOND, 2: None, 3: None}
    lines = said(told)
    assert [line.split("│")[2].strip() for line in lines if re.match("│ robot-[34]", line)] == [
        "left",
        "no answer",
    ]
    assert lines[-1].strip().startswith("2 of 4 answered, 1 left; these are on one tree")
    assert json.loads(team_status(told).to_json())["left"] == ["robot-3"]


def test_a_tree_of_one_robot_is_told_in_the_singular() -> None:
    (row,) = [line for line in said({1: SECOND}) if "robot-2" in line and "old" in line]
    assert "robot-1, 1 robot, " in row


def test_in_json_robots_count_from_1_wherever_they_are_named() -> None:
    text = team_status({0: FIRST, 1: SECOND, 2: None}).to_json()
    valid("status", text.encode())
    robots = json.loads(text)["robots"]
    assert [robots[name] and robots[name]["robot"] for name in robots] == [1, 2, None]
    assert list(robots) == ["robot-1", "robot-2", "robot-3"]
    assert (robots["robot-1"]["parent"], robots["robot-2"]["parent"]) == (None, 1)
    assert robots["robot-1"]["neighbours"] == [2, 3]
    assert robots["robot-1"]["root"] == 1
    assert [link["robot"] for link in robots["robot-1"]["links"]] == [2]


def test_what_is_expected_of_an_exploration_is_told_by_who_knows_most() -> None:
    slow, soon = (
        Expected(Span(90.0, 100.0, 120.0), Span(end, end + 10.0, end + 30.0)) for end in (300.0, 200.0)
    )
    first = replace(FIRST, known_m2=20.0, expected=slow, time=70.0, began=10.0)
    rows = said({0: first, 1: replace(SECOND, known_m2=90.0, expected=soon, time=70.0, began=10.0)})
    assert "expected after 60 s: 90 % known 100 s (90 to 120); end 210 s (200 to 230)" in rows
    assert not any(line.startswith("expected") for line in said({0: FIRST}))


def test_of_ground_whose_size_nobody_knows_no_share_is_told_but_how_much_how_fast_and_what_is_left() -> None:
    open_ground = replace(FIRST, known=None, known_m2=120.4, frontiers=3, began=10.0, time=40.0)
    rows = said({0: open_ground, 1: replace(SECOND, known=0.25)})
    cells = [line.split("│")[3].strip() for line in rows if re.match("│ robot-[12].*old", line)]
    assert cells == ["120 m², 4.0 m²/s, 3 frontiers left", "25.0 %"]
    lost = said({0: replace(open_ground, beyond=17)})
    assert any("3 frontiers left, 17 beams beyond all room" in line for line in lost)
    robots = json.loads(team_status({0: open_ground}).to_json())["robots"]
    assert (robots["robot-1"]["known"], robots["robot-1"]["known_m2"]) == (None, 120.4)
