"""Recorded missions as one file that plays by itself: the page, with all that it shows in it."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import msgspec

from vedette.record.files import write_text
from vedette.window.history import History
from vedette.window.hub import Entry
from vedette.window.picture import changes

MARK = "const RECORDS = null;"
PLAYED = re.compile(r"^const RECORDS = (\[.*\]);$", re.MULTILINE)


@dataclass(frozen=True)
class Show:
    """A mission to be played."""

    name: str
    history: History
    entries: Sequence[Entry] = ()  # what has happened


def export_page(shows: Sequence[Show], path: Path) -> None:
    """Write a page with these missions in it, each picture as what it changes of the one before.

    Raises:
        InputError: the file cannot be written.
    """
    records = [
        {
            "name": show.name,
            "packed": _packed(show.history),
            "entries": [(round(entry.t, 1), entry.what) for entry in sorted(show.entries, key=_time)],
        }
        for show in shows
    ]
    told = msgspec.json.encode(records).decode().replace("<", "\\u003c")  # no word ends the script
    write_text(path, page_with(told))


def page_with(records: str) -> str:
    """Return the page with what it plays in it, as JSON."""
    page = files("vedette.window").joinpath("page.html").read_text(encoding="utf-8")
    return page.replace(MARK, f"const RECORDS = {records};", 1)


def records_in(page: str) -> str:
    """Return what a page plays, as JSON; ValueError if it plays nothing."""
    found = PLAYED.search(page)
    if found is None:
        raise ValueError("a page that plays nothing")
    return found[1]


def _time(entry: Entry) -> float:
    return entry.t


def _packed(history: History) -> str:
    moments: list[Any] = []
    shown = None
    for picture in history.all():
        frame = picture.frame
        whole, tiles = changes(frame, picture.classes, shown)
        shown = picture.classes
        about = [frame.resolution, frame.rows, frame.cols, frame.origin_x, frame.origin_y]
        moments.append([about, whole, msgspec.Raw(picture.text), base64.b64encode(tiles).decode()])
    return base64.b64encode(zlib.compress(msgspec.json.encode(moments), 9)).decode()
