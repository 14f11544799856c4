"""Missions from Python: run to their end in a line, or step by step; what the commands do, as objects.

``explore``, ``track`` and ``search`` with no arguments run the missions of the commands without options.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vedette.run.domain import DomainMission
    from vedette.run.exploring import Explore, ExploreResult, explore
    from vedette.run.mission import Deciding
    from vedette.run.searching import Search, SearchResult, search
    from vedette.run.seeking import Seek, SeekResult, seek
    from vedette.run.tracking import Track, TrackResult, track

__all__ = [
    "Deciding",
    "DomainMission",
    "Explore",
    "ExploreResult",
    "Search",
    "SearchResult",
    "Seek",
    "SeekResult",
    "Track",
    "TrackResult",
    "explore",
    "search",
    "seek",
    "track",
]

_MODULES = {
    "domain": ("DomainMission",),
    "exploring": ("Explore", "ExploreResult", "explore"),
    "mission": ("Deciding",),
    "searching": ("Search", "SearchResult", "search"),
    "seeking": ("Seek", "SeekResult", "seek"),
    "tracking": ("Track", "TrackResult", "track"),
}


def __getattr__(name: str) -> Any:
    """Import a mission when it is asked for: who explores does not wait for what searches."""
    for module, names in _MODULES.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
