"""A sensor manager for Stone Soup in which sensors negotiate; needs the extra ``stonesoup``."""

try:
    import stonesoup as _  # noqa: F401
except ImportError as error:
    raise ImportError("vedette.stonesoup needs Stone Soup; run: pip install 'vedette[stonesoup]'") from error

from vedette.stonesoup.manager import ManagerDecision, VedetteSensorManager
from vedette.stonesoup.objectives import LogDetReward, StoneSoupTracks, TrackReward, UncertaintyReward

__all__ = [
    "LogDetReward",
    "ManagerDecision",
    "StoneSoupTracks",
    "TrackReward",
    "UncertaintyReward",
    "VedetteSensorManager",
]
