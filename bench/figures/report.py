"""Figures of the dated reports, read from their tables."""

from __future__ import annotations

import re
from pathlib import Path


def cell(path: Path, heading: str, column: str, *labels: str) -> str:
    """Return a cell of the first table under a heading, as it stands there.

    Args:
        path: the report
        heading: as it stands there, without ``#``
        column: title of the cell's column
        labels: beginnings of the first cells of its row

    Raises:
        LookupError: there is no such cell.
    """
    _, found, section = path.read_text(encoding="utf-8").partition(f"# {heading}\n")
    table = re.search(r"(?:^\|.*\n)+", section, re.MULTILINE) if found else None
    if table is None:
        raise LookupError(f"{path.name}: no table under {heading!r}")
    header, _, *rows = ([part.strip() for part in line.split("|")[1:-1]] for line in table[0].splitlines())
    for row in rows:
        if column in header and all(row[i].startswith(label) for i, label in enumerate(labels)):
            return row[header.index(column)]
    raise LookupError(f"{path.name}, {heading}: no {column!r} of {labels}")
