"""What all watchers see: the latest picture, the history, what has happened, and how orders are given."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from threading import Condition
from typing import Any

import msgspec

from vedette.agent.orders import Order
from vedette.errors import InputError
from vedette.scenario import as_scenario
from vedette.window.history import History
from vedette.window.picture import Picture, said

LOOPBACK = "127.0.0.1"  # where a window is served, unless somebody wants it elsewhere
FRESH = 3.0  # an order given on an older picture is refused [s]
MOST_EVENTS = 500
OVER = "the mission is over"
PER_SECOND = 10.0  # pictures, at most


class _Said(msgspec.Struct, frozen=True):
    order: Order


@dataclass(frozen=True)
class Entry:
    """A line of what has happened."""

    t: float  # of the mission [s]
    what: str


class Hub:
    """Shared by the mission, which shows pictures, and the watchers' threads."""

    def __init__(
        self,
        name: str,
        give: Callable[[Order], str] | None = None,
        *,
        live: bool = True,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin with nothing to show.

        Args:
            name: of what is shown.
            give: gives an order to the team and returns in a line what has come of it; None: nobody can.
            live: the mission goes on; else it is a record.
            clock: [s].
        """
        self.name, self.live, self.history = name, live, History()
        self._events, self._gone = list[Entry](), 0  # the latest, and how many were before them
        self._give, self._clock = give, clock
        self._news = Condition()
        self._latest: Picture | None = None
        self._number, self._shown_at = 0, -1e9
        self._states: dict[str, str] = {}
        self.closed = ""  # why nothing more will be shown

    @property
    def takes_orders(self) -> bool:
        """Whether there is a team that can be told anything."""
        return self._give is not None

    def is_due(self) -> bool:
        """Tell whether another picture would be shown; ten a second are enough."""
        return self._clock() >= self._shown_at + 1.0 / PER_SECOND

    def show(self, shown: Picture) -> None:
        """Show a picture to all watchers."""
        self.history.add(shown)
        with self._news:
            self._latest, self._shown_at = shown, self._clock()
            self._number += 1
            self._note_changes(shown)
            self._news.notify_all()

    def close(self, why: str = OVER) -> None:
        """Show nothing more, and say why; what was said first counts."""
        with self._news:
            self.closed = self.closed or why
            self._news.notify_all()

    def wait(self, seen: int, seconds: float) -> tuple[int, Picture | None]:
        """Return the latest picture and its number, once that is another than ``seen``, or time is over."""
        with self._news:
            self._news.wait_for(lambda: self._number != seen or bool(self.closed), seconds)
            return self._number, self._latest

    def note(self, what: str, at: float | None = None) -> None:
        """Add a line to what has happened: at a time of the mission [s], or now."""
        with self._news:
            now = 0.0 if self._latest is None else self._latest.t
            self._add(Entry(now if at is None else at, what))

    def events(self, told: int) -> tuple[int, list[Entry]]:
        """Return how many lines there have been, and those after the first ``told`` of them."""
        with self._news:
            return self._gone + len(self._events), self._events[max(told - self._gone, 0) :]

    def order(self, told: Any, age: float) -> str:
        """Give an order that a watcher has told, as it says of a picture so old [s]; return an answer.

        Raises:
            InputError: it is no order.
        """
        what = as_scenario({"order": told}, _Said, "order").order
        if self._give is None:
            return "refused: this is a record, and nobody can be told anything"
        if age > FRESH or self._clock() - self._shown_at > FRESH:
            return f"refused: the picture that it was given on is older than {FRESH:g} s"
        try:
            answer = self._give(what)
        except InputError as error:
            answer = f"refused: {error}"
        self.note(f"order {said(what)}: {answer}")
        return answer

    def _note_changes(self, shown: Picture) -> None:
        """Write down what robots have come to do."""
        for robot in msgspec.json.decode(shown.text)["robots"]:
            name, state = robot["name"], robot["state"]
            before = self._states.get(name)
            self._states[name] = state
            if before != state and (before is None or state in NOTEWORTHY or before in NOTEWORTHY):
                self._add(Entry(shown.t, f"{name}: {state}"))

    def _add(self, entry: Entry) -> None:
        self._events.append(entry)
        more = max(len(self._events) - MOST_EVENTS, 0)
        del self._events[:more]
        self._gone += more


NOTEWORTHY = frozenset({"dead", "left", "stuck", "paused", "returning", "done", "leaving a no-go area"})
