"""Serves the page and what it shows over one port: nothing to whoever does not have the token."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from importlib.resources import files
from types import TracebackType
from typing import Any, Self
from urllib.parse import parse_qs, urlsplit

import msgspec
import numpy as np
from numpy.typing import NDArray
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from vedette.errors import InputError
from vedette.window.hub import LOOPBACK, Hub
from vedette.window.picture import Picture, changes

MOST_ASKED = 16 << 10  # bytes of what a page says
INLINE = "script-src 'unsafe-inline'; style-src 'unsafe-inline'"  # the page is one file
POLICY = f"default-src 'none'; {INLINE}; connect-src 'self'; img-src data:"
NO_TOKEN = b"the token is missing or wrong: use the whole address\n"
CLOSED = "the window is closed"  # whether or not the mission goes on
NONSENSE = 1008  # how a page that makes no sense is cut off: a policy violation
WAKE = 1.0  # a watcher hears at least so often that nothing is new [s]


class WindowServer:
    """A server in threads of its own, for as long as it is entered."""

    def __init__(self, hub: Hub, host: str = LOOPBACK, port: int = 0, token: str | None = None) -> None:
        """Listen; port 0: any that is free.

        Raises:
            InputError: the address cannot be listened on.
        """
        self.hub, self.token = hub, token or secrets.token_urlsafe(18)
        self.cut_off = 0  # pages that made no sense
        page = files("vedette.window").joinpath("page.html").read_bytes()
        self._page = page
        try:
            self._server: Server = serve(
                self._watch, host, port, process_request=self._answer, max_size=MOST_ASKED, server_header=None
            )
        except OSError as error:
            raise InputError(
                f"cannot listen on {host}:{port}: {error.strerror or error}; choose another --host or --port"
            ) from error
        self.host, self.port = host, self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, name="window", daemon=True)

    @property
    def address(self) -> str:
        """Where a browser finds the page."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}/?token={self.token}"

    def __enter__(self) -> Self:
        """Begin to serve."""
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop."""
        self.hub.close(CLOSED)
        self._server.shutdown(reason=self.hub.closed)
        self._thread.join()

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return the page; None: go on with the handshake of a watcher. Without the token nothing at all."""
        url = urlsplit(request.path)
        given = parse_qs(url.query).get("token", [""])[0]
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            return _page(HTTPStatus.FORBIDDEN, NO_TOKEN, "text/plain")
        if url.path == "/watch":
            return None
        if url.path != "/":
            return _page(HTTPStatus.NOT_FOUND, b"not found\n", "text/plain")
        return _page(HTTPStatus.OK, self._page, "text/html; charset=utf-8")

    def _watch(self, connection: ServerConnection) -> None:
        """Show a watcher all there is until it goes."""
        watcher = _Watcher(self.hub, connection)
        reader = threading.Thread(target=self._hear, args=(watcher, connection), daemon=True)
        reader.start()
        with suppress(ConnectionClosed):
            watcher.run()

    def _hear(self, watcher: _Watcher, connection: ServerConnection) -> None:
        """Take what a page asks for; one that makes no sense is cut off."""
        try:
            for message in connection:
                try:
                    watcher.hear(message)
                except (ValueError, TypeError, InputError):
                    self.cut_off += 1
                    connection.close(NONSENSE, "that makes no sense")
                    return
        except ConnectionClosed:
            pass
        finally:
            watcher.gone()


class _Watcher:
    """One page: what it shows, and what it asks for."""

    def __init__(
        self, hub: Hub, connection: ServerConnection, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._hub, self._connection, self._clock = hub, connection, clock
        self._send_lock = threading.Lock()
        self._shown: NDArray[np.uint8] | None = None  # the map that the page has
        self._frame: object = None
        self._seen = -1  # number of the picture that it has
        self._told = 0  # entries of what has happened
        self._sent: dict[int, float] = {}  # when it was sent each picture [s]
        self._numbers = 0
        self._at: float | None = None if hub.live else 0.0  # the time that it looks at [s]; None: now
        self._wake = threading.Event()
        self._gone = self._over = False

    def gone(self) -> None:
        """Note that nobody looks any more."""
        self._gone = True
        self._wake.set()

    def run(self) -> None:
        """Show the latest picture whenever there is one, until the page goes."""
        hub = self._hub
        self._say({"hello": hub.name, "live": hub.live, "orders": hub.takes_orders})
        self._show_trails()
        if not hub.live:
            self._seek(hub.history.span[0])
        while not self._gone:
            over = hub.closed  # then no picture comes after the one that follows
            if self._at is not None:
                self._wake.wait(WAKE)
                self._wake.clear()
            else:
                number, shown = hub.wait(self._seen, WAKE)
                if shown is not None and number != self._seen:
                    self._seen = number
                    self._show(shown, now=True)
            if over and not self._over:
                self._over, self._at = True, hub.history.span[1] if self._at is None else self._at
                self._say({"over": over})

    def hear(self, message: str | bytes) -> None:
        """Do what the page asks for; ValueError or InputError if it makes no sense."""
        asked: Any = msgspec.json.decode(message)
        match asked:
            case {"seek": float() | int() as t}:
                self._at = float(t)
                self._seek(self._at)
            case {"live": True} if self._hub.live:
                if not self._over:
                    self._at, self._seen = None, -1
                    self._wake.set()
            case {"order": dict() as order, "seen": int() as seen, "id": int() as number}:
                age = self._clock() - self._sent.get(seen, -1e9)
                self._say({"answer": self._hub.order(order, age), "id": number})
            case _:
                raise ValueError("a page asked for something unknown")

    def _seek(self, t: float) -> None:
        shown = self._hub.history.at(t)
        if shown is not None:
            self._show(shown)

    def _show_trails(self) -> None:
        past = [
            [each["t"], each["share"], {robot["id"]: [robot["x"], robot["y"]] for robot in each["robots"]}]
            for each in self._hub.history.told()
        ]
        self._say({"past": past})

    def _show(self, shown: Picture, now: bool = False) -> None:
        """Send what is new in a picture; one of ``now`` not to a page that has begun to look back."""
        with self._send_lock:
            if now and self._at is not None:
                return
            if shown.frame != self._frame:
                self._shown, self._frame = None, shown.frame
            whole, tiles = changes(shown.frame, shown.classes, self._shown)
            self._shown = shown.classes
            self._numbers += 1
            self._sent[self._numbers] = self._clock()
            self._sent.pop(self._numbers - 100, None)
            self._told, news = self._hub.events(self._told)
            frame = shown.frame
            about = {
                "n": self._numbers,
                "span": self._hub.history.span,
                "map": [frame.resolution, frame.rows, frame.cols, frame.origin_x, frame.origin_y],
                "whole": whole,
                "events": [[round(each.t, 1), each.what] for each in news],
            }
            head = msgspec.json.encode(about)[:-1] + b',"now":' + shown.text + b"}"
            self._connection.send(head.decode())
            if tiles:
                self._connection.send(tiles)

    def _say(self, what: dict[str, Any]) -> None:
        with self._send_lock:
            self._connection.send(msgspec.json.encode(what).decode())


def _page(status: HTTPStatus, body: bytes, kind: str) -> Response:
    headers = Headers()
    headers["Content-Type"] = kind
    headers["Content-Length"] = str(len(body))
    headers["Content-Security-Policy"] = POLICY
    headers["Referrer-Policy"] = "no-referrer"
    headers["Cache-Control"] = "no-store"
    return Response(status.value, status.phrase, headers, body)
