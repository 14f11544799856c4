"""Missions from Python: run to their end in a line, or step by step; what the commands do, as objects.

``explore``, ``track`` and ``search`` with no arguments run the missions of the commands without options.
"""

from vedette.run.domain import DomainMission
from vedette.run.exploring import Explore, ExploreResult, explore
from vedette.run.mission import Deciding
from vedette.run.searching import Search, SearchResult, search
from vedette.run.tracking import Track, TrackResult, track

__all__ = [
    "Deciding",
    "DomainMission",
    "Explore",
    "ExploreResult",
    "Search",
    "SearchResult",
    "Track",
    "TrackResult",
    "explore",
    "search",
    "track",
]
