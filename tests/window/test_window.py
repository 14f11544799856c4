"""What the operator's window sends and takes: nothing without the token, deltas only, no nonsense."""

from __future__ import annotations

import json
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from tests.support.windows import FRAME, SCENE, shown, snapshot
from vedette.agent.orders import Order, Pause
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.window.history import History
from vedette.window.hub import FRESH, Hub
from vedette.window.picture import SHADES, TILE, Picture, changes, ordered, picture, shaded
from vedette.window.server import WindowServer


@contextmanager
def watching(window: WindowServer) -> Iterator[ClientConnection]:
    """A page's connection."""
    address = window.address.replace("http", "ws").replace("/?", "/watch?")
    with connect(address) as connection:
        yield connection


class Page:
    """What a page has been told."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.map: np.ndarray | None = None
        self.about: dict[str, Any] = {}
        self.bytes = 0

    def until(self, wanted: str) -> dict[str, Any]:
        """Take what comes until something with this field does."""
        while True:
            message = self.connection.recv(timeout=5.0)
            if isinstance(message, bytes):
                self._lay(message)
                continue
            told: dict[str, Any] = json.loads(message)
            if "now" in told:
                self.about = told
                if told["whole"]:
                    self.map = np.zeros(told["map"][1:3], np.uint8)
            if wanted in told:
                if wanted == "now" and told["whole"]:
                    self._lay(self.connection.recv(timeout=5.0))
                return told

    def _lay(self, data: Any) -> None:
        assert self.map is not None
        self.bytes += len(data)
        size = 4 + TILE * TILE
        for at in range(0, len(data), size):
            row, col = np.frombuffer(data[at : at + 4], "<u2").astype(int) * TILE
            tile = np.frombuffer(data[at + 4 : at + size], np.uint8).reshape(TILE, TILE)
            part = self.map[row : row + TILE, col : col + TILE]
            part[:] = tile[: part.shape[0], : part.shape[1]]


def test_without_the_token_nothing_is_shown() -> None:
    with WindowServer(shown(range(3))) as window:
        page = urllib.request.urlopen(window.address, timeout=5.0)
        assert b"<title>Vedette</title>" in page.read()
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        for path in ("/", "/?token=", "/?token=wrong", "/watch", f"/page.html?token={window.token}x"):
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(f"http://127.0.0.1:{window.port}{path}", timeout=5.0)
        for path in ("/watch", "/watch?token=wrong"):
            with pytest.raises(InvalidStatus, match="403"), connect(f"ws://127.0.0.1:{window.port}{path}"):
                pass


def test_a_page_gets_the_whole_map_once_and_then_what_changes() -> None:
    hub = shown(range(6))
    with WindowServer(hub) as window, watching(window) as connection:
        page = Page(connection)
        assert page.until("hello") == {"hello": "hall", "live": True, "orders": False}
        assert [t for t, _, _ in page.until("past")["past"]] == [0, 1, 2, 3, 4, 5]
        page.until("now")
        assert page.map is not None
        np.testing.assert_array_equal(page.map, snapshot(5.0).classes)
        before = page.bytes
        hub.show(picture(SCENE, snapshot(6.0)))
        page.until("now")
        page._lay(connection.recv(timeout=5.0))
        np.testing.assert_array_equal(page.map, snapshot(6.0).classes)
        assert page.bytes - before == -(-FRAME.rows // TILE) * (4 + TILE * TILE)  # a column of tiles
        assert page.about["now"]["robots"][0]["x"] == pytest.approx(-0.9)


def test_two_pages_look_at_different_times() -> None:
    hub = shown(range(20))
    with WindowServer(hub) as window, watching(window) as one, watching(window) as other:
        first, second = Page(one), Page(other)
        first.until("now")
        second.until("now")
        one.send(json.dumps({"seek": 3.4}))
        assert first.until("now")["now"]["t"] == 3.0
        hub.show(picture(SCENE, snapshot(20.0)))
        assert second.until("now")["now"]["t"] == 20.0
        one.send(json.dumps({"live": True}))
        assert first.until("now")["now"]["t"] == 20.0


@pytest.mark.parametrize(
    "nonsense",
    [
        "{",
        "[]",
        "7",
        '{"seek": "now"}',
        '{"order": 3, "seen": 1, "id": 1}',
        '{"order": {"order": "explode"}, "seen": 1, "id": 1}',
        '{"order": {"order": "pause", "robot": -1}, "seen": 1, "id": 1}',
        b"\xff\xfe",
        "x" * 20_000,
    ],
)
def test_a_page_that_sends_garbage_is_cut_off_and_the_others_go_on(nonsense: str | bytes) -> None:
    given: list[Order] = []
    hub = shown(range(3), lambda order: given.append(order) or "taken")
    with WindowServer(hub) as window, watching(window) as good, watching(window) as bad:
        Page(good).until("now")
        Page(bad).until("now")
        bad.send(nonsense)
        with pytest.raises(ConnectionClosed):
            list(bad)
        hub.show(picture(SCENE, snapshot(3.0)))
        assert Page(good).until("now")["now"]["t"] == 3.0
    assert given == []


def test_an_order_is_given_once_and_answered_and_all_can_read_that_it_was() -> None:
    given: list[Order] = []
    hub = shown(range(3), lambda order: given.append(order) or "taken by scout")
    with WindowServer(hub) as window, watching(window) as connection, watching(window) as other:
        page = Page(connection)
        seen = page.until("now")["n"]
        order = {"order": "pause", "robot": 2}
        connection.send(json.dumps({"order": order, "seen": seen, "id": 7}))
        assert page.until("answer") == {"answer": "taken by scout", "id": 7}
        assert given == [Pause(robot=2)]
        before = Page(other).until("now")["events"]
        hub.show(picture(SCENE, snapshot(3.0)))
        after = Page(other).until("now")["events"]
        assert [*before, *after].count([2.0, "order pause robot 2: taken by scout"]) == 1


def test_an_order_on_an_old_picture_is_refused() -> None:
    time = [0.0]
    given: list[Order] = []
    hub = Hub("hall", lambda order: given.append(order) or "taken", clock=lambda: time[0])
    hub.show(picture(SCENE, snapshot(1.0)))
    assert hub.order({"order": "pause"}, FRESH + 0.1).startswith("refused: the picture")
    time[0] = FRESH + 0.1  # nothing has been heard of the team for so long
    assert hub.order({"order": "pause"}, 0.1).startswith("refused: the picture")
    assert given == []
    hub.show(picture(SCENE, snapshot(2.0)))
    assert hub.order({"order": "pause"}, 0.1) == "taken"


def test_what_happens_meanwhile_does_not_take_away_what_a_page_looks_back_at() -> None:
    hub = shown(range(20))
    with WindowServer(hub) as window, watching(window) as one, watching(window) as other:
        first, second = Page(one), Page(other)
        first.until("now")
        second.until("now")
        one.send(json.dumps({"seek": 3.0}))
        assert first.until("now")["now"]["t"] == 3.0
        for t in (20.0, 21.0, 22.0):
            hub.show(picture(SCENE, snapshot(t)))
            assert second.until("now")["now"]["t"] == t
        one.send(json.dumps({"seek": 5.0}))
        assert first.until("now")["now"]["t"] == 5.0


def test_who_looks_back_hears_of_the_end_and_may_ask_for_now_after_it() -> None:
    hub = shown(range(20))
    with WindowServer(hub) as window, watching(window) as connection:
        page = Page(connection)
        page.until("now")
        connection.send(json.dumps({"seek": 3.0}))
        assert page.until("now")["now"]["t"] == 3.0
        hub.close()
        assert page.until("over")["over"] == "the mission is over"
        connection.send(json.dumps({"live": True}))
        connection.send(json.dumps({"seek": 5.0}))
        assert page.until("now")["now"]["t"] == 5.0
        assert window.cut_off == 0


def test_a_record_takes_no_orders_and_a_refusal_is_told() -> None:
    assert "record" in shown(range(2), live=False).order({"order": "pause"}, 0.0)

    def refuse(order: Order) -> str:
        raise InputError("robot-1: there is a wall at 1, 2")

    hub = shown(range(2), refuse)
    assert hub.order({"order": "recall", "to": [1, 2]}, 0.0) == "refused: robot-1: there is a wall at 1, 2"


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 70), st.integers(1, 70), st.randoms(use_true_random=False))
def test_changes_make_one_map_of_another(rows: int, cols: int, chance: Any) -> None:
    rng = np.random.default_rng(chance.randrange(1 << 30))
    frame = GridFrame(0.1, rows, cols)
    first = rng.integers(0, 3, (rows, cols)).astype(np.uint8)
    second = first.copy()
    second.flat[rng.integers(0, rows * cols, 3)] = rng.integers(0, 3, 3)
    page = Page.__new__(Page)
    page.map, page.bytes = np.zeros((rows, cols), np.uint8), 0
    for shows, classes in ((None, first), (first, second)):
        whole, data = changes(frame, classes, shows)
        assert whole == (shows is None)
        page._lay(data)
        np.testing.assert_array_equal(page.map, classes)
    assert changes(frame, second, second) == (False, b"")


def test_what_is_about_to_be_seen_is_shaded_where_it_is_unknown_and_nowhere_else() -> None:
    told = snapshot(10.0)
    impact = np.zeros(SCENE.planning.shape, np.float32)
    impact[:, 4:8] = 0.5  # columns 8 to 15, of which 0 to 10 are known
    shades = shaded(SCENE, replace(told, impact=impact))
    known = told.classes > 0
    np.testing.assert_array_equal(shades[known], told.classes[known])
    assert set(shades[1:, 11:16].flat) == {2 + SHADES // 2}
    assert not shades[1:, 16:].any()


def test_history_thins_out_and_keeps_the_first_and_finds_what_was_before_a_time() -> None:
    history, frame = History(), GridFrame(1.0, 1, 1)
    for t in range(9000):
        history.add(Picture(float(t), b'{"t":0}', frame, np.zeros((1, 1), np.uint8)))
    assert history.span[0] == 0.0
    assert len(history.told()) <= 1000
    found = history.at(4567.0)
    assert found is not None
    assert 4567.0 - 8.0 < found.t <= 4567.0


def test_who_holds_an_order_is_told() -> None:
    orders, areas = ordered([("scout", [Pause(robot=2)]), ("mule", [])])
    assert orders == [("pause robot 2", ["scout"])]
    assert areas == []
