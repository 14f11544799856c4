"""The page in Chromium: it loads, follows, replays, gives each order, comes back, and fits a phone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.support.places import ROOT
from tests.support.windows import SCENE, needs_chromium, shown, snapshot
from vedette.agent.orders import End, LookThere, NoGo, Order, Pause, Priority, Recall, Remove, Resume, Stay
from vedette.record import palette
from vedette.record.explore.log import Ahead
from vedette.record.explore.summary import LeftOut
from vedette.window.export import Show, export_page, page_with, records_in
from vedette.window.hub import Hub
from vedette.window.picture import Beside, picture
from vedette.window.server import WindowServer

playwright = pytest.importorskip("playwright.sync_api")
pytestmark = needs_chromium
FRONTIER = [86, 180, 233]
UNKNOWN, FREE, WALL = ([*colour] for colour in palette.CLASSES.tolist())


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Debian's Chromium; playwright's own cannot be downloaded everywhere."""
    with playwright.sync_playwright() as engine:
        opened = engine.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page of its own; an error in it fails the test."""
    errors: list[str] = []
    opened = browser.new_page(viewport={"width": 1280, "height": 720})
    opened.on("pageerror", lambda error: errors.append(str(error)))
    yield opened
    opened.close()
    assert errors == []


def until(page: Any, holds: str) -> None:
    """Wait until an expression holds in the page, whose policy lets nobody evaluate one there."""
    for _ in range(100):
        if page.evaluate(holds):
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"it never came to {holds}")


def pixel(page: Any, col: int, row: int) -> list[int]:
    """The colour of a cell of the page's map, row 0 the topmost."""
    colour: list[int] = page.evaluate(f"[...picture.getContext('2d').getImageData({col}, {row}, 1, 1).data]")
    return colour[:3]


def see(page: Any, hub: Hub, selector: str, text: str) -> None:
    """Wait until the page says something, while the mission goes on."""
    t = 0.0 if hub._latest is None else hub._latest.t
    for _ in range(100):
        if text in page.inner_text(selector):
            return
        t += 0.05
        if hub.live and not hub.closed:
            hub.show(picture(SCENE, snapshot(t)))
        page.wait_for_timeout(50)
    raise AssertionError(f"{selector} says {page.inner_text(selector)!r}, not {text!r}")


def test_a_live_mission_is_followed_and_a_lost_robot_stays_on_the_screen(page: Any) -> None:
    hub = shown(range(8))
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        assert page.inner_text("#name") == "hall"
        assert "covered" in page.inner_text("#figures")
        assert page.inner_text("#robots").split()[:3] == ["1", "scout", "driving"]
        assert pixel(page, 2, 30) == FREE
        assert pixel(page, 7, 30) == FRONTIER  # beside what is unknown
        assert pixel(page, 90, 30) == [
            216,
            219,
            222,
        ]
        assert pixel(page, 2, 69) == [
            28,
            30,
            33,
        ]
        lost = snapshot(9.0, ("driving", "dead"))
        hub.show(picture(SCENE, lost, Beside(silent={2: 12.0})))
        page.wait_for_selector("tr.gone")
        assert "silent 12 s" in page.inner_text("#robots")
        assert "mule: lost" in page.inner_text("#alerts")
        assert "mule: dead" in page.inner_text("#log")
        hub.close()
        see(page, hub, "#state", "the mission is over")
        assert page.is_disabled("text=Pause")


def test_why_a_robot_goes_where_it_goes_is_told_when_it_is_selected(page: Any) -> None:
    hub = shown(range(3))
    told = snapshot(3.0)
    tour = (Ahead(2.0, 3.0, 4.0, 1.5), Ahead(5.0, 3.0, 9.0, 0.5))
    robots = tuple(replace(robot, tour=tour[i:]) for i, robot in enumerate(told.robots))
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        hub.show(picture(SCENE, replace(told, t=9.0, robots=robots)))
        until(page, "$('clock').textContent === '9.0 s'")
        page.keyboard.press("1")
        lines = page.inner_text("#why")
        assert "1. at 2.0, 3.0 m in 4 s: 1.5 m² unknown there" in lines
        assert "2. at 5.0, 3.0 m in 9 s" in lines
        assert "mule sees to 0.5 m² at 1 places of the rest" in lines


def test_battery_traffic_trust_and_what_was_given_up_are_told(page: Any) -> None:
    hub = shown(range(3))
    told = snapshot(3.0)
    scout = replace(told.robots[0], way_left=41.6, rounds=12, sent=3_400_000, trust="believed")
    mule = replace(told.robots[1], rounds=11, sent=9_000, trust="not believed by scout")
    left = (LeftOut(1.0, 2.5, 9, "unseeable", "scout"), LeftOut(4.0, 2.5, 9, "out_of_reach", "mule"))
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        assert not page.is_visible("#leaves")
        full = Beside(alerts=["scout: disk full: 3 MB left for kept"])
        hub.show(picture(SCENE, replace(told, t=9.0, robots=(scout, mule), left_out=left), full))
        until(page, "$('clock').textContent === '9.0 s'")
        assert "battery for 42 m, 12 rounds, 3.4 MB sent, believed" in page.inner_text("#robots")
        assert page.inner_text(".more.bad") == "11 rounds, 9.0 kB sent, not believed by scout"
        assert page.inner_text("#alerts") == "scout: disk full: 3 MB left for kept"
        assert "rounds 12" in page.inner_text("#figures")
        assert "sent 3.4 MB" in page.inner_text("#figures")
        assert page.inner_text("#left").splitlines() == [
            "1.0, 2.5 m: looked at in vain, says scout",
            "4.0, 2.5 m: no way there, says mule",
        ]


def test_a_record_is_scrubbed_and_played(page: Any) -> None:
    hub = shown(range(40), live=False)
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "recorded")
        assert page.inner_text("#clock") == "0.0 s"
        assert not page.is_visible("#commands")
        page.evaluate("$('bar').value = 30; $('bar').oninput()")
        until(page, "$('clock').textContent === '30.0 s'")
        assert pixel(page, 28, 30) == [
            255,
            255,
            255,
        ]
        page.evaluate("$('bar').value = 5; $('bar').oninput()")
        until(page, "$('clock').textContent === '5.0 s'")
        assert pixel(page, 28, 30) == [
            216,
            219,
            222,
        ]
        hub.note("robots wait", 3.0)
        hub.note("robots hear nothing", 6.0)
        page.evaluate("$('bar').value = 4; $('bar').oninput()")
        until(page, "$('clock').textContent === '4.0 s'")
        assert "robots wait" in page.inner_text("#log")
        assert "robots hear nothing" not in page.inner_text("#log")
        page.click("#play")
        until(page, "parseFloat($('clock').textContent) >= 8")
        assert "robots hear nothing" in page.inner_text("#log")
        page.click("#play")


def test_an_exported_page_plays_by_itself(page: Any, tmp_path: Path) -> None:
    hub, other = shown(range(15), live=False), shown(range(5), live=False)
    hub.note("robots hear </script> nothing", 9.0)
    path = tmp_path / "show.html"
    export_page([Show("a day", hub.history, hub.events(0)[1]), Show("another", other.history)], path)
    page.goto(f"file://{path}")
    until(page, "parseFloat($('clock').textContent) >= 3")
    assert page.inner_text("#name") == "a day"
    assert "nothing" not in page.inner_text("#log")
    page.evaluate("$('bar').value = 12; $('bar').oninput()")
    assert page.inner_text("#clock") == "12.0 s"
    assert pixel(page, 11, 30) == FREE
    assert pixel(page, 13, 30) == UNKNOWN
    assert "robots hear </script> nothing" in page.inner_text("#log")
    page.evaluate("$('bar').value = 2; $('bar').oninput()")
    assert pixel(page, 11, 30) == UNKNOWN
    assert "nothing" not in page.inner_text("#log")
    page.select_option("#shows", label="another")
    until(page, "$('name').textContent === 'another'")


def test_the_theatre_in_the_docs_is_todays_page_and_plays_what_befalls_teams(page: Any) -> None:
    path = ROOT / "docs" / "theatre.html"
    written = path.read_text(encoding="utf-8")
    assert page_with(records_in(written)) == written, "`make theatre ARGS=--kept` renews it"
    page.goto(f"file://{path}")
    until(page, "parseFloat($('clock').textContent) >= 3")
    scenes = page.inner_text("#shows").splitlines()
    assert [
        word for word in ("cut in two", "crashes", "meet and part", "lies") if word in " ".join(scenes)
    ] == [
        "cut in two",
        "crashes",
        "meet and part",
        "lies",
    ]
    for scene in scenes:
        page.select_option("#shows", label=scene.strip())
        until(page, f"$('name').textContent === {scene.strip()!r} && parseFloat($('clock').textContent) >= 2")


ORDERS: list[tuple[str, str, Order]] = [
    ("p", "Pause", Pause()),
    ("r", "Resume", Resume()),
    ("h", "Recall", Recall()),
    ("s", "Stay", Stay()),
    ("", "End", End()),
]


def test_each_order_is_given_by_a_click_or_a_key_after_one_question(page: Any) -> None:
    given: list[Order] = []
    hub = shown(range(5), lambda order: given.append(order) or "taken by scout")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        for key, button, order in ORDERS:
            see(page, hub, "#state", "live")
            page.keyboard.press(key) if key else page.click(f"#commands >> text={button}")
            assert "for the whole team?" in page.inner_text("#question")
            hub.show(picture(SCENE, snapshot(hub.history.span[1] + 1.0)))
            page.wait_for_timeout(100)
            page.click("#yes")
            see(page, hub, "#hint", "taken by scout")
            assert given[-1] == order
            page.evaluate("hint('')")
        assert len(given) == len(ORDERS)
        page.click("tr.robot >> text=mule")
        see(page, hub, "#whom", "mule")
        page.click("#commands >> text=Pause")
        assert "for mule?" in page.inner_text("#question")
        page.click("#no")
        assert len(given) == len(ORDERS)


def test_the_keyboard_alone_selects_looks_back_fits_and_takes_up_tools(page: Any) -> None:
    hub = shown(range(30), lambda order: "taken")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        page.keyboard.press("2")
        see(page, hub, "#whom", "mule")
        page.keyboard.press("Escape")
        see(page, hub, "#whom", "the team")
        page.keyboard.press("l")
        assert page.inner_text("#hint") == "Click where to look."
        page.keyboard.press("Escape")
        assert page.inner_text("#hint") == ""
        page.focus("#map")
        page.evaluate("view.fitted = false; view.scale *= 3")
        page.keyboard.press("f")
        assert page.evaluate("view.fitted")
        page.keyboard.press("Space")
        see(page, hub, "#state", "looking back")
        until(page, "parseFloat($('clock').textContent) >= 2")
        page.keyboard.press("Space")
        assert page.inner_text("#play") == "Play"
        page.keyboard.press("0")
        see(page, hub, "#state", "live")
        page.focus("tr.robot")
        page.keyboard.press("Enter")
        see(page, hub, "#whom", "scout")
        page.keyboard.press("p")
        assert "for scout?" in page.inner_text("#question")
        page.keyboard.press("Escape")
        assert not page.is_visible("#question")


def test_places_and_areas_are_drawn_by_clicks(page: Any) -> None:
    given: list[Order] = []
    hub = shown(range(5), lambda order: given.append(order) or "taken by scout")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")

        def click(x: float, y: float) -> None:
            px, py = page.evaluate(f"place({x}, {y}).map((v) => v / (window.devicePixelRatio || 1))")
            box = page.locator("#map").bounding_box()
            page.mouse.click(box["x"] + px, box["y"] + py)

        def confirm(words: str) -> Order:
            assert words in page.inner_text("#question")
            hub.show(picture(SCENE, snapshot(hub.history.span[1] + 1.0)))
            page.wait_for_timeout(100)
            page.click("#yes")
            see(page, hub, "#hint", "taken by scout")
            page.evaluate("hint('')")
            return given[-1]

        see(page, hub, "#robots", "mule")
        page.keyboard.press("2")
        page.click("#commands >> text=Look there")
        click(3.0, 4.0)
        look = confirm("for mule?")
        assert isinstance(look, LookThere)
        assert look.robot == 2
        assert look.at == pytest.approx((3.0, 4.0), abs=0.05)
        page.keyboard.press("Escape")
        for key, kind in (("n", NoGo), ("i", Priority)):
            see(page, hub, "#state", "live")
            page.keyboard.press(key)
            for corner in ((1.0, 2.0), (4.0, 2.0), (4.0, 5.0)):
                click(*corner)
            page.keyboard.press("Enter")
            area = confirm("for all robots?")
            assert isinstance(area, kind)
            assert [*area.corners[2]] == pytest.approx([4.0, 5.0], abs=0.05)
        told = snapshot(80.0)
        scout = replace(told.robots[0], orders=tuple(given[-2:]))
        hub.show(picture(SCENE, replace(told, robots=(scout, told.robots[1]))))
        until(page, "$('orders').childElementCount === 2")
        assert "held by scout" in page.inner_text("#orders")
        page.click(f"#commands >> text=Remove priority {area.area}")
        assert confirm("for all robots?") == Remove(area=area.area)


def test_an_order_asked_on_a_picture_that_has_grown_old_is_refused(page: Any) -> None:
    given: list[Order] = []
    hub = shown(range(5), lambda order: given.append(order) or "taken")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        page.click("#commands >> text=Pause")
        page.wait_for_timeout(3200)
        page.click("#yes")
        until(page, "$('hint').textContent.startsWith('refused: the picture')")
        assert given == []
        assert page.is_disabled("text=Pause")
        assert page.inner_text("#state") == "no news"


def test_two_watch_and_one_whose_connection_breaks_comes_back(page: Any, browser: Any) -> None:
    hub = shown(range(5))
    second = browser.new_page()
    with WindowServer(hub) as window:
        for each in (page, second):
            each.goto(window.address)
            see(each, hub, "#state", "live")
        page.evaluate("socket.close()")
        until(page, "$('state').textContent.startsWith('connection lost')")
        see(page, hub, "#state", "live")
        see(second, hub, "#state", "live")
        port, token = window.port, window.token
    until(page, "$('state').textContent === 'the window is closed'")
    hub = shown(range(3))
    with WindowServer(hub, port=port, token=token):
        see(page, hub, "#state", "live")
    second.close()


def test_a_page_whose_team_has_ended_says_so_and_not_that_it_tries_again(page: Any) -> None:
    hub = shown(range(5), lambda order: "taken")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        hub.close()
    until(page, "socket.readyState === 3")
    page.wait_for_timeout(700)
    assert page.inner_text("#state") == "the mission is over"
    assert page.get_attribute("#state", "class") == ""
    assert page.is_disabled("text=Pause")


def test_a_robot_is_selected_by_a_slow_finger_while_pictures_come(page: Any) -> None:
    hub = shown(range(5), lambda order: "taken")
    with WindowServer(hub) as window:
        page.goto(window.address)
        see(page, hub, "#state", "live")
        box = page.locator("tr.robot >> text=mule").bounding_box()
        page.mouse.move(box["x"] + 5, box["y"] + 5)
        page.mouse.down()
        for t in (10.0, 11.0, 12.0):
            hub.show(picture(SCENE, snapshot(t)))
            until(page, f"$('clock').textContent === '{t:.1f} s'")
        page.mouse.up()
        see(page, hub, "#whom", "mule")


def test_each_robot_keeps_its_own_trail_and_key_when_another_is_heard_of_later(page: Any) -> None:
    hub, told = shown(range(0)), snapshot(3.0)
    with WindowServer(hub) as window:
        page.goto(window.address)
        until(page, "$('state').textContent === 'nobody has been heard yet'")
        hub.show(picture(SCENE, replace(told, robots=told.robots[1:]), Beside(numbers=(2,))))
        until(page, "past.length === 1")
        hub.show(picture(SCENE, snapshot(4.0)))
        until(page, "past.length === 2")
        assert page.evaluate("past.map(([, , places]) => places[2][1])") == [5.0, 5.0]
        assert page.evaluate("past.map(([, , places]) => 1 in places)") == [False, True]
        hub.show(picture(SCENE, replace(snapshot(5.0), robots=told.robots[1:]), Beside(numbers=(2,))))
        until(page, "past.length === 3")
        page.keyboard.press("1")
        assert page.inner_text("#whom") == "the team"
        page.keyboard.press("2")
        see(page, hub, "#whom", "mule")


def test_a_phone_has_all_of_it_and_nothing_beyond_its_edge(page: Any) -> None:
    hub = shown(range(5), lambda order: "taken")
    with WindowServer(hub) as window:
        page.set_viewport_size({"width": 390, "height": 844})
        page.goto(window.address)
        see(page, hub, "#state", "live")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        for selector in ("#map", "#robots", "#commands", "#bar", "#log"):
            assert page.locator(selector).count() == 1
        box = page.locator("#map").bounding_box()
        assert box["width"] > 350
        assert box["height"] > 300
