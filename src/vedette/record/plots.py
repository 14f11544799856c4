"""The pictures of a mission: ``progress.png`` and ``curves.png``."""

from vedette.record.curves import curves_png
from vedette.record.progress import progress_png

__all__ = ["curves_png", "progress_png"]
