"""How much room is left on the disk that results go to."""

from __future__ import annotations

import shutil
from pathlib import Path

LITTLE = 64 << 20  # bytes: a record of a large mission, and its map


def short_of_space(folder: Path) -> str | None:
    """Say in a line that the disk of a folder is full, or will be soon; None: it is not, or nobody knows."""
    try:
        free = shutil.disk_usage(folder).free
    except OSError:
        return None
    return None if free >= LITTLE else f"disk full: {free / 1e6:.0f} MB left for {folder}"
