"""What a mission leaves: summary, run log, MCAP record, pictures, live view.

A mission adds `Snapshot`s to a `RunLog`, which forwards them to its sinks while it runs
(`vedette.record.mcap.McapWriter`, `vedette.record.live.LiveView`) and feeds the pictures afterwards
(`vedette.record.progress`, `curves`, `animate`). Import these by name: they load large libraries.
"""

from vedette.record.links import Link
from vedette.record.log import RobotSample, RunLog, Sink, Snapshot
from vedette.record.summary import Outcome, Spread, Summary, Timing, Traffic

__all__ = [
    "Link",
    "Outcome",
    "RobotSample",
    "RunLog",
    "Sink",
    "Snapshot",
    "Spread",
    "Summary",
    "Timing",
    "Traffic",
]
