"""How much room is left on the disk that results go to."""

from __future__ import annotations

import shutil
from pathlib import Path

LITTLE = 64 << 20  # bytes: a record of a large mission, and its map


def space_alerts(folder: Path) -> list[str]:
    """Return a line that the disk of a folder is full, or will be soon; none if not, or nobody knows."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError:
        return []
    return [] if free >= LITTLE else [f"disk full: {free / 1e6:.0f} MB left for {folder}"]
