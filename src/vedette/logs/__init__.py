"""Recorded data of real robots: lidar scans with the poses from which they were taken, or their own maps."""

from vedette.logs.carmen import read_carmen
from vedette.logs.recorded import RecordedLog, RecordedMap, RecordedScan, Sight

__all__ = ["RecordedLog", "RecordedMap", "RecordedScan", "Sight", "read_carmen"]
