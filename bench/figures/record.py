"""The file of recorded figures, the pictures beside it, and what made them."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench import machine
from bench.figures.missions import Mission
from vedette.errors import InputError
from vedette.record.files import write_text

DOCS = Path(__file__).parents[2] / "docs"
FILE = DOCS / "figures.json"
IMAGES = DOCS / "images"
DECIDES = ("src", "rust", "constraints.txt")  # how a mission goes

Record = Mapping[str, Any]  # of one mission: `provenance`, what `carry_out` returns, and the pictures' hashes


def load() -> dict[str, Record]:
    """Return the recorded missions by name; none if there is no file."""
    if not FILE.exists():
        return {}
    records: dict[str, Record] = json.loads(FILE.read_text(encoding="utf-8"))
    return records


def save(records: Mapping[str, Record]) -> None:
    """Write the recorded missions."""
    write_text(FILE, json.dumps(records, indent=2, allow_nan=False, ensure_ascii=False) + "\n")


def provenance() -> dict[str, str]:
    """Return the commit that last changed what decides how a mission goes, its date, machine and versions.

    Raises:
        InputError: files differ from it.
    """
    if machine.differs(*DECIDES):
        raise InputError(f"{', '.join(DECIDES)}: commit what differs first; a record names its commit")
    return machine.describe() | machine.last_change(*DECIDES)


def keep_pictures(mission: Mission, folder: Path) -> dict[str, str]:
    """Put the pictures that a mission left in ``folder`` into the documents; return their hashes by name."""
    for name, made in mission.pictures.items():
        shutil.copyfile(folder / made, IMAGES / name)
    return {name: picture_hash(IMAGES / name) for name in mission.pictures}


def picture_hash(path: Path) -> str:
    """Return 12 hexadecimal digits that change with a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]
